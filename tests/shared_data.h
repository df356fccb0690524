// SPDX-License-Identifier: GPL-3.0-or-later
// Large worlds that are not part of the repository: tests that want them skip themselves without. Include
// after cmocka.h.
#ifndef ENF_TESTS_SHARED_DATA_H
#define ENF_TESTS_SHARED_DATA_H

/// Their folder. Skips the test if there is none.
static inline const char *shared_data(void) {
#ifdef ENFILADE_SHARED_DIR
    return ENFILADE_SHARED_DIR;
#else
    print_message("the shared data are absent: skipped\n");
    skip();
    return "";
#endif
}

#endif
