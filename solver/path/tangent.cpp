// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/path/tangent.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>

#include "geometry/base/parallel.h"

namespace pneuma::solver::path {

namespace {

constexpr double shift_growth = 4;
constexpr int max_shift_tries = 40;
constexpr double no_stiffness = 1e-12; // smallest over largest pivot
constexpr double unsafe = 1e-10;       // pivot, relative: no sign to count
constexpr double whole_step = 0.9;     // of the line search
constexpr double short_step = 0.3;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

} // namespace

Stopwatch::Stopwatch(double& total) : total_(total), start_(now()) {}
Stopwatch::~Stopwatch() {
  total_ += now() - start_;
}

Change operator*(double factor, Change change) {
  for (VecX& u : change.u) u *= factor;
  change.p *= factor;
  change.load_factor *= factor;
  return change;
}

Change& operator+=(Change& to, const Change& change) {
  for (std::size_t i = 0; i < to.u.size(); ++i) to.u[i] += change.u[i];
  to.p += change.p;
  to.load_factor += change.load_factor;
  return to;
}

double dot_u(const Change& a, const Change& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.u.size(); ++i) sum += a.u[i].dot(b.u[i]);
  return sum;
}

double dot(const Change& a, const Change& b) {
  return dot_u(a, b) + a.p.dot(b.p) + a.load_factor * b.load_factor;
}

Change difference(const System& system, const Configuration& from, const Configuration& to) {
  Change change;
  for (const assembly::FoilEquations& foil : system.foils()) {
    VecX u(foil.pattern.size);
    for (std::size_t i = 0; i < foil.coordinate.size(); ++i) {
      const Index k = foil.coordinate[i];
      const auto node = static_cast<std::size_t>(k / 3);
      u[static_cast<Eigen::Index>(i)] = to.positions[node][k % 3] - from.positions[node][k % 3];
    }
    change.u.push_back(std::move(u));
  }
  change.p = to.pressures - from.pressures;
  change.load_factor = to.load_factor - from.load_factor;
  return change;
}

Configuration moved(const System& system, const Configuration& from, const Change& change) {
  Configuration to = from;
  for (std::size_t i = 0; i < change.u.size(); ++i) {
    const assembly::FoilEquations& foil = system.foils()[i];
    for (std::size_t u = 0; u < foil.coordinate.size(); ++u) {
      const Index k = foil.coordinate[u];
      to.positions[static_cast<std::size_t>(k / 3)][k % 3] += change.u[i][static_cast<Eigen::Index>(u)];
    }
  }
  to.pressures += change.p;
  to.load_factor += change.load_factor;
  system.place_edges(to);
  return to;
}

Tangent::Tangent(System& system, Work& work) : system_(system), work_(work) {
  const Stopwatch watch(work_.analysis);
  for (const assembly::FoilEquations& foil : system_.foils()) {
    factors_.push_back({linear::Cholesky(foil.pattern), {}, false, false, 0});
  }
  gradients_.resize(factors_.size());
  solved_.resize(factors_.size());
  const auto& chambers = system_.model().chambers;
  for (std::size_t c = 0; c < chambers.size(); ++c) {
    const bool regulated = std::holds_alternative<chamber::Regulated>(chambers[c].gas);
    if (!regulated && system_.air_of(static_cast<Index>(c)) == static_cast<Index>(c)) {
      laws_.push_back(static_cast<Index>(c));
    }
  }
}

double Tangent::artificial_tension() const {
  double largest = 0;
  for (const Factor& f : factors_) largest = std::max(largest, f.shift);
  return largest;
}

void Tangent::forget_artificial_tension() {
  for (Factor& f : factors_) f.shift = 0;
  taken_ = 1;
}

