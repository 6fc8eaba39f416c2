// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "solver/assembly/model.h"
#include "solver/linear/cholesky.h"

namespace pneuma::solver::assembly {

using base::MatX;

// Where a path stands.
struct Configuration {
  std::vector<Vec3> positions; // m
  VecX pressures;              // gauge pressure of each chamber, Pa
  double load_factor = 0;
};

// Equations of one foil: its own unknowns, one sparse matrix. Foils clamped along their edge share no unknown.
struct FoilEquations {
  Index block = 0;
  element::Membrane membrane;
  std::vector<Index> coordinate; // [unknown] -> 3 node + component
  linear::SymmetricPattern pattern;
  linear::Scatter scatter;
  std::vector<double> tangent; // values of the pattern, N/m: internal + pressure (symmetric part) + zones
  VecX residual;               // internal - external, free unknowns, N
  VecX pressure_gradient;      // d volume / d unknown = force of a unit pressure, m2
  // - d residual / d load factor at the positions and pressures that are unknown, N; where edges move it needs a
  // tangent
  VecX load_gradient;
  VecX internal, external;       // at every coordinate of the foil's nodes, [3 node + component], N (held ones too)
  double volume = 0;             // below the foil, m3
  double volume_rate = 0;        // by the load factor as the edges move, m3
  double energy = 0;             // J
  double stiffness = 0;          // norm of the last tangent's diagonal, N/m
  double pressure = 0;           // net pressure on the whole foil along its normal, Pa
  std::vector<double> laplacian; // values of the pattern: int grad N . grad N of the start shape, -
};

// Sums that tell how far from equilibrium a configuration is.
struct Balance {
  bool possible = true;   // false: an element failed, a chamber's volume or absolute pressure is not positive
  std::string reason;     // why not possible
  double residual = 0;    // |internal - external| of the free unknowns, N
  double force_scale = 0; // the largest of |external|, |internal| and a hundredth of the frame's forces, N; 0: none
  double rounding = 0;    // residual that a change of all positions in their last digit makes, N (needs a tangent)
  double gas = 0;         // largest relative error of a chamber's law
};

// Residual and tangent of a whole cushion, foil by foil side by side in threads.
class System {
public:
  // Throws InputError where foils share free unknowns (their edges must be held), or where what moves is not held or
  // belongs to a base.
  System(Model model, int threads);
  System(System&&) = default; // the foils look into the model
  System(const System&) = delete;

  const Model& model() const { return model_; }
  std::vector<FoilEquations>& foils() { return foils_; }
  const std::vector<FoilEquations>& foils() const { return foils_; }
  Index unknowns() const; // of all foils

  // Puts the coordinates that are held but move where the load factor has them.
  void place_edges(Configuration& configuration) const;

  // Sets the regulated pressures and the moved edges for the load factor and evaluates; with_tangent also fills
  // tangents.
  Balance evaluate(Configuration& configuration, bool with_tangent);

  // The chamber whose air a chamber has: itself, or the one that it is connected to.
  Index air_of(Index chamber) const;

  // Of the last evaluation:
  double chamber_volume(Index chamber) const;      // m3, dead volume included; of this chamber alone
  double chamber_volume_rate(Index chamber) const; // its change by the load factor as the edges move, m3
  // Of the air of a chamber and those connected to it; a connected one has none of its own (no unknown pressure).
  chamber::GasLine gas_line(Index chamber, const Configuration& configuration) const;
  // d volume of chamber / d unknowns of a foil, one column an air (all zero for a connected chamber), m2
  MatX volume_gradients(Index foil) const;
  // Force of the frame on the foils at each held coordinate, [3 node + component], N.
  VecX support_forces() const;

  // The whole load stiffness d(pressure force)/dx of one foil for a unit pressure, dense over its unknowns: for tests.
  MatX dense_load_stiffness(Index foil, const Configuration& configuration) const;

  int threads() const { return threads_; }

  // Material history. `evaluate` goes from the accepted one, in one step that takes this long, s.
  void set_time_step(double seconds) { time_step_ = seconds; }
  double time_step() const { return time_step_; }
  bool flows_with_time() const; // a foil, in a step of this time
  // What the last evaluation left becomes the accepted history; once, and only where it was possible and a step on from
  // the accepted one.
  void accept_history();
  // Evaluates the accepted configuration once more as the step that led to it, from the history before it: the same
  // tangent, where a new step of no length would see a foil that has stopped yielding.
  Balance evaluate_accepted(Configuration& configuration, bool with_tangent);
  // Accepted, of a foil, [element][point][component].
  std::span<const double> history(Index foil) const { return accepted_[static_cast<std::size_t>(foil)]; }
  // What a look ahead has to put back.
  struct Memory {
    std::vector<std::vector<double>> before, accepted; // per foil
    double time_step = 0, accepted_time_step = 0;      // s
  };
  Memory memory() const { return {before_, accepted_, time_step_, accepted_time_step_}; }
  void restore(Memory memory);
  // Plastic flow in the last evaluated step, the largest of all points, as equivalent plastic strain, -.
  struct Flow {
    double growth = 0;
    // From the change of its rate since the step before, of laws that flow with time: backward Euler's local error is
    // dt^2/2 times that of the rate (Hairer, Norsett, Wanner 1993, Solving ODEs I, sec. II.7).
    double error = 0;
  };
  Flow flow() const;

private:
  std::string why_failed(std::size_t foil, const Configuration& configuration) const;
  void evaluate_foil(FoilEquations& foil, const Configuration& configuration, bool with_tangent);
  double net_pressure(Index block, const Configuration& configuration) const;
  double net_pressure_rate(Index block) const; // by the load factor, at the pressures that are unknown, Pa

  Model model_;
  int threads_;
  double time_step_ = 0;
  double load_factor_ = 0;    // of the last evaluation
  Vec3 origin_;               // of volumes, near the cushion
  std::vector<Index> moving_; // held coordinates that move
  std::vector<FoilEquations> foils_;
  std::vector<Index> foil_of_block_; // -1: base
  std::vector<double> base_volume_;  // per block, of those without equations
  // histories per foil: before the step that was accepted last, behind it, and behind the last evaluation
  std::vector<std::vector<double>> before_, accepted_, new_;
  bool is_new_ = false;                                // new_ is not accepted yet
  double accepted_time_step_ = 0;                      // s
  std::vector<std::optional<element::Failed>> failed_; // per foil
};

} // namespace pneuma::solver::assembly
