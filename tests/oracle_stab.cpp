// SPDX-License-Identifier: GPL-3.0-or-later
#include "oracle_stab.h"

#include <CGAL/Gmpq.h>
#include <CGAL/Gmpz.h>
#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>

#include <algorithm>
#include <array>
#include <bitset>
#include <cstdlib>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

using integer = CGAL::Gmpz;
using rational = CGAL::Gmpq;
using point = std::array<rational, 3>;
using vector = std::array<integer, 6>; // (direction, moment) or, for constraints, (moment, direction)

point exact(const double p[3]) {
    return {rational(p[0]), rational(p[1]), rational(p[2])};
}

point minus(const point &a, const point &b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

point cross(const point &a, const point &b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

rational dot(const point &a, const point &b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

integer gcd(const integer &a, const integer &b) {
    return CGAL::Algebraic_structure_traits<integer>::Gcd()(a, b);
}

void shorten(vector &v) {
    integer divisor = 0;
    for (const integer &x : v) divisor = gcd(divisor, x);
    if (divisor > 1) {
        for (integer &x : v) x = x / divisor;
    }
}

std::vector<vector> constraints_of(const oracle_edge *edges, int count) {
    std::vector<vector> out;
    const point origin = exact(edges[0].a);
    for (int k = 0; k < count; k++) {
        const point a = minus(exact(edges[k].a), origin), b = minus(exact(edges[k].b), origin);
        const point moment = cross(a, b), along = minus(b, a);
        integer common = 1; // denominators are powers of two
        for (const point *part : {&moment, &along}) {
            for (const rational &x : *part) common = std::max(common, x.denominator());
        }
        vector v;
        for (size_t i = 0; i < 3; i++) {
            v[i] = (moment[i] * rational(common)).numerator();
            v[i + 3] = (along[i] * rational(common)).numerator();
        }
        shorten(v);
        out.push_back(v);
    }
    return out;
}

integer product_of(const vector &a, const vector &b) {
    integer sum = 0;
    for (size_t i = 0; i < 6; i++) sum += a[i] * b[i];
    return sum;
}

integer form(const vector &a, const vector &b) {
    integer sum = 0;
    for (size_t i = 0; i < 6; i++) sum += a[i] * b[(i + 3) % 6];
    return sum;
}

size_t rank_of(const std::vector<vector> &rows) {
    std::vector<std::array<rational, 6>> m;
    for (const vector &row : rows) {
        m.emplace_back();
        for (size_t i = 0; i < 6; i++) m.back()[i] = rational(row[i]);
    }
    size_t rank = 0;
    for (size_t c = 0; c < 6; c++) {
        size_t r = rank;
        while (r < m.size() && m[r][c] == 0) r++;
        if (r == m.size()) continue;
        std::swap(m[r], m[rank]);
        for (size_t i = rank + 1; i < m.size(); i++) {
            if (m[i][c] == 0) continue;
            const rational factor = m[i][c] / m[rank][c];
            for (size_t j = c; j < 6; j++) m[i][j] -= factor * m[rank][j];
        }
        rank++;
    }
    return rank;
}

// The generalized cross product of five rows: what all of them give 0 with.
vector across(const std::vector<vector> &rows, size_t left_out) {
    std::vector<std::array<rational, 7>> m;
    for (size_t r = 0; r < rows.size(); r++) {
        m.emplace_back();
        for (size_t i = 0; i < 6; i++) m.back()[i] = rational(rows[r][i]);
        m.back()[6] = rational(r == left_out ? 1 : 0);
    }
    for (size_t c = 0; c < 6; c++) {
        size_t r = c;
        while (m[r][c] == 0) r++;
        std::swap(m[r], m[c]);
        for (size_t i = 0; i < 6; i++) {
            if (i == c || m[i][c] == 0) continue;
            const rational factor = m[i][c] / m[c][c];
            for (size_t j = 0; j < 7; j++) m[i][j] -= factor * m[c][j];
        }
    }
    integer common = 1;
    for (size_t i = 0; i < 6; i++) {
        m[i][6] /= m[i][i];
        common = common * m[i][6].denominator() / gcd(common, m[i][6].denominator());
    }
    vector out;
    for (size_t i = 0; i < 6; i++) out[i] = (m[i][6] * rational(common)).numerator();
    shorten(out);
    return out;
}

using tight_set = std::bitset<512>;

tight_set tight_of(const vector &ray, const std::vector<vector> &constraints) {
    tight_set tight;
    for (size_t k = 0; k < constraints.size(); k++) tight[k] = product_of(ray, constraints[k]) == 0;
    return tight;
}

size_t rank_of(const tight_set &tight, const std::vector<vector> &constraints) {
    std::vector<vector> rows;
    for (size_t k = 0; k < constraints.size(); k++) {
        if (tight[k]) rows.push_back(constraints[k]);
    }
    return rank_of(rows);
}

// The extreme rays of a pointed cone: each lies in five independent constraints. Whatever joins two of them
// lies in four at least.
std::vector<vector> rays_of(const std::vector<vector> &constraints) {
    std::vector<vector> used, rest;
    for (const vector &c : std::set<vector>(constraints.begin(), constraints.end())) {
        used.push_back(c);
        if (used.size() <= 6 && rank_of(used) == used.size()) continue;
        used.pop_back();
        rest.push_back(c);
    }
    std::vector<vector> rays;
    for (size_t i = 0; i < 6; i++) rays.push_back(across(used, i));
    for (const vector &c : rest) {
        std::vector<tight_set> tight;
        std::vector<integer> value;
        for (const vector &r : rays) {
            tight.push_back(tight_of(r, used));
            value.push_back(product_of(r, c));
        }
        used.push_back(c);
        std::set<vector> next;
        for (size_t r = 0; r < rays.size(); r++) {
            if (value[r] >= 0) next.insert(rays[r]);
            for (size_t s = 0; value[r] > 0 && s < rays.size(); s++) {
                if (value[s] >= 0 || (tight[r] & tight[s]).count() < 4) continue;
                vector meeting;
                for (size_t i = 0; i < 6; i++) meeting[i] = value[r] * rays[s][i] - value[s] * rays[r][i];
                shorten(meeting);
                if (rank_of(tight_of(meeting, used), used) == 5) next.insert(meeting);
            }
        }
        rays.assign(next.begin(), next.end());
    }
    return rays;
}

using matrix = std::vector<std::vector<integer>>;

integer determinant(const matrix &m) {
    if (m.empty()) return 1;
    integer sum = 0;
    for (size_t c = 0; c < m.size(); c++) {
        if (m[0][c] == 0) continue;
        matrix minor;
        for (size_t i = 1; i < m.size(); i++) {
            minor.emplace_back();
            for (size_t j = 0; j < m.size(); j++) {
                if (j != c) minor.back().push_back(m[i][j]);
            }
        }
        sum += (c % 2 ? -m[0][c] : m[0][c]) * determinant(minor);
    }
    return sum;
}

bool adjugate_is_not_negative(const matrix &m) {
    for (size_t r = 0; r < m.size(); r++) {
        for (size_t c = 0; c < m.size(); c++) {
            matrix minor;
            for (size_t i = 0; i < m.size(); i++) {
                if (i == r) continue;
                minor.emplace_back();
                for (size_t j = 0; j < m.size(); j++) {
                    if (j != c) minor.back().push_back(m[i][j]);
                }
            }
            if (((r + c) % 2 ? -1 : 1) * determinant(minor) < 0) return false;
        }
    }
    return true;
}

// K. P. Hadeler, "On copositive matrices" (1983): a symmetric matrix whose proper principal submatrices are
// copositive is itself not copositive if and only if its determinant is negative and its adjugate has no
// negative entry. Of the forms between rays no such submatrix has more than four rows, as it would have one
// negative and otherwise positive eigenvalues, and the quadric has three of each.
bool falls(const std::vector<vector> &rays, int sign) {
    const size_t count = rays.size();
    matrix all(count, std::vector<integer>(count));
    for (size_t i = 0; i < count; i++) {
        for (size_t j = 0; j < count; j++) all[i][j] = sign * form(rays[i], rays[j]);
    }
    std::vector<size_t> chosen;
    auto submatrix_falls = [&]() {
        matrix m;
        for (size_t i : chosen) {
            m.emplace_back();
            for (size_t j : chosen) m.back().push_back(all[i][j]);
        }
        return determinant(m) < 0 && adjugate_is_not_negative(m);
    };
    for (size_t i = 0; i < count; i++) {
        if (all[i][i] < 0) return true;
    }
    bool mixed = false;
    for (size_t i = 0; i < count; i++) {
        for (size_t j = 0; j < i; j++) {
            mixed |= all[i][j] < 0;
            chosen = {i, j};
            if (all[i][j] < 0 && submatrix_falls()) return true;
        }
    }
    for (size_t i = 0; mixed && i < count; i++) {
        for (size_t j = 0; j < i; j++) {
            for (size_t k = 0; k < j; k++) {
                chosen = {i, j, k};
                if (submatrix_falls()) return true;
                for (size_t l = 0; l < k; l++) {
                    chosen = {i, j, k, l};
                    if (submatrix_falls()) return true;
                }
            }
        }
    }
    return false;
}

} // namespace

static bool passes(const oracle_edge *edges, int count, const point &start, const point &end) {
    const point along = minus(end, start);
    for (int k = 0; k < count; k++) {
        const point a = minus(exact(edges[k].a), start), b = minus(exact(edges[k].b), start);
        if (!(dot(along, cross(a, b)) > 0)) return false;
    }
    return true;
}

bool oracle_stab_passes(const oracle_edge *edges, int count, const double from[3], const double to[3]) {
    return passes(edges, count, exact(from), exact(to));
}

// A sign or none, digits with a point or without, an exponent or none.
static bool parse(const std::string &word, rational &out) {
    const std::regex form("(-?)([0-9]+)\\.?([0-9]*)(e([-+])([0-9]+))?");
    std::smatch part;
    if (!std::regex_match(word, part, form)) return false;
    integer digits = 0, power = 1;
    for (char digit : part[2].str() + part[3].str()) digits = digits * 10 + (digit - '0');
    long exponent = part[6].length() > 0 ? std::stol(part[6]) : 0;
    if (part[5] == "-") exponent = -exponent;
    exponent -= static_cast<long>(part[3].length());
    for (long i = 0; i < std::labs(exponent); i++) power = power * 10;
    out = exponent < 0 ? rational(digits, power) : rational(digits * power);
    if (part[1] == "-") out = -out;
    return true;
}

bool oracle_stab_passes_text(const oracle_edge *edges, int count, const char *line) {
    std::istringstream words(line);
    std::vector<rational> numbers;
    for (std::string word; words >> word;) {
        rational number;
        if (!parse(word, number)) return false;
        numbers.push_back(number);
    }
    if (numbers.size() != 6) return false;
    return passes(edges, count, {numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]});
}

// By Gordan's theorem there is an x if and only if no weights >= 0 with sum 1 combine the constraints to 0.
bool oracle_stab_program(const oracle_edge *edges, int count) {
    CGAL::Quadratic_program<integer> program(CGAL::EQUAL, true, 0, false, 0);
    const std::vector<vector> constraints = constraints_of(edges, count);
    for (int k = 0; k < count; k++) {
        for (int i = 0; i < 6; i++)
            program.set_a(k, i, constraints[static_cast<size_t>(k)][static_cast<size_t>(i)]);
        program.set_a(k, 6, 1);
    }
    program.set_b(6, 1);
    CGAL::Quadratic_program_options options;
    options.set_pricing_strategy(CGAL::QP_BLAND);
    return CGAL::solve_linear_program(program, integer(), options).is_infeasible();
}

bool oracle_stab_line(const oracle_edge *edges, int count) {
    std::vector<vector> constraints = constraints_of(edges, count), completing;
    for (size_t i = 0, rank = rank_of(constraints); i < 6 && rank + completing.size() < 6; i++) {
        vector unit{0, 0, 0, 0, 0, 0};
        unit[i] = 1;
        std::vector<vector> more = constraints;
        more.insert(more.end(), completing.begin(), completing.end());
        const size_t before = rank_of(more);
        more.push_back(unit);
        if (rank_of(more) > before) completing.push_back(unit);
    }
    bool plus = false, minus = false;
    for (size_t signs = 0; signs < size_t(1) << completing.size() && !(plus && minus); signs++) {
        std::vector<vector> pointed = constraints;
        for (size_t i = 0; i < completing.size(); i++) {
            vector v = completing[i];
            for (integer &x : v) x = signs >> i & 1 ? -x : x;
            pointed.push_back(v);
        }
        const std::vector<vector> rays = rays_of(pointed);
        plus |= falls(rays, -1);
        minus |= falls(rays, 1);
    }
    return plus && minus;
}

int oracle_stab_cone(const double (*sides)[6], int count, int sign, bool *does_fall) {
    std::vector<vector> constraints;
    for (int k = 0; k < count; k++) {
        vector v;
        for (size_t i = 0; i < 6; i++) v[i] = integer(sides[k][i]);
        constraints.push_back(v);
    }
    *does_fall = false;
    if (rank_of(constraints) < 6) return 0;
    const std::vector<vector> rays = rays_of(constraints);
    *does_fall = falls(rays, sign);
    return static_cast<int>(rays.size());
}