double Tangent::reference_tension(const Configuration& configuration) const {
  // A film that carries the load with a sag of the order of its span has a tension of load per area x span. What is not
  // in balance counts as a load: a slack foil between moved edges has no other.
  Vec3 low = configuration.positions.front();
  Vec3 high = low;
  for (const Vec3& x : configuration.positions) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  double tension = 0;
  for (const assembly::FoilEquations& foil : system_.foils()) {
    const double area =
        std::max(foil.pressure_gradient.norm() * std::sqrt(static_cast<double>(foil.pattern.size)), 1e-300);
    const double load =
        std::max(foil.external.norm(), foil.residual.norm()) * std::sqrt(static_cast<double>(foil.pattern.size)) / area;
    tension = std::max(tension, 0.1 * load * (high - low).norm());
  }
  if (tension > 0) return tension;
  // No force at all, yet a tangent to be made positive (a flat chamber is to get a volume): any small tension serves.
  for (const assembly::FoilEquations& foil : system_.foils()) {
    if (foil.pattern.size == 0) continue;
    tension = std::max(tension, 1e-6 * foil.stiffness / std::sqrt(static_cast<double>(foil.pattern.size)));
  }
  return tension;
}

void Tangent::factorize_indefinite(std::size_t foil, std::span<const double> values) {
  const linear::SymmetricPattern& pattern = system_.foils()[foil].pattern;
  Factor& factor = factors_[foil];
  if (!factor.ldlt) factor.ldlt.emplace(pattern);
  factor.indefinite = true;
  factor.singular = !factor.ldlt->factorize(pattern, values);
}

// Raises the artificial tension of a foil until its matrix is positive definite.
bool Tangent::add_tension(std::size_t foil, int& factorizations) {
  const assembly::FoilEquations& equations = system_.foils()[foil];
  Factor& factor = factors_[foil];
  factor.indefinite = factor.singular = false;
  std::vector<double> shifted;
  if (!(factor.shift > 0)) return false; // no load, no tension: nothing to scale with
  for (int tries = 0; tries < max_shift_tries; ++tries) {
    shifted = equations.tangent;
    for (std::size_t k = 0; k < shifted.size(); ++k) shifted[k] += factor.shift * equations.laplacian[k];
    ++factorizations;
    if (factor.cholesky.factorize(equations.pattern, shifted)) return true;
    factor.shift *= shift_growth;
  }
  return false;
}

bool Tangent::factorize(const Configuration& configuration, Repair repair) {
  const Stopwatch watch(work_.factorization);
  const double tension = reference_tension(configuration);
  std::vector<int> count(factors_.size(), 0);
  std::vector<char> done(factors_.size(), 1);
  const auto sum_up = [&] {
    for (int& c : count) work_.factorizations += std::exchange(c, 0);
  };
  whole_is_needed_ = false;

  base::parallel_chunks(system_.threads(), factors_.size(), [&](std::size_t i) {
    const assembly::FoilEquations& foil = system_.foils()[i];
    Factor& factor = factors_[i];
    factor.indefinite = factor.singular = false;
    // From one iteration to the next a foil needs less and less of it, as long as whole steps are good. Steps that had
    // to be cut are too long for the tangent: then as much or more.
    if (repair == Repair::indefinite || (taken_ >= whole_step && factor.shift < 1e-6 * tension)) {
      factor.shift = 0;
    } else if (taken_ >= whole_step) {
      factor.shift /= shift_growth;
    } else if (taken_ < short_step) {
      factor.shift = factor.shift > 0 ? factor.shift * shift_growth : 1e-3 * tension;
    }
    if (factor.shift > 0) {
      done[i] = add_tension(i, count[i]) ? 1 : 0;
      return;
    }
    ++count[i];
    if (factor.cholesky.factorize(foil.pattern, foil.tangent)) {
      // a flat foil's few strains from rounding are no stiffness: LDLt counts the null space
      if (repair == Repair::descent || factor.cholesky.pivot_ratio() > no_stiffness) return;
    }
    if (repair == Repair::indefinite || !laws_.empty()) {
      ++count[i];
      factorize_indefinite(i, foil.tangent);
    } else {
      factor.shift = 1e-3 * tension;
      done[i] = add_tension(i, count[i]) ? 1 : 0;
    }
  });
  sum_up();
  if (std::find(done.begin(), done.end(), 0) != done.end()) return false;

  for (std::size_t i = 0; i < factors_.size(); ++i) take_gradients(i);
  const auto solve_gradients = [&] {
    base::parallel_chunks(system_.threads(), factors_.size(),
                          [&](std::size_t i) { solved_[i] = solve(i, gradients_[i]); });
  };
  const bool any_indefinite =
      std::any_of(factors_.begin(), factors_.end(), [](const Factor& f) { return f.indefinite; });
  const bool any_singular = std::any_of(factors_.begin(), factors_.end(), [](const Factor& f) { return f.singular; });
  if (repair == Repair::descent && any_indefinite) {
    // the air may hold what the foil alone does not
    bool held = false;
    if (!any_singular) {
      solve_gradients();
      held = coupled_negative(configuration, nullptr) == 0;
    }
    if (!held) {
      base::parallel_chunks(system_.threads(), factors_.size(), [&](std::size_t i) {
        if (!factors_[i].indefinite) return;
        factors_[i].shift = 1e-3 * tension;
        done[i] = add_tension(i, count[i]) ? 1 : 0;
      });
      sum_up();
      if (std::find(done.begin(), done.end(), 0) != done.end()) return false;
    }
  } else if (any_singular) {
    int null = 0;
    for (const Factor& f : factors_) null += f.singular ? f.ldlt->null_pivots() : 0;
    whole_is_needed_ =
        null <= 1 + static_cast<int>(laws_.size()) && factorize_whole(configuration, drive(configuration));
    if (!whole_is_needed_) { // slack: a little tension against the null space, the rest as it is
      for (std::size_t i = 0; i < factors_.size(); ++i) {
        if (!factors_[i].singular) continue;
        factors_[i].shift = 1e-4 * tension;
        const assembly::FoilEquations& foil = system_.foils()[i];
        std::vector<double> shifted = foil.tangent;
        for (std::size_t k = 0; k < shifted.size(); ++k) shifted[k] += factors_[i].shift * foil.laplacian[k];
        ++work_.factorizations;
        factorize_indefinite(i, shifted);
        if (factors_[i].singular) return false;
      }
    }
  }
  if (!whole_is_needed_) solve_gradients();
  return true;
}

