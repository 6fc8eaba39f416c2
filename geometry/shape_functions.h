// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "geometry/mesh.h"

namespace pneuma::geometry {

// Values and first derivatives of the shape functions at a point (xi, eta) of the reference element: the triangle
// (0,0) (1,0) (0,1) for T3 and T6, the square [-1,1]^2 for Q4 and Q9.
template <int N>
struct ShapeValues {
  Eigen::Matrix<double, N, 1> value;
  Eigen::Matrix<double, N, 2> derivative; // columns: d/dxi, d/deta
};

template <ElementType E>
ShapeValues<nodes_per_element(E)> shape_functions(double xi, double eta) {
  ShapeValues<nodes_per_element(E)> s;
  if constexpr (E == ElementType::T3) {
    s.value << 1 - xi - eta, xi, eta;
    s.derivative << -1, -1, 1, 0, 0, 1;
  } else if constexpr (E == ElementType::T6) {
    const double l = 1 - xi - eta;
    s.value << l * (2 * l - 1), xi * (2 * xi - 1), eta * (2 * eta - 1), 4 * l * xi, 4 * xi * eta, 4 * eta * l;
    s.derivative << 1 - 4 * l, 1 - 4 * l, //
        4 * xi - 1, 0,                    //
        0, 4 * eta - 1,                   //
        4 * (l - xi), -4 * xi,            //
        4 * eta, 4 * xi,                  //
        -4 * eta, 4 * (l - eta);
  } else {
    constexpr bool quadratic = E == ElementType::Q9;
    constexpr int n = quadratic ? 3 : 2;
    // one-dimensional Lagrange polynomials at -1, 1, (0)
    const auto line = [](double t) {
      std::array<std::array<double, n>, 2> f{};
      if constexpr (quadratic) {
        f[0] = {0.5 * t * (t - 1), 0.5 * t * (t + 1), (1 - t) * (1 + t)};
        f[1] = {t - 0.5, t + 0.5, -2 * t};
      } else {
        f[0] = {0.5 * (1 - t), 0.5 * (1 + t)};
        f[1] = {-0.5, 0.5};
      }
      return f;
    };
    // place of each node in the two one-dimensional sets
    constexpr std::array<int, 9> i = {0, 1, 1, 0, 2, 1, 2, 0, 2};
    constexpr std::array<int, 9> j = {0, 0, 1, 1, 0, 2, 1, 2, 2};
    const auto a = line(xi);
    const auto b = line(eta);
    for (int k = 0; k < nodes_per_element(E); ++k) {
      const auto p = static_cast<std::size_t>(i[static_cast<std::size_t>(k)]);
      const auto q = static_cast<std::size_t>(j[static_cast<std::size_t>(k)]);
      s.value[k] = a[0][p] * b[0][q];
      s.derivative(k, 0) = a[1][p] * b[0][q];
      s.derivative(k, 1) = a[0][p] * b[1][q];
    }
  }
  return s;
}

// Reference coordinates of an element's nodes.
template <ElementType E>
constexpr std::array<std::array<double, 2>, nodes_per_element(E)> node_coordinates() {
  if constexpr (E == ElementType::T3) {
    return {{{0, 0}, {1, 0}, {0, 1}}};
  } else if constexpr (E == ElementType::T6) {
    return {{{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}}};
  } else if constexpr (E == ElementType::Q4) {
    return {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  } else {
    return {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, -1}, {1, 0}, {0, 1}, {-1, 0}, {0, 0}}};
  }
}

// Calls `f.template operator()<E>()` for the element type known only at run time.
template <class F>
decltype(auto) dispatch(ElementType type, F&& f) {
  switch (type) {
  case ElementType::T3:
    return f.template operator()<ElementType::T3>();
  case ElementType::T6:
    return f.template operator()<ElementType::T6>();
  case ElementType::Q4:
    return f.template operator()<ElementType::Q4>();
  default:
    return f.template operator()<ElementType::Q9>();
  }
}

} // namespace pneuma::geometry
