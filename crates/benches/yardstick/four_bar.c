#define _GNU_SOURCE /* sincos */

#include "closed_form.h"

#include <math.h>

const struct four_bar FOUR_BAR = {.crank = 0.10, .coupler = 0.25, .rocker = 0.30, .base = 0.40};

const struct masses FOUR_BAR_MASSES[BODIES] = {
    {.mass = 0.4, .inertia = 0.0006, .x = 0.03, .y = 0.0},
    {.mass = 0.9, .inertia = 0.0070, .x = 0.12, .y = 0.02},
    {.mass = 1.1, .inertia = 0.0090, .x = 0.14, .y = -0.01},
};

/* What the forces use of the motion besides its outputs. */
struct motion {
    double sine, cosine;   /* of the crank's angle */
    double bx, by, cx, cy; /* coupler and rocker, from A and from the pivot to B */
    double cross;          /* 1 / (c x b) */
};

static struct motion move(const struct four_bar *lengths, double angle, double velocity,
                          double acceleration, double out[OUTPUTS])
{
    const double b = lengths->coupler, c = lengths->rocker;
    double sine, cosine;
    sincos(angle, &sine, &cosine);

    /* Crank pin A: position, velocity, acceleration. */
    const double ax = lengths->crank * cosine, ay = lengths->crank * sine;
    const double avx = -ay * velocity, avy = ax * velocity;
    const double aax = -ay * acceleration - ax * velocity * velocity;
    const double aay = ax * acceleration - ay * velocity * velocity;

    /* Pin B where the circles about A and about the rocker's pivot meet: the coupler as a vector
     * is f d + g n, with d from A to the pivot and n the same turned to the left. */
    const double dx = lengths->base - ax, dy = -ay;
    const double inverse = 1.0 / (dx * dx + dy * dy);
    const double f = 0.5 * (1.0 + (b * b - c * c) * inverse);
    const double g = sqrt(b * b * inverse - f * f);
    const double bx = f * dx - g * dy, by = f * dy + g * dx;
    const double cx = bx - dx, cy = by - dy;

    /* B moves alike on both bodies: A' + w1 n(b) = w2 n(c). Multiplied by c and by b, where
     * n(c).c = n(b).b = 0 and n(c).b = c x b = -n(b).c. */
    const double cross = 1.0 / (cx * by - cy * bx);
    const double w1 = (avx * cx + avy * cy) * cross;
    const double w2 = (avx * bx + avy * by) * cross;
    /* Likewise for the accelerations, with the centripetal ones on the left. */
    const double rx = aax - w1 * w1 * bx + w2 * w2 * cx;
    const double ry = aay - w1 * w1 * by + w2 * w2 * cy;

    out[0] = 0.0, out[1] = 0.0, out[2] = angle;
    out[3] = 0.0, out[4] = 0.0, out[5] = velocity;
    out[6] = 0.0, out[7] = 0.0, out[8] = acceleration;

    out[9] = ax, out[10] = ay;
    out[12] = avx, out[13] = avy, out[14] = w1;
    out[15] = aax, out[16] = aay, out[17] = (rx * cx + ry * cy) * cross;

    out[18] = lengths->base, out[19] = 0.0;
    out[21] = 0.0, out[22] = 0.0, out[23] = w2;
    out[24] = 0.0, out[25] = 0.0, out[26] = (rx * bx + ry * by) * cross;
    return (struct motion){
        .sine = sine, .cosine = cosine, .bx = bx, .by = by, .cx = cx, .cy = cy, .cross = cross,
    };
}

/* The motion with the angles of coupler and rocker. */
static struct motion solve(const struct four_bar *lengths, double angle, double velocity,
                           double acceleration, double out[OUTPUTS])
{
    const struct motion at = move(lengths, angle, velocity, acceleration, out);
    out[11] = atan2(at.by, at.bx), out[20] = atan2(at.cy, at.cx);
    return at;
}

void four_bar_solve(const struct four_bar *lengths, double angle, double velocity,
                    double acceleration, double out[OUTPUTS])
{
    solve(lengths, angle, velocity, acceleration, out);
}

/* A body's centre of mass from its origin, and the force and the moment about the origin that its
 * acceleration and its weight demand. */
struct demand {
    double x, y, fx, fy, moment;
};

