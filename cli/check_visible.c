// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade check IN.prt --pvs PVS.txt: a visible set against its portal graph.
#include "cli/check.h"
#include "cli/cli.h"
#include "visibility_check/check_pvs.h"

#include <stdlib.h>

int cli_check_visible(const cli_visible_check *request) {
    enf_portal_graph graph = {0};
    enf_pvs pvs = {0};
    enf_witness_list witnesses = {0};
    enf_error error = {0};
    enf_check_report *report = calloc(1, sizeof *report);
    enf_status status = report ? ENF_OK : enf_fail_memory(&error, "the report");
    if (!status) status = enf_portal_graph_read(&graph, request->graph, &error);
    if (!status) status = enf_pvs_read(&pvs, request->pvs, graph.cell_count, &error);
    if (!status && request->witness)
        status = enf_witnesses_read(&witnesses, request->witness, graph.cell_count, &error);
    if (!status) {
        const enf_pvs_check_options options = {.witnesses = request->witness ? &witnesses : NULL,
                                               .hidden = request->hidden,
                                               .sample_seconds = request->sample,
                                               .seed = 1};
        enf_error wrong = {0};
        status = enf_pvs_check(&graph, &pvs, &options, report, &wrong);
        if (status == ENF_OK || status == ENF_CHECK_FAILED) cli_print_check(report, request->as_json);
        if (status) enf_fail(&error, status, "%s: %.900s", request->pvs, wrong.text);
    }
    if (status) cli_fail(&error);
    enf_witnesses_free(&witnesses);
    enf_pvs_free(&pvs);
    enf_portal_graph_free(&graph);
    free(report);
    return (int)status;
}
