/* A host in C that runs the four-bar's FMU and takes the time. */

#ifndef CYCLE_H
#define CYCLE_H

#include "four_bar.h"

struct cycle;

/* Loads a library, makes an instance and initializes it; a null pointer if any of that fails, with
 * the reason on stderr. */
struct cycle *cycle_open(const char *library, const char *guid, const char *resources);
void cycle_close(struct cycle *);

/* Does so many cycles: sets the crank's angle and its rates, steps, gets the outputs of all bodies
 * by one call. The crank turns at 10 rad/s, 10,000 steps a turn, there and back again. Returns the
 * time from the first to the last [ns], or -1 if a call fails. */
long long cycle_run(struct cycle *, unsigned long long cycles);

/* The crank's angle of the last cycle, its velocity and acceleration. */
const double *cycle_inputs(const struct cycle *);
/* What the last cycle got: for each body x y phi vx vy omega ax ay alpha. */
const double *cycle_outputs(const struct cycle *);

#endif
