// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade gen: the built-in test worlds.
#include "build/gen.h"

#include "cli/cli.h"
#include "cli/options.h"
#include "format/output.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

static void print_list(void) {
    const char *name, *description;
    for (size_t i = 0; (name = enf_gen_list(i, &description)); i++) printf("%-24s %s\n", name, description);
}

static int generate(const cli_texts *operands, const char *path) {
    enf_error error = {0};
    enf_output output;
    enf_status status = enf_output_open(&output, path, &error);
    if (!status)
        status =
            enf_gen_write(operands->items[0], operands->items + 1, operands->count - 1, output.file, &error);
    if (!status) status = enf_output_commit(&output, &error);
    enf_output_discard(&output);
    return status ? cli_fail(&error) : ENF_OK;
}

int cli_gen(int argc, char **argv) {
    const char *path = NULL;
    cli_option options[] = {
        {"--output", 'o', CLI_TEXT, &path, "OUT.obj", "the file to write; - is standard output", NULL, false},
        {0},
    };
    const cli_syntax syntax = {
        .command = "enfilade gen",
        .usage = "NAME [key=value]... -o OUT.obj    (enfilade gen list: the names)",
        .summary =
            "Writes a test world as OBJ. Every world takes scale=S, noise=A, seed=N,\n"
            "rotate=AX,AY,AZ (degrees) and translate=X,Y,Z; office and caverns also floors=F, rooms=R,\n"
            "detail=N.",
        .options = options,
        .operands_min = 1,
        .operands_max = INT_MAX,
        .operand = "the name of a world"};
    cli_texts operands = {0};
    int status = cli_parse(&syntax, argc, argv, &operands);
    if (status >= 0)
        ;
    else if (strcmp(operands.items[0], "list") == 0 && operands.count == 1 && !path)
        print_list(), status = ENF_OK;
    else if (!path)
        status = cli_misuse(&syntax, "-o OUT.obj is missing");
    else
        status = generate(&operands, path);
    free(operands.items);
    return status;
}
