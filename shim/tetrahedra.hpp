// SPDX-License-Identifier: GPL-3.0-or-later
// What both tetrahedralizers do with their result: memory from malloc.
#ifndef ENF_SHIM_TETRAHEDRA_HPP
#define ENF_SHIM_TETRAHEDRA_HPP

#include "shim/shim.h"

#include <cstdlib>

namespace enf {

/// Room for `count` tetrahedra; out->count stays 0.
inline enf_status reserve_tetrahedra(size_t count, enf_tetrahedra *out, enf_error *error) {
    out->count = 0;
    out->corners = static_cast<int32_t(*)[4]>(std::calloc(count ? count : 1, sizeof *out->corners));
    return out->corners ? ENF_OK : enf_fail_memory(error, "the tetrahedra");
}

} // namespace enf
#endif