void Tangent::take_gradients(std::size_t foil) {
  const MatX all = system_.volume_gradients(static_cast<Index>(foil));
  gradients_[foil].resize(all.rows(), static_cast<Eigen::Index>(laws_.size()));
  for (std::size_t a = 0; a < laws_.size(); ++a) gradients_[foil].col(static_cast<Eigen::Index>(a)) = all.col(laws_[a]);
}

MatX Tangent::solve(std::size_t foil, const MatX& right) {
  Factor& factor = factors_[foil];
  return factor.indefinite ? factor.ldlt->solve(right) : factor.cholesky.solve(right);
}

Change Tangent::zero() const {
  Change z;
  for (const assembly::FoilEquations& foil : system_.foils()) z.u.emplace_back(VecX::Zero(foil.pattern.size));
  z.p = VecX::Zero(static_cast<Eigen::Index>(system_.model().chambers.size()));
  return z;
}

Change Tangent::residual(const Configuration& configuration) const {
  Change b = zero();
  for (std::size_t i = 0; i < b.u.size(); ++i) b.u[i] = -system_.foils()[i].residual;
  for (const Index c : laws_) b.p[c] = system_.gas_line(c, configuration).residual;
  return b;
}

Change Tangent::drive(const Configuration& configuration) const {
  Change f = zero();
  for (std::size_t i = 0; i < f.u.size(); ++i) f.u[i] = system_.foils()[i].load_gradient;
  for (const Index c : laws_) f.p[c] = system_.gas_line(c, configuration).drive;
  return f;
}

// A x of the matrix above, artificial tension included.
Change Tangent::times(const Configuration& configuration, const Change& x) const {
  Change y = zero();
  for (std::size_t i = 0; i < y.u.size(); ++i) {
    const assembly::FoilEquations& foil = system_.foils()[i];
    y.u[i] = linear::multiply(foil.pattern, foil.tangent, x.u[i]);
    if (factors_[i].shift > 0) {
      y.u[i] += factors_[i].shift * linear::multiply(foil.pattern, foil.laplacian, x.u[i]);
    }
    for (std::size_t a = 0; a < laws_.size(); ++a) {
      const auto q = gradients_[i].col(static_cast<Eigen::Index>(a));
      y.u[i] -= x.p[laws_[a]] * q;
      y.p[laws_[a]] -= q.dot(x.u[i]);
    }
  }
  for (const Index c : laws_) y.p[c] -= system_.gas_line(c, configuration).compliance * x.p[c];
  return y;
}

