// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>

#include "solver/linear/pattern.h"

namespace pneuma::solver::linear {

// Supernodal Cholesky factor (CHOLMOD) of matrices with one pattern: analysed once, factorised as often as needed. Each
// object has a workspace of its own, so that several work side by side in threads.
class Cholesky {
public:
  // Fill-reducing ordering: AMD for small systems, METIS above 60 000 unknowns (measured: technology, section 5).
  explicit Cholesky(const SymmetricPattern& pattern);
  ~Cholesky();
  Cholesky(Cholesky&&) noexcept;
  Cholesky& operator=(Cholesky&&) noexcept;

  // False if the matrix is not positive definite: information, not an error. Throws std::bad_alloc.
  bool factorize(const SymmetricPattern& pattern, std::span<const double> values);

  // Solves for all columns of b [size][k] with the last factor. Only after factorize returned true.
  MatX solve(const MatX& b);

  // Smallest over largest pivot of the last factor, relative: near 0 a count of negative pivots means nothing.
  double pivot_ratio() const;

private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

} // namespace pneuma::solver::linear
