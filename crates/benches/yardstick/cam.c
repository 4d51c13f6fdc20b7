#define _GNU_SOURCE /* sincos */

#include "cam.h"

#include <math.h>

#define AT_60_DEGREES                                                                              \
    .angle = 1.0471975511965976, .contact = 0.5235987755982988, .contact1 = -1.0

const struct cam CAM_ROLLER = {.disc_radius = 0.040,
                               .eccentricity = 0.015,
                               .roller_radius = 0.010,
                               .offset = 0.008,
                               AT_60_DEGREES};
const struct cam CAM_FLAT = {.disc_radius = 0.040, .eccentricity = 0.015, AT_60_DEGREES};
const struct knife_cam CAM_KNIFE = {.base = 0.030, .lift = 0.020};

/* The contour at one contact angle, in ground axes. */
struct contour {
    double r, r1, r2, r3; /* R and its derivatives */
    double sine, cosine;  /* of the direction from the axle to the contact */
    double tx, ty;        /* derivative of the contact's place with respect to its angle */
};

static inline struct contour contour_at(const struct cam *cam, double contact, double cam_sine,
                                        double cam_cosine)
{
    struct contour at;
    double sine, cosine;
    sincos(contact, &sine, &cosine);
    const double a = cam->disc_radius;
    const double es = cam->eccentricity * sine, ec = cam->eccentricity * cosine;

    /* R = ec + g with g^2 = a^2 - es^2; the derivatives of g are those of its square in turn. */
    const double g = sqrt(a * a - es * es), per_g = 1.0 / g;
    const double g1 = -es * ec * per_g;
    const double g2 = (es * es - ec * ec - g1 * g1) * per_g;
    const double g3 = (4.0 * es * ec - 3.0 * g1 * g2) * per_g;
    at.r = ec + g, at.r1 = g1 - es, at.r2 = g2 - ec, at.r3 = g3 + es;

    at.sine = sine * cam_cosine + cosine * cam_sine;
    at.cosine = cosine * cam_cosine - sine * cam_sine;
    at.tx = at.r1 * at.cosine - at.r * at.sine;
    at.ty = at.r1 * at.sine + at.r * at.cosine;
    return at;
}

/* Arc length v per contact angle and rate psi' of the tangent's direction. */
struct arc {
    double v, per_v, per_square, turn;
};

static inline struct arc arc_at(const struct contour *at)
{
    const double square = at->r * at->r + at->r1 * at->r1;
    const double v = sqrt(square), per_v = 1.0 / v, per_square = per_v * per_v;
    return (struct arc){v, per_v, per_square, (square + at->r1 * at->r1 - at->r * at->r2) * per_square};
}

/* Value and slope of the equation that holds at the contact. */
struct equation {
    double value, slope;
};

/* The roller's centre is on the follower's line: x = offset. The centre's place changes with the
 * contact angle by w t, with w = v + r psi' and the unit tangent t. */
static inline struct equation roller_equation(const struct cam *cam, const struct contour *at)
{
    const struct arc arc = arc_at(at);
    const double w = arc.v + cam->roller_radius * arc.turn;
    return (struct equation){
        at->r * at->cosine + cam->roller_radius * at->ty * arc.per_v - cam->offset,
        w * at->tx * arc.per_v};
}

/* The tangent is level. */
static inline struct equation flat_equation(const struct cam *cam, const struct contour *at)
{
    (void)cam;
    return (struct equation){
        at->ty, at->r2 * at->sine + 2.0 * at->r1 * at->cosine - at->r * at->sine};
}

/* Height of the follower and angle of the contact, with derivatives with respect to the cam's
 * angle. */
struct motion {
    double y, y1, y2, contact1, contact2;
};

/* Derivatives of the roller centre's place C, whose derivative with respect to the cam's angle
 * is n(C), C turned to the left:
 *   C'  = n(C) + theta' w t
 *   C'' = -C + 2 theta' w n(t) + theta'^2 (w' t + w psi' n(t)) + theta'' w t.
 * The x of both is zero. */
