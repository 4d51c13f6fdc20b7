/* The clock of all measurements. */

#ifndef CLOCK_H
#define CLOCK_H

/* Returns the time that the calling thread has run [ns]: what other programs take on a busy machine
 * does not count. */
long long thread_time(void);

#endif
