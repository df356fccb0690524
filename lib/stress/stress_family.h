// SPDX-License-Identifier: GPL-3.0-or-later
// Families of random soups, each as bad as its kind can be; a few hundred to a few thousand fine cells each.
#ifndef ENF_BUILD_STRESS_FAMILY_H
#define ENF_BUILD_STRESS_FAMILY_H

#include "stress/stress_case.h"

/// The name of family number `index`, or null after the last. *description (if not null) gets one line on it.
const char *enf_stress_family(int index, const char **description);

/// Makes the soup of a seed. ENF_NO_RESOURCES without memory. Free the case in any event.
enf_status enf_stress_make(enf_stress_case *made, int family, uint64_t seed, enf_error *error);

#endif
