/* A host in C that runs the four-bar's FMU and takes the time. */

#ifndef CYCLE_H
#define CYCLE_H

#include "closed_form.h"

struct cycle;

/* Loads a library, makes an instance of version 2 or 3 of FMI, for co-simulation without event mode
 * and intermediate update, and initializes it. A cycle gets the body outputs in a given
 * order: numbers from 0, 0 being the first output of the first body. The crank does `turn` steps
 * per turn. Returns a null pointer if anything fails, with the reason on stderr. */
struct cycle *cycle_open(const char *library, int version, const char *token,
                         const char *resources, unsigned turn, const unsigned order[OUTPUTS]);
void cycle_close(struct cycle *);

/* Does a number of cycles: each sets the crank's angle and its rates, steps, and gets all outputs
 * by one call. The crank turns at 10 rad/s, there and back again. Returns the time that all cycles
 * take together [ns], or -1 if a call fails. */
long long cycle_run(struct cycle *, unsigned long long cycles);

/* The crank's angle of the last cycle, its velocity and acceleration. */
const double *cycle_inputs(const struct cycle *);
/* The outputs of the last cycle, in the order asked for. In the order 0, 1, 2, ... they are, for
 * each body, x y phi vx vy omega ax ay alpha. */
const double *cycle_outputs(const struct cycle *);

#endif
