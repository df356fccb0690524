// SPDX-License-Identifier: GPL-3.0-or-later
// The program `enfilade`: finds the command and runs it.
#include "cli/cli.h"
#include "cli/heap.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static const cli_command commands[] = {
    {"compile", "make a world file from polygons", cli_compile},
    {"info", "say what is in a world file", cli_info},
    {"check", "test every invariant of a world file exactly", cli_check},
    {"locate", "find the cells of points", cli_locate},
    {"sight", "say which points see each other", cli_sight},
    {"pvs", "find which cells see which", cli_pvs},
    {"export", "write a world as .obj, .svg, .dot or .json", cli_export},
    {"gen", "write a built-in test world", cli_gen},
    {"bench", "tables of measurements", cli_bench},
};

enum { COMMAND_COUNT = sizeof commands / sizeof *commands };

int cli_fail(const enf_error *error) {
    fprintf(stderr, "%s\n", error->text);
    return (int)error->status;
}

int cli_finish_output(void) {
    if (fflush(stdout) == 0 && !ferror(stdout)) return ENF_OK;
    fprintf(stderr, "standard output: can't be written: %s; check the disk or the pipe\n",
            strerror(errno ? errno : EIO));
    return ENF_NO_RESOURCES;
}

static void print_usage(FILE *file) {
    fputs("usage: enfilade COMMAND ...\n\n", file);
    for (int i = 0; i < COMMAND_COUNT; i++)
        fprintf(file, "  %-9s %s\n", commands[i].name, commands[i].summary);
    fputs("\n`enfilade COMMAND --help` lists the options. `-` is standard input or output.\n"
          "Exit status: 0 done, 1 the check failed, 2 bad usage, 3 bad input, 4 no resources.\n",
          file);
}

static bool is_later(const char *name) {
    static const char *const later[] = {"render", "view"};
    for (size_t i = 0; i < sizeof later / sizeof *later; i++)
        if (strcmp(later[i], name) == 0) return true;
    return false;
}

int main(int argc, char **argv) {
    cli_heap_prepare();
    if (argc < 2) {
        print_usage(stderr);
        return ENF_BAD_USAGE;
    }
    const char *name = argv[1];
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0) {
        print_usage(stdout);
        return cli_finish_output();
    }
    if (strcmp(name, "--version") == 0) {
        puts("enfilade " ENF_VERSION_TEXT);
        return cli_finish_output();
    }
    for (int i = 0; i < COMMAND_COUNT; i++)
        if (strcmp(commands[i].name, name) == 0) {
            int status = commands[i].run(argc - 2, argv + 2);
            int written = cli_finish_output();
            return status ? status : written;
        }
    fprintf(stderr, "enfilade: %s '%.100s'; `enfilade --help` lists the commands\n",
            is_later(name) ? "not built yet:" : "there is no command", name);
    return ENF_BAD_USAGE;
}
