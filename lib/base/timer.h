// SPDX-License-Identifier: MIT
// Seconds on a monotonic clock, for reports only.
#ifndef ENF_BASE_TIMER_H
#define ENF_BASE_TIMER_H

double enf_timer_now(void);

#endif
