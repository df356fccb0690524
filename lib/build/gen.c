// SPDX-License-Identifier: GPL-3.0-or-later
// The list of test worlds and the reading of their settings.
#include "build/gen.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "build/gen_world.h"

typedef void generator(enf_gen_world *world, const enf_gen_options *options);

typedef struct entry {
    const char *name, *description;
    generator *make;
    double size_max; // of floors * rooms * detail^2; 0: takes none of these
} entry;

static const entry entries[] = {
    {"four-rooms", "four unaligned rooms in a ring, joined by four short corridors, in the fewest triangles",
     enf_gen_four_rooms, 0},
    {"four-rooms-tessellated", "the same rooms in roughly equal triangles", enf_gen_four_rooms_tessellated,
     0},
    {"four-rooms-distorted", "the same rooms, each turned about all axes, some corners displaced",
     enf_gen_four_rooms_distorted, 0},
    {"cavern", "six irregular rooms, seven flaring passages, no axis-aligned face", enf_gen_cavern, 0},
    {"caverns",
     "floors=F storeys of rooms=R irregular rooms, passages and shafts; detail=N makes the rock finer",
     enf_gen_caverns, 1.5e5}, // about 970 triangles each
    {"furnished", "a room with a perturbed wall, a table and chairs, and a small room next door",
     enf_gen_furnished, 0},
    {"office",
     "floors=F storeys of rooms=R rooms each, corridors, stairs, windows; detail=N splits every wall",
     enf_gen_office, 1e6}, // about 108 triangles each
    {"post", "a square post with four rooms around it", enf_gen_post_world, 0},
};

enum {
    ENTRY_COUNT = sizeof entries / sizeof *entries,
    FLOORS_MAX = 1000,
    ROOMS_MAX = 100000,
    DETAIL_MAX = 100
};

static const double number_max = 1e12; // any length, factor or angle

const char *enf_gen_list(size_t index, const char **description) {
    if (index >= ENTRY_COUNT) return NULL;
    if (description) *description = entries[index].description;
    return entries[index].name;
}

static const entry *find_entry(const char *name) {
    for (size_t i = 0; i < ENTRY_COUNT; i++)
        if (strcmp(entries[i].name, name) == 0) return &entries[i];
    return NULL;
}

// Reads one to three numbers separated by commas; returns how many, or 0.
static int read_numbers(const char *text, double numbers[3]) {
    for (int count = 0; count < 3; count++) {
        char *end;
        if (!strchr("+-.0123456789", *text) || !*text) return 0;
        numbers[count] = strtod(text, &end);
        if (end == text || !isfinite(numbers[count]) || fabs(numbers[count]) > number_max) return 0;
        if (!*end) return count + 1;
        if (*end != ',') return 0;
        text = end + 1;
    }
    return 0;
}

static enf_status bad_value(const char *setting, const char *wanted, enf_error *error) {
    return enf_fail(error, ENF_BAD_USAGE, "gen: '%.100s' is not a valid setting; write %s", setting, wanted);
}

static enf_status read_count(const char *setting, const char *value, int64_t most, int64_t *out,
                             enf_error *error) {
    char *end;
    errno = 0;
    long long number = strtoll(value, &end, 10);
    if (*value < '0' || *value > '9' || *end || errno || number < 1 || number > most)
        return enf_fail(error, ENF_BAD_USAGE,
                        "gen: '%.100s' is not a valid setting; write a whole number from 1 to %lld", setting,
                        (long long)most);
    *out = number;
    return ENF_OK;
}

static enf_status read_seed(const char *setting, const char *value, uint64_t *out, enf_error *error) {
    char *end;
    errno = 0;
    unsigned long long number = strtoull(value, &end, 10);
    if (*value < '0' || *value > '9' || *end || errno)
        return bad_value(setting, "seed=N with a whole number N from 0 to 2^64 - 1", error);
    *out = number;
    return ENF_OK;
}

static enf_status read_vector(const char *setting, const char *value, const char *wanted, double out[3],
                              enf_error *error) {
    double numbers[3];
    if (read_numbers(value, numbers) != 3) return bad_value(setting, wanted, error);
    memcpy(out, numbers, sizeof numbers);
    return ENF_OK;
}

static enf_status read_scale(const char *setting, const char *value, double out[3], enf_error *error) {
    double numbers[3];
    int count = read_numbers(value, numbers);
    if (count == 1) numbers[1] = numbers[2] = numbers[0];
    if ((count != 1 && count != 3) || numbers[0] == 0 || numbers[1] == 0 || numbers[2] == 0)
        return bad_value(setting, "scale=S or scale=SX,SY,SZ, not 0, at most 1e12", error);
    memcpy(out, numbers, sizeof numbers);
    return ENF_OK;
}

