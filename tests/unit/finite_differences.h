// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace pneuma::tests {

// Derivative of a vector function at x by central differences of fourth order, step `h`: error O(h^4) + rounding / h.
template <class F>
Eigen::MatrixXd finite_difference_jacobian(const F& f, const Eigen::VectorXd& x, double h) {
  const Eigen::VectorXd f0 = f(x);
  Eigen::MatrixXd jacobian(f0.size(), x.size());
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const auto at = [&](double step) {
      Eigen::VectorXd moved = x;
      moved[j] += step;
      return Eigen::VectorXd(f(moved));
    };
    jacobian.col(j) = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
  }
  return jacobian;
}

// Largest difference of two matrices, relative to the largest entry of the second.
inline double relative_difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

} // namespace pneuma::tests
