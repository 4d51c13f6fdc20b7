#define _POSIX_C_SOURCE 200809L

#include "clock.h"

#include <time.h>

long long thread_time(void)
{
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1000000000LL * time.tv_sec + time.tv_nsec;
}
