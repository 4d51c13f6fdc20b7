#define _GNU_SOURCE /* sincos */

#include "chain.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "closed_form.h"

/* One loop: a u(p) + b u(c) - l u(r) = d, where u(p) = (cos p, sin p) and p is the angle of the
 * body that drives it. */
struct loop {
    double crank, coupler, rocker; /* a, b, l */
    double per_coupler, per_rocker; /* 1/b, 1/l */
    double dx, dy;                 /* d; dy is 0, as all pivots are at one height */
    double pivot_x, pivot_y;       /* of the body that drives it; likewise */
    double c, r;                   /* coupler's and rocker's angle */
    /* Derivatives of c and r with respect to the angle of the chain's crank. */
    double c1, r1, c2, r2;
};

struct chain {
    size_t loops;
    double angle, rcond;
    double *q, *v, *a;
    struct loop loop[];
};

static size_t unknowns(size_t loops) { return 3 * (2 * loops + 1); }

size_t chain_bytes(size_t loops)
{
    return sizeof(struct chain) + loops * sizeof(struct loop) + 3 * unknowns(loops) * sizeof(double);
}

struct chain *chain_new(size_t loops, double spacing, int zigzag, double angle)
{
    struct chain *chain = calloc(1, sizeof *chain + loops * sizeof(struct loop));
    if (!chain) return NULL;
    chain->loops = loops;
    chain->q = calloc(3 * unknowns(loops), sizeof(double));
    if (!chain->q) {
        free(chain);
        return NULL;
    }
    chain->v = chain->q + unknowns(loops);
    chain->a = chain->v + unknowns(loops);
    chain->angle = angle;

    double first[OUTPUTS];
    four_bar_solve(&FOUR_BAR, angle, 1.0, 0.0, first);
    double pivot = 0.0;
    for (size_t k = 0; k < loops; k++) {
        struct loop *loop = &chain->loop[k];
        int back = zigzag && k % 2 == 0;
        loop->crank = k == 0 ? FOUR_BAR.crank : FOUR_BAR.rocker;
        loop->coupler = k == 0 ? FOUR_BAR.coupler : spacing;
        loop->rocker = FOUR_BAR.rocker;
        loop->per_coupler = 1.0 / loop->coupler;
        loop->per_rocker = 1.0 / loop->rocker;
        loop->dx = k == 0 ? FOUR_BAR.base : back ? -spacing : spacing;
        loop->pivot_x = pivot;
        loop->c = k == 0 ? first[11] : back ? acos(-1.0) : 0.0;
        loop->r = first[20];
        loop->c1 = k == 0 ? first[14] : 0.0;
        loop->c2 = k == 0 ? first[17] : 0.0;
        loop->r1 = first[23];
        loop->r2 = first[26];
        pivot += loop->dx;
        /* The rocker's pivot never moves. */
        chain->q[6 * k + 6] = pivot;
    }
    return chain;
}

void chain_free(struct chain *chain)
{
    if (chain) free(chain->q);
    free(chain);
}

/* The error after a correction of this size is its square times about 3: nothing. */
static const double CONVERGED = 1e-9;
enum { MOST_ITERATIONS = 20 };

/* `fmax` would be a call. */
static inline double larger(double a, double b) { return a > b ? a : b; }

