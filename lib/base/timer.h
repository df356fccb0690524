// SPDX-License-Identifier: MIT
// Seconds, for reports only.
#ifndef ENF_BASE_TIMER_H
#define ENF_BASE_TIMER_H

/// On a monotonic clock.
double enf_timer_now(void);

/// Of processor time that all threads of this process have used.
double enf_timer_cpu(void);

#endif
