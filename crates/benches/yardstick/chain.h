/* A chain of loops, each solved by Newton for its two angles. */

#ifndef CHAIN_H
#define CHAIN_H

#include <stddef.h>

/* The mechanism, the same as `chain` in tests/common/generated.rs writes down as a file:
 *
 * Loop 0 is the four-bar of mechanisms/four_bar.toml. Loop k > 0 is a parallelogram whose crank is
 * the rocker of loop k - 1: its rocker is as long, its coupler as long as the ground between the
 * two pivots. So every rocker turns like the first. The pivot of rocker k is `spacing` to the
 * right of that of rocker k - 1, or `zigzag`, then to the right for odd k and to the left for
 * even k.
 *
 * Bodies: the crank, then coupler and rocker of each loop; the origin of a body is at the pin or
 * pivot that comes first in this order. */

struct chain;

enum chain_kind {
    /* Sines and cosines are those of the accepted angles. */
    CHAIN_PLAIN,
    /* They follow the last correction of Newton, below 1e-9, by the first term of its series,
     * which saves half of them and loses nothing. */
    CHAIN_UPDATED,
    /* As plain; the reciprocal condition of each block besides. */
    CHAIN_CONDITION,
};

/* A chain closed at the crank angle, 60 degrees to 120 degrees; a null pointer without memory. */
struct chain *chain_new(size_t loops, double spacing, int zigzag, double angle);
void chain_free(struct chain *);

/* Moves the crank to an angle [rad] and gives all bodies the velocities and accelerations that go
 * with its rates. Returns the Newton iterations of all loops together, 0 if one does not
 * converge. */
unsigned chain_step(struct chain *, enum chain_kind, double angle, double velocity,
                    double acceleration);

/* x, y, phi of each body; their rates; their second rates. */
const double *chain_position(const struct chain *);
const double *chain_velocity(const struct chain *);
const double *chain_acceleration(const struct chain *);

/* Smallest reciprocal condition (1-norm) of any block in the last step of CHAIN_CONDITION. */
double chain_rcond(const struct chain *);

/* Bytes that it takes. */
size_t chain_bytes(size_t loops);

#endif
