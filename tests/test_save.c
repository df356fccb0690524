// SPDX-License-Identifier: GPL-3.0-or-later
// Writing: a file appears whole or not at all.
#include "world_fixture.h"

#include "enfilade/run.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static size_t files_in_here(void) {
    FILE *pipe = popen("ls -A | wc -l", "r");
    size_t count = 0;
    assert_non_null(pipe);
    assert_int_equal(fscanf(pipe, "%zu", &count), 1);
    pclose(pipe);
    return count;
}

static void failing_to_write_leaves_nothing_behind(void **state) {
    fixture_saved *s = *state;
    char folder[] = "format-XXXXXX";
    assert_non_null(mkdtemp(folder));
    assert_int_equal(chdir(folder), 0);
    const enf_build *build = &s->fixture.build;
    enf_error error = {0};
    assert_int_equal(enf_build_write(build, NULL, "no-such-folder/world.enf", &error), ENF_NO_RESOURCES);
    assert_non_null(strstr(error.text, "no-such-folder/world.enf"));
    assert_int_equal(enf_build_write(build, NULL, ".", &error), ENF_NO_RESOURCES);
    assert_int_equal(enf_build_write(build, NULL, "", &error), ENF_NO_RESOURCES);
    if (access("/dev/full", W_OK) == 0) {
        assert_int_equal(enf_build_write(build, NULL, "/dev/full", &error), ENF_NO_RESOURCES);
        struct stat about;
        assert_int_equal(stat("/dev/full", &about), 0);
        assert_true(S_ISCHR(about.st_mode)); // still the device
    }
    assert_int_equal(mkdir("locked", 0555), 0);
    if (access("locked", W_OK) != 0)
        assert_int_equal(enf_build_write(build, NULL, "locked/world.enf", &error), ENF_NO_RESOURCES);
    assert_int_equal(rmdir("locked"), 0); // and so it is empty
    assert_int_equal(files_in_here(), 0);
    assert_int_equal(chdir(".."), 0);
    assert_int_equal(rmdir(folder), 0);
}

static void a_full_disk_leaves_the_old_file(void **state) {
    fixture_saved *s = *state;
    char path[] = "full-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, "old", 3), 3);
    close(file);
    struct rlimit limit, small;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    small = limit;
    small.rlim_cur = 4096;
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    enf_error error = {0};
    enf_status status = enf_build_write(&s->fixture.build, NULL, path, &error);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    signal(SIGXFSZ, handler);
    assert_int_equal(status, ENF_NO_RESOURCES);
    size_t size;
    unsigned char *bytes = fixture_read_file(path, &size);
    assert_int_equal(size, 3);
    assert_memory_equal(bytes, "old", 3);
    free(bytes);
    remove(path);
}

static void an_old_file_is_replaced_as_a_whole(void **state) {
    fixture_saved *s = *state;
    char folder[] = "format-XXXXXX";
    assert_non_null(mkdtemp(folder));
    assert_int_equal(chdir(folder), 0);
    FILE *old = fopen("world.enf", "w");
    fputs("something older", old);
    fclose(old);
    assert_int_equal(symlink("world.enf", "link.enf"), 0);
    enf_error error = {0};
    assert_int_equal(enf_build_write(&s->fixture.build, "{\"stop\":\"auto\"}", "link.enf", &error), ENF_OK);
    size_t size;
    unsigned char *bytes = fixture_read_file("world.enf", &size);
    assert_int_equal(size, s->size);
    assert_memory_equal(bytes, s->bytes, size);
    free(bytes);
    assert_int_equal(files_in_here(), 2);
    enf_world *world;
    assert_int_equal(enf_world_open_path(&world, "link.enf", NULL, &error), ENF_OK);
    enf_world_close(world);
    assert_int_equal(remove("link.enf") + remove("world.enf"), 0);
    assert_int_equal(chdir(".."), 0);
    assert_int_equal(rmdir(folder), 0);
}

static void a_broken_build_is_not_written(void **state) {
    (void)state;
    fixture f;
    fixture_make(&f, 2, NULL);
    f.build.complex.piece_facet[3] = 1 << 20;
    enf_error error = {0};
    assert_int_equal(enf_build_write(&f.build, NULL, "never.enf", &error), ENF_CHECK_FAILED);
    assert_int_not_equal(access("never.enf", F_OK), 0);
    fixture_free(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(failing_to_write_leaves_nothing_behind),
        cmocka_unit_test(a_full_disk_leaves_the_old_file),
        cmocka_unit_test(an_old_file_is_replaced_as_a_whole),
        cmocka_unit_test(a_broken_build_is_not_written),
    };
    return cmocka_run_group_tests(tests, fixture_set_up, fixture_tear_down);
}
