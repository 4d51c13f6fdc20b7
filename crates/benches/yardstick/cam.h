/* Disc cams with translating followers: mechanisms/cam_roller.toml, cam_flat.toml and
 * cam_knife.toml.
 *
 * The contour of the first two is R(theta) = e cos theta + sqrt(a^2 - e^2 sin^2 theta), and nothing
 * is made of its being a circle. Newton finds the polar angle of the contact from a predictor of
 * second order; the follower and all rates are explicit in it. A knife edge in line with the axle
 * touches at 90 degrees less the cam's angle: a closed form. */

#ifndef CAM_H
#define CAM_H

enum { CAM_BODIES = 2, CAM_OUTPUTS = 9 * CAM_BODIES, CONTACT_OUTPUTS = CAM_OUTPUTS + 3 };

struct cam {
    double disc_radius, eccentricity;  /* a, e [m] */
    double roller_radius, offset;      /* [m]; the flat face has neither */
    double angle, contact;             /* of the last step: cam, polar angle of the contact [rad] */
    double contact1, contact2;         /* derivatives of the contact with respect to the cam */
};

/* The followers of the shipped mechanisms at a cam angle of 60 degrees, the contact estimated. */
extern const struct cam CAM_ROLLER, CAM_FLAT;

/* Moves the cam to an angle [rad]. Computes pose, velocity and acceleration of cam and follower for
 * that angle and its rates, for each body x y phi vx vy omega ax ay alpha, then the polar angle of
 * the contact and its rates. Returns the Newton iterations, or 0 if Newton does not converge. */
unsigned cam_roller_step(struct cam *, double angle, double velocity, double acceleration,
                         double out[CONTACT_OUTPUTS]);
unsigned cam_flat_step(struct cam *, double angle, double velocity, double acceleration,
                       double out[CONTACT_OUTPUTS]);

/* R(theta) = base + lift/2 (1 - cos theta) [m]. */
struct knife_cam {
    double base, lift;
};

/* The lengths of mechanisms/cam_knife.toml. */
extern const struct knife_cam CAM_KNIFE;

/* Computes the same outputs of cam and follower. */
void cam_knife_solve(const struct knife_cam *, double angle, double velocity, double acceleration,
                     double out[CAM_OUTPUTS]);

#endif
