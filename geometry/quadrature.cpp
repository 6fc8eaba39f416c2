// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/quadrature.h"

#include <array>
#include <cmath>
#include <stdexcept>

namespace pneuma::geometry {

namespace {

constexpr std::array<QuadraturePoint, 1> triangle_1 = {{{1.0 / 3, 1.0 / 3, 0.5}}};

constexpr std::array<QuadraturePoint, 3> triangle_3 = {
    {{1.0 / 6, 1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6, 1.0 / 6}, {1.0 / 6, 2.0 / 3, 1.0 / 6}}};

// degree 4; the constants in closed form, so that no digit is lost
std::array<QuadraturePoint, 6> make_triangle_6() {
  const double root10 = std::sqrt(10.0);
  const double root = std::sqrt(38.0 - 44.0 * std::sqrt(0.4));
  const double a = (8.0 - root10 + root) / 18.0;
  const double b = (8.0 - root10 - root) / 18.0;
  const double split = std::sqrt(213125.0 - 53320.0 * root10);
  const double wa = (620.0 + split) / 7440.0;
  const double wb = (620.0 - split) / 7440.0;
  return {{{a, a, wa}, {1 - 2 * a, a, wa}, {a, 1 - 2 * a, wa}, {b, b, wb}, {1 - 2 * b, b, wb}, {b, 1 - 2 * b, wb}}};
}

template <std::size_t N>
std::array<QuadraturePoint, N * N> tensor(const std::array<double, N>& x, const std::array<double, N>& w) {
  std::array<QuadraturePoint, N * N> rule{};
  for (std::size_t j = 0; j < N; ++j) {
    for (std::size_t i = 0; i < N; ++i) rule[j * N + i] = {x[i], x[j], w[i] * w[j]};
  }
  return rule;
}

const auto& square_4() {
  static const auto rule = tensor<2>({-1 / std::sqrt(3.0), 1 / std::sqrt(3.0)}, {1.0, 1.0});
  return rule;
}

const auto& square_9() {
  static const auto rule = tensor<3>({-std::sqrt(0.6), 0.0, std::sqrt(0.6)}, {5.0 / 9, 8.0 / 9, 5.0 / 9});
  return rule;
}

} // namespace

const char* name_of(ElementType type) {
  constexpr std::array names = {"T3", "T6", "Q4", "Q9"};
  return names[static_cast<std::size_t>(type)];
}

std::span<const QuadraturePoint> stress_rule(ElementType type, StressRule rule) {
  if (rule == StressRule::reduced) {
    if (type != ElementType::Q9) throw std::invalid_argument("a reduced stress rule exists for Q9 only");
    return square_4();
  }
  switch (type) {
  case ElementType::T3:
    return triangle_1;
  case ElementType::T6:
    return triangle_3;
  case ElementType::Q4:
    return square_4();
  default:
    return square_9();
  }
}

std::span<const QuadraturePoint> pressure_rule(ElementType type) {
  static const auto triangle_6 = make_triangle_6();
  switch (type) {
  case ElementType::T3:
    return triangle_1;
  case ElementType::T6:
    return triangle_6;
  case ElementType::Q4:
    return square_4();
  default:
    return square_9();
  }
}

} // namespace pneuma::geometry