// A^-1 of several right sides: du = K^-1 (b_u + Q dp), (D + Q' K^-1 Q) dp = -b_p - Q' K^-1 b_u.
std::vector<Change> Tangent::eliminate(const Configuration& configuration, const std::vector<Change>& right) {
  const auto columns = static_cast<Eigen::Index>(right.size());
  const auto laws = static_cast<Eigen::Index>(laws_.size());
  std::vector<MatX> plain(factors_.size()); // K^-1 b_u
  base::parallel_chunks(system_.threads(), factors_.size(), [&](std::size_t i) {
    MatX b(system_.foils()[i].pattern.size, columns);
    for (Eigen::Index k = 0; k < columns; ++k) b.col(k) = right[static_cast<std::size_t>(k)].u[i];
    plain[i] = solve(i, b);
  });
  MatX small = MatX::Zero(laws, laws);
  MatX small_right = MatX::Zero(laws, columns);
  VecX scale(laws); // to a diagonal of one: chambers of any size stand side by side
  for (Eigen::Index a = 0; a < laws; ++a) {
    const Index c = laws_[static_cast<std::size_t>(a)];
    small(a, a) = system_.gas_line(c, configuration).compliance;
    for (Eigen::Index k = 0; k < columns; ++k) small_right(a, k) = -right[static_cast<std::size_t>(k)].p[c];
    for (std::size_t i = 0; i < factors_.size(); ++i) {
      small.row(a) += gradients_[i].col(a).transpose() * solved_[i];
      small_right.row(a) -= gradients_[i].col(a).transpose() * plain[i];
    }
    scale[a] = small(a, a) != 0 ? 1 / std::sqrt(std::abs(small(a, a))) : 0.0;
  }
  MatX dp = MatX::Zero(laws, columns);
  if (laws > 0) {
    const MatX scaled = scale.asDiagonal() * small * scale.asDiagonal();
    dp = scale.asDiagonal() * scaled.fullPivLu().solve(MatX(scale.asDiagonal() * small_right));
  }
  std::vector<Change> x;
  for (Eigen::Index k = 0; k < columns; ++k) {
    Change one = zero();
    for (Eigen::Index a = 0; a < laws; ++a) one.p[laws_[static_cast<std::size_t>(a)]] = dp(a, k);
    for (std::size_t i = 0; i < factors_.size(); ++i) one.u[i] = plain[i].col(k) + solved_[i] * dp.col(k);
    x.push_back(std::move(one));
  }
  return x;
}

// [A, -f; -f', 0] as one matrix.
bool Tangent::factorize_whole(const Configuration& configuration, const Change& f) {
  const auto laws = static_cast<Index>(laws_.size());
  if (whole_pattern_.size == 0) {
    linear::SymmetricPattern& p = whole_pattern_;
    p.column_start.push_back(0);
    for (const assembly::FoilEquations& foil : system_.foils()) {
      for (Index column = 0; column < foil.pattern.size; ++column) {
        const auto j = static_cast<std::size_t>(column);
        for (Index k = foil.pattern.column_start[j]; k < foil.pattern.column_start[j + 1]; ++k) {
          p.row.push_back(p.size + foil.pattern.row[static_cast<std::size_t>(k)]);
        }
        p.column_start.push_back(static_cast<Index>(p.row.size()));
      }
      p.size += foil.pattern.size;
    }
    for (Index border = 0; border <= laws; ++border) {
      for (Index row = 0; row <= p.size; ++row) p.row.push_back(row);
      p.column_start.push_back(static_cast<Index>(p.row.size()));
      ++p.size;
    }
    whole_.emplace(p);
  }
  std::vector<double> values;
  values.reserve(whole_pattern_.row.size());
  for (std::size_t i = 0; i < factors_.size(); ++i) {
    const assembly::FoilEquations& foil = system_.foils()[i];
    for (std::size_t k = 0; k < foil.tangent.size(); ++k) {
      values.push_back(foil.tangent[k] + factors_[i].shift * foil.laplacian[k]);
    }
  }
  // borders in units that make them as large as the stiffness
  double stiffness = 0;
  for (const assembly::FoilEquations& foil : system_.foils()) {
    stiffness = std::max(stiffness, foil.stiffness / std::sqrt(std::max(1.0, static_cast<double>(foil.pattern.size))));
  }
  border_scale_ = VecX::Ones(laws + 1);
  for (Index a = 0; a <= laws; ++a) {
    double largest = 0;
    for (std::size_t i = 0; i < factors_.size(); ++i) {
      if (f.u[i].size() == 0) continue;
      largest = std::max(largest, a < laws ? gradients_[i].col(a).cwiseAbs().maxCoeff() : f.u[i].cwiseAbs().maxCoeff());
    }
    if (largest > 0 && stiffness > 0) border_scale_[a] = stiffness / largest;
  }
  for (Index a = 0; a < laws; ++a) {
    for (const MatX& q : gradients_) {
      for (const double value : q.col(a)) values.push_back(-border_scale_[a] * value);
    }
    values.insert(values.end(), static_cast<std::size_t>(a), 0.0);
    const double compliance = system_.gas_line(laws_[static_cast<std::size_t>(a)], configuration).compliance;
    values.push_back(-border_scale_[a] * border_scale_[a] * compliance);
  }
  for (const VecX& u : f.u) {
    for (const double value : u) values.push_back(-border_scale_[laws] * value);
  }
  for (Index a = 0; a < laws; ++a) {
    values.push_back(-border_scale_[a] * border_scale_[laws] * f.p[laws_[static_cast<std::size_t>(a)]]);
  }
  values.push_back(0.0);
  ++work_.factorizations;
  return whole_->factorize(whole_pattern_, values) && whole_->pivot_ratio() > no_stiffness;
}