static struct demand demand(const struct masses *body, double cosine, double sine,
                            const double motion[PER_BODY])
{
    const double gravity = 9.81;
    const double x = cosine * body->x - sine * body->y, y = sine * body->x + cosine * body->y;
    const double omega = motion[5], alpha = motion[8];
    const double ax = motion[6] - alpha * y - omega * omega * x;
    const double ay = motion[7] + alpha * x - omega * omega * y;
    const double fx = body->mass * ax, fy = body->mass * (ay + gravity);
    return (struct demand){
        .x = x,
        .y = y,
        .fx = fx,
        .fy = fy,
        .moment = body->inertia * alpha + x * fy - y * fx,
    };
}

/* What bodies and pins exert on the crank's driver. */
struct load {
    struct demand d0, d1, d2;
    double fx, fy, pin_x, pin_y; /* of B on the coupler, of A on it */
    double effort, inertia;
};

static inline struct load load(const struct four_bar *lengths,
                               const struct masses masses[BODIES], struct motion at,
                               const double out[OUTPUTS])
{
    const double *crank = out, *coupler = out + PER_BODY, *rocker = out + 2 * PER_BODY;
    const double ax = coupler[0], ay = coupler[1];
    const double b = 1.0 / lengths->coupler, c = 1.0 / lengths->rocker;
    const struct demand d0 = demand(&masses[0], at.cosine, at.sine, crank);
    const struct demand d1 = demand(&masses[1], at.bx * b, at.by * b, coupler);
    const struct demand d2 = demand(&masses[2], at.cx * c, at.cy * c, rocker);

    /* Moments of the coupler about A and of the rocker about its pivot: -b x F = M1, c x F = M2. */
    const double fx = (at.cx * d1.moment + at.bx * d2.moment) * at.cross;
    const double fy = (at.cy * d1.moment + at.by * d2.moment) * at.cross;
    const double pin_x = d1.fx + fx, pin_y = d1.fy + fy;
    const double effort = d0.moment + ax * pin_y - ay * pin_x;

    /* Rates of coupler and rocker per rate of the crank; twice the kinetic energy at unit rate. */
    const double k1 = (ax * at.cy - ay * at.cx) * at.cross;
    const double k2 = (ax * at.by - ay * at.bx) * at.cross;
    const double vx = -ay - k1 * d1.y, vy = ax + k1 * d1.x;
    const double inertia =
        masses[0].inertia + masses[0].mass * (d0.x * d0.x + d0.y * d0.y) +
        masses[1].inertia * k1 * k1 + masses[1].mass * (vx * vx + vy * vy) +
        (masses[2].inertia + masses[2].mass * (d2.x * d2.x + d2.y * d2.y)) * k2 * k2;

    return (struct load){
        .d0 = d0, .d1 = d1, .d2 = d2, .fx = fx, .fy = fy, .pin_x = pin_x, .pin_y = pin_y,
        .effort = effort, .inertia = inertia,
    };
}

void four_bar_forces(const struct four_bar *lengths, const struct masses masses[BODIES],
                     double angle, double velocity, double acceleration, double out[OUTPUTS],
                     double forces[FORCES])
{
    const struct motion at = solve(lengths, angle, velocity, acceleration, out);
    const struct load l = load(lengths, masses, at, out);

    forces[0] = l.effort, forces[1] = l.effort * velocity;
    forces[2] = l.inertia, forces[3] = l.effort - l.inertia * acceleration;
    forces[4] = l.d0.fx + l.pin_x, forces[5] = l.d0.fy + l.pin_y;
    forces[6] = l.pin_x, forces[7] = l.pin_y;
    forces[8] = l.fx, forces[9] = l.fy;
    forces[10] = l.d2.fx - l.fx, forces[11] = l.d2.fy - l.fy;
    forces[12] = 0.5 * l.inertia * velocity * velocity;
    forces[13] = 9.81 * (masses[0].mass * l.d0.y + masses[1].mass * (out[10] + l.d1.y) +
                         masses[2].mass * l.d2.y);
}

double four_bar_acceleration(const struct four_bar *lengths, const struct masses masses[BODIES],
                             double angle, double velocity)
{
    double out[OUTPUTS];
    const struct motion at = move(lengths, angle, velocity, 0.0, out);
    const struct load l = load(lengths, masses, at, out);
    return -l.effort / l.inertia;
}

double pendulum_acceleration(double angle)
{
    return -9.81 * cos(angle);
}