static inline unsigned step(struct chain *chain, int updated, int condition, double angle,
                            double velocity, double acceleration)
{
    const double h = angle - chain->angle;
    const double velocity2 = velocity * velocity;
    double *restrict q = chain->q, *restrict v = chain->v, *restrict a = chain->a;
    unsigned iterations = 0;
    double worst = 1.0;

    /* The driving body: its vector to the next pin, and its angle's derivatives. */
    double sp, cp, p1 = 1.0, p2 = 0.0;
    sincos(angle, &sp, &cp);
    q[2] = angle, v[2] = velocity, a[2] = acceleration;
    chain->angle = angle;

    for (struct loop *loop = chain->loop, *end = loop + chain->loops; loop < end; loop++) {
        const double b = loop->coupler, l = loop->rocker;
        const double per_b = loop->per_coupler, per_l = loop->per_rocker;
        const double ax = loop->crank * cp, ay = loop->crank * sp;

        /* Along the path of the crank to second order. */
        double c = loop->c + h * (loop->c1 + 0.5 * h * loop->c2);
        double r = loop->r + h * (loop->r1 + 0.5 * h * loop->r2);
        double sc, cc, sr, cr, dc, dr;
        unsigned left = MOST_ITERATIONS;
        do {
            if (left-- == 0) return 0;
            sincos(c, &sc, &cc);
            sincos(r, &sr, &cr);
            /* b dc n(c) - l dr n(r) = -f; multiplied by u(r) and by u(c), as n(r).u(r) = 0. */
            const double fx = ax + b * cc - l * cr - loop->dx;
            const double fy = ay + b * sc - l * sr - loop->dy;
            const double inverse = 1.0 / (sr * cc - cr * sc);
            dc = -(fx * cr + fy * sr) * (inverse * per_b);
            dr = -(fx * cc + fy * sc) * (inverse * per_l);
            c += dc;
            r += dr;
        } while (!(fabs(dc) <= CONVERGED && fabs(dr) <= CONVERGED));
        iterations += MOST_ITERATIONS - left;
        if (updated) {
            const double s = sc, t = sr;
            sc += dc * cc, cc -= dc * s;
            sr += dr * cr, cr -= dr * t;
        } else {
            sincos(c, &sc, &cc);
            sincos(r, &sr, &cr);
        }

        /* First and second derivative with respect to the crank's angle, with the Jacobian at the
         * accepted angles. */
        const double inverse = 1.0 / (sr * cc - cr * sc);
        const double to_c = inverse * per_b, to_r = inverse * per_l;
        const double vx = -ay * p1, vy = ax * p1;
        const double c1 = -(vx * cr + vy * sr) * to_c;
        const double r1 = -(vx * cc + vy * sc) * to_r;
        const double wx = -ay * p2 - ax * p1 * p1, wy = ax * p2 - ay * p1 * p1;
        const double gx = wx - b * cc * c1 * c1 + l * cr * r1 * r1;
        const double gy = wy - b * sc * c1 * c1 + l * sr * r1 * r1;
        const double c2 = -(gx * cr + gy * sr) * to_c;
        const double r2 = -(gx * cc + gy * sc) * to_r;

        if (condition) {
            /* 1-norm of the block and of its inverse. */
            const double norm = larger(b * (fabs(sc) + fabs(cc)), l * (fabs(sr) + fabs(cr)));
            const double inverse_norm = larger(fabs(cr * to_c) + fabs(cc * to_r),
                                               fabs(sr * to_c) + fabs(sc * to_r));
            worst = larger(worst, norm * inverse_norm);
        }

        loop->c = c, loop->r = r;
        loop->c1 = c1, loop->r1 = r1;
        loop->c2 = c2, loop->r2 = r2;

        /* Coupler; the rocker's pivot stands. */
        q += 3, v += 3, a += 3;
        q[0] = loop->pivot_x + ax;
        q[1] = loop->pivot_y + ay;
        q[2] = c;
        v[0] = vx * velocity;
        v[1] = vy * velocity;
        v[2] = c1 * velocity;
        a[0] = vx * acceleration + wx * velocity2;
        a[1] = vy * acceleration + wy * velocity2;
        a[2] = c1 * acceleration + c2 * velocity2;
        q += 3, v += 3, a += 3;
        q[2] = r;
        v[2] = r1 * velocity;
        a[2] = r1 * acceleration + r2 * velocity2;

        sp = sr, cp = cr, p1 = r1, p2 = r2;
    }
    chain->rcond = 1.0 / worst;
    return iterations;
}

unsigned chain_step(struct chain *chain, enum chain_kind kind, double angle, double velocity,
                    double acceleration)
{
    switch (kind) {
    case CHAIN_UPDATED: return step(chain, 1, 0, angle, velocity, acceleration);
    case CHAIN_CONDITION: return step(chain, 0, 1, angle, velocity, acceleration);
    case CHAIN_PLAIN: break;
    }
    return step(chain, 0, 0, angle, velocity, acceleration);
}

const double *chain_position(const struct chain *chain) { return chain->q; }
const double *chain_velocity(const struct chain *chain) { return chain->v; }
const double *chain_acceleration(const struct chain *chain) { return chain->a; }
double chain_rcond(const struct chain *chain) { return chain->rcond; }