// Right sides with the load factor's line in `load_factor`.
std::vector<Change> Tangent::solve_whole(const std::vector<Change>& right) {
  MatX b = MatX::Zero(whole_pattern_.size, static_cast<Eigen::Index>(right.size()));
  for (std::size_t k = 0; k < right.size(); ++k) {
    Eigen::Index at = 0;
    const auto column = static_cast<Eigen::Index>(k);
    for (const VecX& u : right[k].u) {
      b.col(column).segment(at, u.size()) = u;
      at += u.size();
    }
    for (const Index c : laws_) b(at++, column) = right[k].p[c];
    b(at, column) = right[k].load_factor;
    b.col(column).tail(border_scale_.size()).array() *= border_scale_.array();
  }
  MatX x = whole_->solve(b);
  for (Eigen::Index k = 0; k < x.cols(); ++k) x.col(k).tail(border_scale_.size()).array() *= border_scale_.array();
  std::vector<Change> all;
  for (Eigen::Index k = 0; k < x.cols(); ++k) {
    Change one = zero();
    Eigen::Index at = 0;
    for (VecX& u : one.u) {
      u = x.col(k).segment(at, u.size());
      at += u.size();
    }
    for (const Index c : laws_) one.p[c] = x(at++, k);
    one.load_factor = x(at, k);
    all.push_back(std::move(one));
  }
  return all;
}

Change Tangent::step(const Configuration& configuration) {
  const Stopwatch watch(work_.solve);
  return eliminate(configuration, {residual(configuration)}).front();
}

// The solution that meets the row, among at + alpha way.
std::optional<Change> Tangent::combine(const Change& at, const Change& way, const Row& row) const {
  const double slope = dot(row.form, way);
  const double alpha = (-row.residual - dot(row.form, at)) / slope;
  if (!std::isfinite(alpha)) return std::nullopt;
  Change change = alpha * way;
  change += at;
  return change;
}

