// SPDX-License-Identifier: GPL-3.0-or-later
// Scale, noise, rotation and translation of a test world. Only +, -, *, / and sqrt are used, which every
// IEEE machine rounds alike.
#include <math.h>
#include <string.h>

#include "build/gen_world.h"

double enf_gen_round(double value) {
    return floor(value * 1000.0 + 0.5) / 1000.0 + 0.0;
}

// Taylor series about 0 for |radians| <= pi/4: the rest after eight terms is below 2^-60.
static double series(double start, int first, double radians) {
    double square = radians * radians, term = start, sum = 0.0;
    double terms[10];
    for (int i = 0; i < 10; i++) {
        terms[i] = term;
        term = -term * square / (double)((first + 2 * i + 1) * (first + 2 * i + 2));
    }
    for (int i = 9; i >= 0; i--) sum += terms[i];
    return sum;
}

void enf_gen_sine_cosine(double degrees, double *sine, double *cosine) {
    double turned = fmod(degrees, 360.0); // exact
    int quarter = (int)floor(turned / 90.0 + 0.5);
    double radians = (turned - 90.0 * quarter) * 0.017453292519943295;
    double s = series(radians, 1, radians), c = series(1.0, 0, radians);
    switch (quarter & 3) {
    case 0:
        *sine = s, *cosine = c;
        break;
    case 1:
        *sine = c, *cosine = -s;
        break;
    case 2:
        *sine = -s, *cosine = -c;
        break;
    default:
        *sine = -c, *cosine = s;
        break;
    }
}

void enf_gen_rotation(const double degrees[3], double matrix[3][3]) {
    double s[3], c[3];
    for (int a = 0; a < 3; a++) enf_gen_sine_cosine(degrees[a], &s[a], &c[a]);
    const double rows[3][3] = {
        {c[2] * c[1], c[2] * s[1] * s[0] - s[2] * c[0], c[2] * s[1] * c[0] + s[2] * s[0]},
        {s[2] * c[1], s[2] * s[1] * s[0] + c[2] * c[0], s[2] * s[1] * c[0] - c[2] * s[0]},
        {-s[1], c[1] * s[0], c[1] * c[0]},
    };
    memcpy(matrix, rows, sizeof rows);
}

void enf_gen_rotate(double matrix[3][3], const double in[3], double out[3]) {
    double result[3];
    for (int a = 0; a < 3; a++)
        result[a] = matrix[a][0] * in[0] + matrix[a][1] * in[1] + matrix[a][2] * in[2];
    memcpy(out, result, sizeof result);
}

// A vector of at most this length, evenly spread over the ball.
static void noise_vector(uint64_t *state, double length, double out[3]) {
    do {
        for (int a = 0; a < 3; a++) out[a] = enf_gen_random_unit(state);
    } while (out[0] * out[0] + out[1] * out[1] + out[2] * out[2] > 1.0);
    for (int a = 0; a < 3; a++) out[a] *= length;
}

static void place(const enf_gen_options *options, double matrix[3][3], bool turn, double point[3]) {
    if (turn) enf_gen_rotate(matrix, point, point);
    for (int a = 0; a < 3; a++) point[a] = point[a] + options->translate[a] + 0.0;
}

void enf_gen_transform(enf_gen_world *world, const enf_gen_options *options) {
    double matrix[3][3];
    enf_gen_rotation(options->rotate, matrix);
    const double *scale = options->scale, *angles = options->rotate;
    bool turn = angles[0] != 0 || angles[1] != 0 || angles[2] != 0;
    uint64_t state = options->seed;
    for (size_t i = 0; i < world->point_count; i++) {
        double *point = world->points[i], noise[3] = {0, 0, 0};
        if (options->noise > 0) noise_vector(&state, options->noise, noise);
        for (int a = 0; a < 3; a++) point[a] = point[a] * scale[a] + noise[a];
        place(options, matrix, turn, point);
    }
    for (size_t i = 0; i < world->spawn_count; i++) {
        for (int a = 0; a < 3; a++) world->spawns[i][a] *= scale[a];
        place(options, matrix, turn, world->spawns[i]);
    }
    if ((scale[0] < 0) ^ (scale[1] < 0) ^ (scale[2] < 0))
        for (size_t i = 0; i < world->triangle_count; i++) {
            int32_t *corners = world->triangles[i], second = corners[1];
            corners[1] = corners[2], corners[2] = second;
        }
}
