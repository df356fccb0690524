// SPDX-License-Identifier: GPL-3.0-or-later
// Whole numbers of 128 bits. Machines without them cannot build worlds: doubles stand in there, so that the
// runtime's tests, whose numbers are small, can write theirs.
#ifndef ENF_BUILD_WIDE_H
#define ENF_BUILD_WIDE_H

#ifdef __SIZEOF_INT128__
__extension__ typedef __int128 enf_wide;
#else
typedef double enf_wide;
#endif

#endif