std::optional<Change> Tangent::step(const Configuration& configuration, const Row& row) {
  const Stopwatch watch(work_.solve);
  const Change b = residual(configuration);
  const Change f = drive(configuration);
  if (!whole_is_needed_) {
    std::vector<Change> x = eliminate(configuration, {b, f});
    x[1].load_factor = 1;
    std::optional<Change> change = combine(x[0], x[1], row);
    constexpr double accurate = 1e-9; // of the forces: three digits a step are Newton's least
    for (int refinement = 0; change && refinement < 3; ++refinement) {
      Change left = -1.0 * times(configuration, *change);
      left += change->load_factor * f;
      left.load_factor = 0;
      left += b;
      double largest = 0; // force
      for (std::size_t i = 0; i < b.u.size(); ++i) {
        largest = std::max({largest, b.u[i].norm(), std::abs(change->load_factor) * f.u[i].norm()});
      }
      double gas = 0; // volume
      for (const Index c : laws_) {
        gas = std::max(
            {gas, std::abs(left.p[c]) - accurate * std::abs(b.p[c]) - 1e-12 * std::abs(system_.chamber_volume(c))});
      }
      if (std::sqrt(dot_u(left, left)) <= accurate * largest && gas <= 0) return change;
      const std::vector<Change> more = eliminate(configuration, {left});
      const std::optional<Change> correction =
          combine(more[0], x[1], {row.form, row.residual + dot(row.form, *change)});
      if (!correction) break;
      *change += *correction;
    }
    if (!factorize_whole(configuration, f)) return std::nullopt;
  }
  Change unit = zero();
  unit.load_factor = 1;
  const std::vector<Change> x = solve_whole({b, unit});
  return combine(x[0], x[1], row);
}

std::optional<Change> Tangent::along(const Configuration& configuration) {
  const Stopwatch watch(work_.solve);
  Change way;
  if (whole_is_needed_) {
    Change unit = zero();
    unit.load_factor = 1;
    way = solve_whole({unit}).front();
  } else {
    way = eliminate(configuration, {drive(configuration)}).front();
    way.load_factor = 1;
  }
  const double length = std::sqrt(dot_u(way, way));
  if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
  return (1 / length) * way;
}

// neg(K) + neg(-D - Q' K^-1 Q) - m with the borders of the air and of what is held; the foils' factors and `solved_`
// are those of the tangent without tension. None where an eigenvalue is no more than rounding of what cancels in it.
std::optional<int> Tangent::coupled_negative(const Configuration& configuration, const Row* held) {
  const auto laws = static_cast<Eigen::Index>(laws_.size());
  const Eigen::Index size = laws + (held != nullptr ? 1 : 0);
  MatX small = MatX::Zero(size, size);
  VecX magnitude = VecX::Zero(size); // of what adds up to its diagonal
  int negative = 0;
  for (std::size_t i = 0; i < factors_.size(); ++i) {
    if (factors_[i].indefinite) negative += factors_[i].ldlt->negative_pivots();
    MatX q(system_.foils()[i].pattern.size, size), solution(q.rows(), size);
    q.leftCols(laws) = gradients_[i];
    solution.leftCols(laws) = solved_[i];
    if (held != nullptr) {
      q.col(laws) = held->form.u[i];
      solution.col(laws) = solve(i, held->form.u[i]);
    }
    const MatX part = q.transpose() * solution;
    small -= part;
    magnitude += part.diagonal().cwiseAbs();
  }
  for (Eigen::Index a = 0; a < laws; ++a) {
    const double compliance = system_.gas_line(laws_[static_cast<std::size_t>(a)], configuration).compliance;
    small(a, a) -= compliance;
    magnitude[a] += compliance;
  }
  if (size == 0) return negative;
  VecX scale(size); // congruent: keeps the signs
  for (Eigen::Index a = 0; a < size; ++a) scale[a] = magnitude[a] > 0 ? 1 / std::sqrt(magnitude[a]) : 1.0;
  small = (scale.asDiagonal() * (0.5 * (small + small.transpose())) * scale.asDiagonal()).eval();
  const VecX eigenvalues = Eigen::SelfAdjointEigenSolver<MatX>(small, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(eigenvalues.cwiseAbs().minCoeff() > unsafe)) return std::nullopt;
  return negative + static_cast<int>((eigenvalues.array() < 0).count()) - static_cast<int>(size);
}

Stability Tangent::stability(const Configuration& configuration, const Row* held) {
  return factorize(configuration, Repair::indefinite) ? count(configuration, held) : Stability{};
}

Stability Tangent::count(const Configuration& configuration, const Row* held) {
  for (Factor& factor : factors_) {
    if (factor.shift > 0 || factor.singular) return {};
    if ((factor.indefinite ? factor.ldlt->pivot_ratio() : factor.cholesky.pivot_ratio()) < unsafe) return {};
  }
  Stability result;
  result.load_held = coupled_negative(configuration, nullptr);
  result.control_held = held != nullptr ? coupled_negative(configuration, held) : result.load_held;
  return result;
}

} // namespace pneuma::solver::path
