// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/bench_visibility.h"

#include <math.h>

// Pixels.
static const double width = 720, height = 420, left = 84, right = 120, top = 56, bottom = 64;

typedef struct axes {
    double low, high; ///< powers of ten, seconds
    double most;      ///< share of wrong pairs, powers of ten from `least` on
    double least;
} axes;

static double find_share(const cli_visibility_measure measures[ENF_METHOD_COUNT], int method) {
    return (double)measures[method].wrong / ((double)measures[ENF_METHOD_EXACT].pairs / 2);
}

/// The axes begin and end at powers of ten; methods without an error stand on the lower edge.
static axes find_axes(const cli_visibility_measure measures[ENF_METHOD_COUNT]) {
    axes axes = {.low = 0, .high = 0, .least = -3, .most = 0};
    for (int m = ENF_METHOD_FACING; m < ENF_METHOD_COUNT; m++) {
        double seconds = log10(fmax(measures[m].seconds, 1e-3));
        if (m == ENF_METHOD_FACING || floor(seconds) < axes.low) axes.low = floor(seconds);
        if (m == ENF_METHOD_FACING || ceil(seconds + 0.05) > axes.high) axes.high = ceil(seconds + 0.05);
        axes.most = fmax(axes.most, ceil(log10(fmax(find_share(measures, m), 1e-3))));
    }
    if (axes.high <= axes.low) axes.high = axes.low + 1;
    return axes;
}

static double page_x(const axes *axes, double seconds) {
    double share = (log10(fmax(seconds, 1e-3)) - axes->low) / (axes->high - axes->low);
    return left + share * (width - left - right);
}

static double page_y(const axes *axes, double error) {
    double share = (log10(fmax(error, pow(10, axes->least))) - axes->least) / (axes->most - axes->least);
    return height - bottom - share * (height - top - bottom);
}

static void put_grid(const axes *axes, FILE *out) {
    for (double power = axes->low; power <= axes->high; power++) {
        double x = page_x(axes, pow(10, power));
        fprintf(out, "<path d=\"M%.1f %.1fV%.1f\" stroke=\"#ddd\"/>\n", x, top, height - bottom);
        fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%g s</text>\n", x,
                height - bottom + 20, pow(10, power));
    }
    for (double power = axes->least; power <= axes->most; power++) {
        double y = page_y(axes, pow(10, power));
        fprintf(out, "<path d=\"M%.1f %.1fH%.1f\" stroke=\"#ddd\"/>\n", left, y, width - right);
        fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">%g %%</text>\n", left - 8, y + 4,
                100 * pow(10, power));
    }
}

void cli_visibility_plot(const cli_visibility_measure measures[ENF_METHOD_COUNT], const char *title,
                         FILE *out) {
    axes axes = find_axes(measures);
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%g\" height=\"%g\" font-family=\"sans-serif\" "
            "font-size=\"13\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
            width, height);
    fprintf(out, "<text x=\"%g\" y=\"30\" font-size=\"17\">%s</text>\n", left, title);
    put_grid(&axes, out);
    fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">processor time, all levels</text>\n",
            (left + width - right) / 2, height - 14);
    fprintf(out,
            "<text transform=\"translate(18 %.1f) rotate(-90)\" text-anchor=\"middle\">pairs wrongly "
            "visible</text>\n",
            (top + height - bottom) / 2);
    for (int m = ENF_METHOD_FACING; m < ENF_METHOD_COUNT; m++) {
        double error = find_share(measures, m), x = page_x(&axes, measures[m].seconds),
               y = page_y(&axes, error);
        fprintf(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"6\" fill=\"#e4572e\"/>\n", x, y);
        fprintf(out, "<text x=\"%.1f\" y=\"%.1f\">%s: %.3g s, %.3g %%</text>\n", x + 11, y - 7,
                enf_method_name((enf_method)m), measures[m].seconds, 100 * error);
    }
    fputs("</svg>\n", out);
}