static inline struct motion roller_motion(const struct cam *cam, const struct contour *at)
{
    const struct arc arc = arc_at(at);
    const double radius = cam->roller_radius;
    const double tx = at->tx * arc.per_v, ty = at->ty * arc.per_v;
    const double x = cam->offset, y = at->r * at->sine - radius * tx;
    const double w = arc.v + radius * arc.turn;
    const double rise = at->r1 * (at->r + at->r2); /* v v' */
    const double turn1 = (2.0 * at->r * at->r1 + 3.0 * at->r1 * at->r2 - at->r * at->r3 -
                          2.0 * arc.turn * rise) * arc.per_square;
    const double w1 = rise * arc.per_v + radius * turn1;

    const double per_wx = 1.0 / (w * tx);
    const double contact1 = y * per_wx;
    const double along = contact1 * contact1 * w1;
    const double across = contact1 * w * (2.0 + contact1 * arc.turn);
    const double contact2 = (x - along * tx + across * ty) * per_wx;
    return (struct motion){y, x + contact1 * w * ty,
                           -y + along * ty + across * tx + contact2 * w * ty, contact1, contact2};
}

/* The face is as high as the contact, whose own way along the level tangent lifts nothing. */
static inline struct motion flat_motion(const struct cam *cam, const struct contour *at)
{
    const double s = at->sine, c = at->cosine;
    const double per_slope = 1.0 / flat_equation(cam, at).slope;
    const double contact1 = -at->tx * per_slope;
    const double twice = at->r3 * s + 3.0 * (at->r2 * c - at->r1 * s) - at->r * c;
    const double mixed = at->r2 * c - 2.0 * at->r1 * s - at->r * c;
    const double contact2 = -contact1 * (contact1 * twice + 2.0 * mixed) * per_slope;
    return (struct motion){at->r * s, at->r * c, at->tx * contact1 - at->r * s, contact1, contact2};
}

static inline void write_bodies(double out[CAM_OUTPUTS], double angle, double velocity,
                                double acceleration, double x, double y, double y1, double y2)
{
    out[0] = 0.0, out[1] = 0.0, out[2] = angle;
    out[3] = 0.0, out[4] = 0.0, out[5] = velocity;
    out[6] = 0.0, out[7] = 0.0, out[8] = acceleration;

    out[9] = x, out[10] = y, out[11] = 0.0;
    out[12] = 0.0, out[13] = y1 * velocity, out[14] = 0.0;
    out[15] = 0.0, out[16] = y1 * acceleration + y2 * velocity * velocity, out[17] = 0.0;
}

/* The error after a correction of this size is of the size of its square: nothing. */
static const double CONVERGED = 1e-9;
enum { MOST_ITERATIONS = 20 };

static inline unsigned step(struct cam *cam, int flat, double angle, double velocity,
                            double acceleration, double out[CONTACT_OUTPUTS])
{
    double sine, cosine;
    sincos(angle, &sine, &cosine);
    const double h = angle - cam->angle;
    double contact = cam->contact + h * (cam->contact1 + 0.5 * h * cam->contact2), correction;
    unsigned left = MOST_ITERATIONS;
    do {
        if (left-- == 0) return 0;
        const struct contour at = contour_at(cam, contact, sine, cosine);
        const struct equation f = flat ? flat_equation(cam, &at) : roller_equation(cam, &at);
        correction = -f.value / f.slope;
        contact += correction;
    } while (!(fabs(correction) <= CONVERGED));

    const struct contour at = contour_at(cam, contact, sine, cosine);
    const struct motion motion = flat ? flat_motion(cam, &at) : roller_motion(cam, &at);
    write_bodies(out, angle, velocity, acceleration, cam->offset, motion.y, motion.y1, motion.y2);
    out[18] = contact;
    out[19] = motion.contact1 * velocity;
    out[20] = motion.contact1 * acceleration + motion.contact2 * velocity * velocity;
    cam->angle = angle, cam->contact = contact;
    cam->contact1 = motion.contact1, cam->contact2 = motion.contact2;
    return MOST_ITERATIONS - left;
}

unsigned cam_roller_step(struct cam *cam, double angle, double velocity, double acceleration,
                         double out[CONTACT_OUTPUTS])
{
    return step(cam, 0, angle, velocity, acceleration, out);
}

unsigned cam_flat_step(struct cam *cam, double angle, double velocity, double acceleration,
                       double out[CONTACT_OUTPUTS])
{
    return step(cam, 1, angle, velocity, acceleration, out);
}

void cam_knife_solve(const struct knife_cam *cam, double angle, double velocity,
                     double acceleration, double out[CAM_OUTPUTS])
{
    double sine, cosine;
    sincos(angle, &sine, &cosine);
    const double half = 0.5 * cam->lift;
    write_bodies(out, angle, velocity, acceleration, 0.0, cam->base + half * (1.0 - sine),
                 -half * cosine, half * sine);
}
