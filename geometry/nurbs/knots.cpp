// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/nurbs/knots.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace pneuma::geometry::nurbs {

void check(const Knots& knots) {
  const int p = knots.degree;
  if (p < 1 || p > max_degree) {
    throw std::invalid_argument(fmt::format("the degree must be 1 to {}, not {}", max_degree, p));
  }
  const std::vector<double>& t = knots.values;
  const std::size_t ends = static_cast<std::size_t>(p) + 1;
  if (t.size() < 2 * ends) {
    throw std::invalid_argument(fmt::format("degree {} needs {} knots at least, not {}", p, 2 * ends, t.size()));
  }
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (!std::isfinite(t[i])) throw std::invalid_argument(fmt::format("knot {} is not finite", i));
    if (i > 0 && t[i] < t[i - 1]) {
      throw std::invalid_argument(fmt::format("knots must not fall: {} follows {}", t[i], t[i - 1]));
    }
  }
  if (t[0] != t[ends - 1] || t[t.size() - 1] != t[t.size() - ends]) {
    throw std::invalid_argument(fmt::format("the first and the last {} knots must be equal", ends));
  }
  for (std::size_t i = 1; i + ends < t.size(); ++i) {
    if (t[i] == t[i + ends - 1]) throw std::invalid_argument(fmt::format("knot {} stands more than {} times", t[i], p));
  }
}

Knots from_breaks(int degree, std::span<const double> breaks) {
  for (std::size_t i = 1; i < breaks.size(); ++i) {
    if (!(breaks[i] > breaks[i - 1])) {
      throw std::invalid_argument(fmt::format("breaks must rise: {} follows {}", breaks[i], breaks[i - 1]));
    }
  }
  if (breaks.size() < 2) throw std::invalid_argument("two breaks at least");
  Knots knots{degree, std::vector<double>(static_cast<std::size_t>(std::max(degree, 0)), breaks.front())};
  knots.values.insert(knots.values.end(), breaks.begin(), breaks.end());
  knots.values.insert(knots.values.end(), static_cast<std::size_t>(std::max(degree, 0)), breaks.back());
  check(knots);
  return knots;
}

Knots uniform(int degree, int functions, double first, double last) {
  if (functions <= degree) {
    throw std::invalid_argument(
        fmt::format("degree {} needs {} control points at least, not {}", degree, degree + 1, functions));
  }
  const int spans = functions - degree;
  std::vector<double> breaks(static_cast<std::size_t>(spans) + 1);
  for (int i = 0; i <= spans; ++i) breaks[static_cast<std::size_t>(i)] = first + (last - first) * i / spans;
  breaks.back() = last;
  return from_breaks(degree, breaks);
}

Knots averaged(int degree, int functions, std::span<const double> parameters) {
  const int count = static_cast<int>(parameters.size());
  if (functions <= degree || count < functions) {
    throw std::invalid_argument(
        fmt::format("{} control points need degree < {} and {} parameters at least, not {} and {}", functions,
                    functions, functions, degree, count));
  }
  const auto at = [&](int i) { return parameters[static_cast<std::size_t>(i)]; };
  std::vector<double> breaks = {at(0)};
  for (int j = 1; j < functions - degree; ++j) {
    if (count == functions) {
      double sum = 0;
      for (int i = j; i < j + degree; ++i) sum += at(i);
      breaks.push_back(sum / degree);
    } else {
      const double d = static_cast<double>(count) / (functions - degree);
      const int i = static_cast<int>(j * d);
      const double a = j * d - i;
      breaks.push_back((1 - a) * at(i - 1) + a * at(i));
    }
  }
  breaks.push_back(at(count - 1));
  return from_breaks(degree, breaks);
}

std::vector<double> breaks(const Knots& knots) {
  std::vector<double> distinct = knots.values;
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  return distinct;
}

std::vector<double> greville(const Knots& knots) {
  std::vector<double> abscissae(static_cast<std::size_t>(knots.functions()), 0.0);
  for (std::size_t i = 0; i < abscissae.size(); ++i) {
    for (std::size_t k = 1; k <= static_cast<std::size_t>(knots.degree); ++k) abscissae[i] += knots.values[i + k];
    abscissae[i] /= knots.degree;
  }
  return abscissae;
}

