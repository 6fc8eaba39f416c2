// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>

#include "solver/linear/pattern.h"

namespace pneuma::solver::linear {

// LDLt factor with Bunch-Kaufman pivots (MUMPS; Amestoy, Duff, L'Excellent, Koster 2001) of symmetric matrices that
// need not be positive definite: where Cholesky says no. Analysed once, factorised as often as needed. Objects may live
// in different threads; their work is done one after another.
class Ldlt {
public:
  explicit Ldlt(const SymmetricPattern& pattern);
  ~Ldlt();
  Ldlt(Ldlt&&) noexcept;
  Ldlt& operator=(Ldlt&&) noexcept;

  // False if the matrix is singular to rounding: pivots were met that are no more than noise; they were left out.
  // Throws std::bad_alloc.
  bool factorize(const SymmetricPattern& pattern, std::span<const double> values);

  // Solves for all columns of b [size][k] with the last factor.
  MatX solve(const MatX& b);

  // Of the last factor: negative eigenvalues (Sylvester's law of inertia), pivots that were left out as zero.
  int negative_pivots() const;
  int null_pivots() const;
  // Smallest over largest pivot of the last factor: near 0 a count of negative ones means nothing.
  double pivot_ratio() const;

private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

} // namespace pneuma::solver::linear
