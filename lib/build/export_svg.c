// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/export.h"

enf_status enf_export_svg(const enf_file_view *view, const enf_svg_options *options, FILE *out,
                          enf_error *error) {
    (void)view;
    (void)options;
    (void)out;
    return enf_fail(error, ENF_BAD_USAGE, "not built yet");
}