int find_span(const Knots& knots, double u) {
  const auto begin = knots.values.begin() + knots.degree + 1;
  const auto end = knots.values.begin() + knots.functions(); // the last knot's first copy
  return static_cast<int>(std::upper_bound(begin, end, u) - knots.values.begin()) - 1;
}

namespace {

// `t` points to the knot at the beginning of the span. Function r of degree d - 1 divided by the knots it spans, here
// temp, is what both the recursion and the derivatives are made of.
template <int P>
void evaluate_inside(const double* t, double u, int order, Basis& basis) {
  std::array<std::array<double, P + 1>, P + 1> values; // [degree][function]
  std::array<std::array<double, P>, P + 1> divisor;    // [degree][lower function]
  values[0][0] = 1;
  for (int d = 1; d <= P; ++d) {
    auto& higher = values[static_cast<std::size_t>(d)];
    const auto& lower = values[static_cast<std::size_t>(d - 1)];
    auto& inverse = divisor[static_cast<std::size_t>(d)];
    double saved = 0;
    for (int r = 0; r < d; ++r) {
      const double left = t[1 + r - d];
      const double right = t[1 + r];
      inverse[static_cast<std::size_t>(r)] = 1 / (right - left);
      const double temp = lower[static_cast<std::size_t>(r)] * inverse[static_cast<std::size_t>(r)];
      higher[static_cast<std::size_t>(r)] = saved + (right - u) * temp;
      saved = (u - left) * temp;
    }
    higher[static_cast<std::size_t>(d)] = saved;
  }
  for (std::size_t j = 0; j <= P; ++j) basis.functions[0][j] = values[P][j];
  for (int k = 1; k <= order; ++k) {
    auto& result = basis.functions[static_cast<std::size_t>(k)];
    result.fill(0);
    if (k > P) continue;
    for (std::size_t j = 0; j <= static_cast<std::size_t>(P - k); ++j) {
      result[j] = values[static_cast<std::size_t>(P - k)][j];
    }
    for (int d = P - k + 1; d <= P; ++d) {
      const auto& inverse = divisor[static_cast<std::size_t>(d)];
      double before = 0;
      for (int j = 0; j < d; ++j) {
        const double here = result[static_cast<std::size_t>(j)] * inverse[static_cast<std::size_t>(j)];
        result[static_cast<std::size_t>(j)] = d * (before - here);
        before = here;
      }
      result[static_cast<std::size_t>(d)] = d * before;
    }
  }
}

} // namespace

void evaluate_basis(const Knots& knots, double u, int order, Basis& basis) noexcept {
  const double inside = std::clamp(u, knots.first(), knots.last());
  const int span = find_span(knots, inside);
  basis.first = span - knots.degree;
  const double beyond = u - inside;
  const int needed = beyond == 0 ? order : std::max(order, 2);
  const double* t = knots.values.data() + span;
  switch (knots.degree) {
  case 1:
    evaluate_inside<1>(t, inside, needed, basis);
    break;
  case 2:
    evaluate_inside<2>(t, inside, needed, basis);
    break;
  case 3:
    evaluate_inside<3>(t, inside, needed, basis);
    break;
  case 4:
    evaluate_inside<4>(t, inside, needed, basis);
    break;
  case 5:
    evaluate_inside<5>(t, inside, needed, basis);
    break;
  case 6:
    evaluate_inside<6>(t, inside, needed, basis);
    break;
  default:
    evaluate_inside<7>(t, inside, needed, basis);
    break;
  }
  if (beyond == 0) return;
  auto& n = basis.functions;
  for (std::size_t j = 0; j <= static_cast<std::size_t>(knots.degree); ++j) {
    n[0][j] += beyond * (n[1][j] + 0.5 * beyond * n[2][j]);
    n[1][j] += beyond * n[2][j];
    n[3][j] = 0;
  }
}

} // namespace pneuma::geometry::nurbs