static enf_status read_noise(const char *setting, const char *value, double *out, enf_error *error) {
    double numbers[3];
    if (read_numbers(value, numbers) != 1 || numbers[0] < 0)
        return bad_value(setting, "noise=A with a length A >= 0 in world units", error);
    *out = numbers[0];
    return ENF_OK;
}

static bool key_is(const char *setting, const char *key) {
    size_t length = strlen(key);
    return strncmp(setting, key, length) == 0 && setting[length] == '=';
}

static enf_status read_setting(const char *setting, const entry *world, enf_gen_options *options,
                               enf_error *error) {
    const char *equals = strchr(setting, '='), *value = equals ? equals + 1 : "";
    if (key_is(setting, "scale")) return read_scale(setting, value, options->scale, error);
    if (key_is(setting, "noise")) return read_noise(setting, value, &options->noise, error);
    if (key_is(setting, "seed")) return read_seed(setting, value, &options->seed, error);
    if (key_is(setting, "rotate"))
        return read_vector(setting, value, "rotate=AX,AY,AZ in degrees, at most 1e12", options->rotate,
                           error);
    if (key_is(setting, "translate"))
        return read_vector(setting, value, "translate=X,Y,Z, at most 1e12", options->translate, error);
    if (world->size_max > 0 && key_is(setting, "floors"))
        return read_count(setting, value, FLOORS_MAX, &options->floors, error);
    if (world->size_max > 0 && key_is(setting, "rooms"))
        return read_count(setting, value, ROOMS_MAX, &options->rooms, error);
    if (world->size_max > 0 && key_is(setting, "detail"))
        return read_count(setting, value, DETAIL_MAX, &options->detail, error);
    return enf_fail(
        error, ENF_BAD_USAGE,
        "gen: '%.100s' is not a setting of %s; it takes %sscale=, noise=, seed=, rotate=, translate=",
        setting, world->name, world->size_max > 0 ? "floors=, rooms=, detail=, " : "");
}

// The length of the key, for finding the same key twice.
static size_t key_length(const char *setting) {
    return strcspn(setting, "=");
}

static enf_status read_settings(const char *const *settings, size_t count, const entry *world,
                                enf_gen_options *options, enf_error *error) {
    for (size_t i = 0; i < count; i++) {
        enf_status status = read_setting(settings[i], world, options, error);
        if (status != ENF_OK) return status;
        size_t length = key_length(settings[i]);
        for (size_t j = 0; j < i; j++)
            if (key_length(settings[j]) == length && strncmp(settings[i], settings[j], length) == 0)
                return enf_fail(error, ENF_BAD_USAGE, "gen: '%.*s' is given twice; leave one out",
                                (int)length, settings[i]);
    }
    double size =
        (double)options->floors * (double)options->rooms * (double)options->detail * (double)options->detail;
    if (world->size_max > 0 && size > world->size_max)
        return enf_fail(
            error, ENF_BAD_USAGE,
            "gen: floors * rooms * detail^2 is %.0f, at most %.0f is possible; choose smaller numbers", size,
            world->size_max);
    return ENF_OK;
}

static enf_status unknown_world(const char *name, enf_error *error) {
    char names[256] = "";
    for (size_t i = 0; i < ENTRY_COUNT; i++) {
        size_t length = strlen(names);
        snprintf(names + length, sizeof names - length, "%s%s", i ? ", " : "", entries[i].name);
    }
    return enf_fail(error, ENF_BAD_USAGE, "gen: there is no world '%.100s'; choose one of %s", name, names);
}

enf_status enf_gen_write(const char *name, const char *const *settings, size_t setting_count, FILE *out,
                         enf_error *error) {
    const entry *found = find_entry(name);
    if (!found) return unknown_world(name, error);
    enf_gen_options options = {.floors = 2, .rooms = 6, .detail = 1, .seed = 1, .scale = {1, 1, 1}};
    enf_status status = read_settings(settings, setting_count, found, &options, error);
    if (status != ENF_OK) return status;
    enf_gen_world world = {0};
    found->make(&world, &options);
    if (world.failed) {
        status = enf_fail_memory(error, "a test world");
    } else {
        enf_gen_transform(&world, &options);
        if (!enf_gen_print(&world, name, settings, setting_count, out))
            status = enf_fail(error, ENF_NO_RESOURCES, "gen: can't write the world: %s", strerror(errno));
    }
    enf_gen_world_free(&world);
    return status;
}
