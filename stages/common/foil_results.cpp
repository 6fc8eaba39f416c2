// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/common/foil_results.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "geometry/surface.h"
#include "solver/recovery/patch_recovery.h"

namespace pneuma::stages::common {

namespace {

using solver::material::Surface;

struct Pair {
  double larger, smaller;
};

// eigenvalues of the symmetric (a, b; off c)
Pair eigenvalues(double a, double b, double c) {
  const double mean = 0.5 * (a + b);
  const double radius = std::hypot(0.5 * (a - b), c);
  return {mean + radius, mean - radius};
}

double von_mises_of(const Pair& s) {
  return std::sqrt(s.larger * s.larger - s.larger * s.smaller + s.smaller * s.smaller);
}

// stretch - 1 from the components of C
Pair strains_of(double c11, double c22, double c12) {
  const Pair square = eigenvalues(c11, c22, c12);
  return {std::sqrt(square.larger) - 1, std::sqrt(std::max(square.smaller, 0.0)) - 1};
}

void widen(Extreme& extreme, double value, const Vec3& at, bool first) {
  if (first || value > extreme.max) {
    extreme.max = value;
    extreme.at = at;
  }
  if (first || value < extreme.min) extreme.min = value;
}

// The elements of one strip as a block of their own, and the numbers of their elements.
struct Piece {
  geometry::Block block;
  std::vector<std::size_t> elements;
};

std::vector<Piece> pieces_of(const geometry::Mesh& mesh, const geometry::Block& block,
                             std::span<const Index> strip_of_element) {
  std::vector<Piece> pieces;
  for (std::size_t e = 0; e < strip_of_element.size(); ++e) {
    const auto strip = static_cast<std::size_t>(strip_of_element[e]);
    if (strip >= pieces.size()) pieces.resize(strip + 1);
    pieces[strip].elements.push_back(e);
    const std::span<const Index> nodes = mesh.element_nodes(block, static_cast<Index>(e));
    pieces[strip].block.connectivity.insert(pieces[strip].block.connectivity.end(), nodes.begin(), nodes.end());
  }
  return pieces;
}

// The elements that carry something at one stress point at least: only their places are determined.
geometry::Block not_slack(const geometry::Mesh& mesh, const geometry::Block& block, std::span<const double> surface) {
  geometry::Block carrying{block.name, block.kind, {}};
  const auto elements = static_cast<std::size_t>(mesh.element_count(block));
  const std::size_t points = surface.size() / elements;
  for (std::size_t e = 0; e < elements; ++e) {
    const std::span<const double> states = surface.subspan(e * points, points);
    if (std::all_of(states.begin(), states.end(), [](double state) { return state == 2; })) continue;
    const std::span<const Index> nodes = mesh.element_nodes(block, static_cast<Index>(e));
    carrying.connectivity.insert(carrying.connectivity.end(), nodes.begin(), nodes.end());
  }
  return carrying;
}

// What is recovered at the nodes: Cauchy stress 3, C 3, equivalent plastic strain.
constexpr std::size_t recovered = 7;

// Nodal fields and extremes from `values` [element][point][recovered].
void recover(const geometry::Mesh& mesh, const geometry::Block& block, geometry::StressRule rule,
             std::span<const Index> strip_of_element, std::span<const Vec3> now, const std::vector<double>& values,
             FoilResults& r) {
  const std::size_t nodes = mesh.nodes.size();
  for (std::vector<double>* field : {&r.nodal_von_mises, &r.nodal_stress1, &r.nodal_stress2, &r.nodal_strain1,
                                     &r.nodal_strain2, &r.nodal_plastic_strain}) {
    field->assign(nodes, 0.0);
  }
  bool first = true;
  std::vector<char> seen(nodes, 0); // by an earlier strip
  const auto take = [&](const geometry::Block& piece, std::span<const double> at_points) {
    const std::vector<double> nodal =
        solver::recovery::recover_at_nodes(mesh, piece, rule, now, at_points, static_cast<Index>(recovered));
    std::vector<Index> own = piece.connectivity;
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    for (const Index node : own) {
      const auto k = static_cast<std::size_t>(node);
      const double* t = nodal.data() + recovered * k;
      Pair stress = eigenvalues(t[0], t[1], t[2]);
      if (r.tension_field) { // the fit overshoots where tension ends
        stress = {std::max(stress.larger, 0.0), std::max(stress.smaller, 0.0)};
      }
      const Pair strain = strains_of(t[3], t[4], t[5]);
      const auto set = [&](Extreme& extreme, std::vector<double>& field, double value) {
        widen(extreme, value, now[k], first);
        field[k] = seen[k] != 0 ? std::max(field[k], value) : value;
      };
      set(r.von_mises, r.nodal_von_mises, von_mises_of(stress));
      set(r.stress1, r.nodal_stress1, stress.larger);
      set(r.stress2, r.nodal_stress2, stress.smaller);
      set(r.strain1, r.nodal_strain1, strain.larger);
      set(r.strain2, r.nodal_strain2, strain.smaller);
      if (r.plastic) set(r.plastic_strain, r.nodal_plastic_strain, std::max(t[6], 0.0)); // the fit overshoots
      seen[k] = 1;
      first = false;
    }
  };
  if (strip_of_element.empty()) return take(block, values);
  const std::size_t per_element = values.size() / strip_of_element.size();
  for (const Piece& piece : pieces_of(mesh, block, strip_of_element)) {
    std::vector<double> of_piece;
    of_piece.reserve(piece.elements.size() * per_element);
    for (const std::size_t e : piece.elements) {
      const auto begin = values.begin() + static_cast<std::ptrdiff_t>(e * per_element);
      of_piece.insert(of_piece.end(), begin, begin + static_cast<std::ptrdiff_t>(per_element));
    }
    take(piece.block, of_piece);
  }
}

// Mean over each element's stress points; NaN on the other foils.
pipeline::state::Field surface_state(const geometry::Mesh& mesh, const FoilResults& r) {
  pipeline::state::Field field{"surface_state." + r.name, "1", pipeline::state::Location::cell, 1, -1, {}};
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const auto elements = static_cast<std::size_t>(mesh.element_count(mesh.blocks[b]));
    const bool own = static_cast<Index>(b) == r.block;
    const std::size_t points = own ? r.surface.size() / elements : 0;
    for (std::size_t e = 0; e < elements; ++e) {
      const auto begin = r.surface.begin() + static_cast<std::ptrdiff_t>(e * points);
      field.values.push_back(own ? std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(points), 0.0) /
                                       static_cast<double>(points)
                                 : std::nan(""));
    }
  }
  return field;
}

} // namespace

FoilResults foil_results(const geometry::Mesh& mesh, Index block, const solver::element::Membrane& membrane,
                         std::span<const Index> strip_of_element, std::span<const Vec3> start,
                         std::span<const Vec3> now, std::span<const double> history) {
  const geometry::Block& b = mesh.blocks[static_cast<std::size_t>(block)];
  FoilResults r;
  r.name = b.name;
  r.block = block;
  r.area = geometry::surface_area(mesh, b, now);
  r.tension_field = solver::material::has_tension_field(membrane.law);

  const std::vector<solver::element::PointState> points = solver::element::point_states(membrane, now, history);
  const std::span<const std::string_view> names = solver::material::history_names(membrane.law);
  r.plastic = std::ranges::find(names, solver::material::equivalent_plastic_strain) != names.end();
  std::vector<double> values;
  values.reserve(points.size() * recovered);
  r.thickness_min = membrane.thickness;
  double total = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const solver::element::PointState& p = points[i];
    const Vec3 c(1 + 2 * p.strain[0], 1 + 2 * p.strain[1], p.strain[2]);
    const double shear = 0.5 * (p.cauchy(0, 1) + p.cauchy(1, 0));
    values.insert(values.end(), {p.cauchy(0, 0), p.cauchy(1, 1), shear, c[0], c[1], c[2], p.plastic_strain});
    r.cauchy.insert(r.cauchy.end(), {p.cauchy(0, 0), p.cauchy(1, 1), shear});
    r.thickness.push_back(membrane.thickness * p.thickness_ratio);
    r.thickness_min = std::min(r.thickness_min, r.thickness.back());
    r.surface.push_back(static_cast<double>(p.surface));
    const Pair stress = eigenvalues(p.cauchy(0, 0), p.cauchy(1, 1), shear);
    const Pair strain = strains_of(c[0], c[1], c[2]);
    const bool first = i == 0;
    const auto gauss = [first](Extreme& e, double value) {
      e.max_gauss = first ? value : std::max(e.max_gauss, value);
    };
    gauss(r.von_mises, von_mises_of(stress));
    gauss(r.stress1, stress.larger);
    gauss(r.stress2, stress.smaller);
    gauss(r.strain1, strain.larger);
    gauss(r.strain2, strain.smaller);
    gauss(r.plastic_strain, p.plastic_strain);
    const double area = membrane.reference.area[i];
    r.stored += membrane.thickness * area * p.stored;
    r.dissipated += membrane.thickness * area * p.dissipated;
    total += area;
    if (p.surface == Surface::wrinkled) r.wrinkled_area += area;
    if (p.surface == Surface::slack) r.slack_area += area;
    if (solver::material::outside_data(membrane.law, p.strain, nullptr))
      r.outside_area += area;      // tables have no history
    constexpr double rounding = 1; // Pa
    if (stress.smaller < -rounding) {
      r.compressed_area += area;
      r.compression = std::max(r.compression, -stress.smaller);
    }
  }
  for (double* part : {&r.compressed_area, &r.wrinkled_area, &r.slack_area, &r.outside_area}) *part /= total;

  recover(mesh, b, membrane.reference.rule, strip_of_element, now, values, r);
  const geometry::Block carrying = not_slack(mesh, b, r.surface);
  if (carrying.connectivity.empty()) {
    r.sag = r.max_deflection = std::nan("");
    return r;
  }
  r.sag = geometry::deepest_point(mesh, carrying, now, geometry::edge_plane(mesh, now)).distance;
  for (const Index node : carrying.connectivity) {
    const auto k = static_cast<std::size_t>(node);
    r.max_deflection = std::max(r.max_deflection, (now[k] - start[k]).norm());
  }
  return r;
}

void summarize_mesh(const State& state, Summary& summary) {
  Index elements = 0;
  std::vector<char> of_foil(state.mesh.nodes.size(), 0);
  for (const geometry::Block& block : state.mesh.blocks) {
    if (block.kind == geometry::BlockKind::base) continue;
    elements += state.mesh.element_count(block);
    for (const Index node : block.connectivity) of_foil[static_cast<std::size_t>(node)] = 1;
  }
  int unknowns = 0;
  for (std::size_t k = 0; k < state.fixed.size(); ++k) unknowns += of_foil[k / 3] != 0 && state.fixed[k] == 0 ? 1 : 0;
  summary.set("mesh.nodes", static_cast<int>(state.mesh.nodes.size()));
  summary.set("mesh.elements", elements);
  summary.set("mesh.dofs", unknowns);
  summary.set("mesh.element", geometry::name_of(state.mesh.element));
}

void summarize(const FoilResults& r, Summary& summary) {
  const std::string foil = "foils." + r.name + ".";
  summary.set(foil + "area", r.area);
  summary.set(foil + "sag", r.sag);
  summary.set(foil + "max_deflection", r.max_deflection);
  summary.set(foil + "thickness_min", r.thickness_min);
  if (r.tension_field) {
    summary.set(foil + "wrinkled_area_fraction", r.wrinkled_area);
    summary.set(foil + "slack_area_fraction", r.slack_area);
  }
  if (r.outside_area > 0) summary.set(foil + "outside_data_area_fraction", r.outside_area);
  summary.set(foil + "energy.stored", r.stored);
  if (r.plastic) summary.set(foil + "energy.dissipated", r.dissipated);
  std::vector<std::pair<const char*, const Extreme*>> all = {{"von_mises", &r.von_mises},
                                                             {"principal_stress_1", &r.stress1},
                                                             {"principal_stress_2", &r.stress2},
                                                             {"principal_strain_1", &r.strain1},
                                                             {"principal_strain_2", &r.strain2}};
  if (r.plastic) all.emplace_back("plastic_strain", &r.plastic_strain);
  for (const auto& [name, extreme] : all) {
    const std::string key = foil + name + ".";
    summary.set(key + "max", extreme->max);
    summary.set(key + "min", extreme->min);
    summary.set(key + "max_gauss", extreme->max_gauss);
    summary.set_place(key + "at", extreme->at);
  }
}

void add_fields(const std::vector<FoilResults>& results, std::span<const Vec3> start, State& state) {
  using pipeline::state::Field;
  using pipeline::state::Location;
  const std::vector<Vec3>& now = state.mesh.nodes;
  Field displacement{"displacement", "m", Location::point, 3, -1, {}};
  for (std::size_t i = 0; i < now.size(); ++i) {
    const Vec3 u = now[i] - start[i];
    displacement.values.insert(displacement.values.end(), {u.x(), u.y(), u.z()});
  }
  state.fields.push_back(std::move(displacement));

  // The rim belongs to all foils, and each has its own stress there: one field a foil, NaN where it has no node.
  using Values = std::vector<double> FoilResults::*;
  const std::tuple<const char*, const char*, Values> nodal[] = {
      {"von_mises", "Pa", &FoilResults::nodal_von_mises},
      {"principal_stress_1", "Pa", &FoilResults::nodal_stress1},
      {"principal_stress_2", "Pa", &FoilResults::nodal_stress2},
      {"principal_strain_1", "1", &FoilResults::nodal_strain1},
      {"principal_strain_2", "1", &FoilResults::nodal_strain2},
      {"plastic_strain", "1", &FoilResults::nodal_plastic_strain}};
  for (const auto& [name, unit, values] : nodal) {
    for (const FoilResults& r : results) {
      if (values == &FoilResults::nodal_plastic_strain && !r.plastic) continue;
      Field field{std::string(name) + "." + r.name,
                  unit,
                  Location::point,
                  1,
                  -1,
                  std::vector<double>(now.size(), std::nan(""))};
      for (const Index node : state.mesh.blocks[static_cast<std::size_t>(r.block)].connectivity) {
        field.values[static_cast<std::size_t>(node)] = (r.*values)[static_cast<std::size_t>(node)];
      }
      state.fields.push_back(std::move(field));
    }
  }
  // all foils in one: the mean over each element's stress points
  Field mean{"element_von_mises", "Pa", Location::cell, 1, -1, {}};
  for (std::size_t b = 0; b < state.mesh.blocks.size(); ++b) {
    const auto elements = static_cast<std::size_t>(state.mesh.element_count(state.mesh.blocks[b]));
    const auto of_block = std::find_if(results.begin(), results.end(),
                                       [b](const FoilResults& r) { return r.block == static_cast<Index>(b); });
    for (std::size_t e = 0; e < elements; ++e) {
      if (of_block == results.end()) {
        mean.values.push_back(std::nan(""));
        continue;
      }
      const std::size_t points = of_block->thickness.size() / elements;
      double sum = 0;
      for (std::size_t k = e * points; k < (e + 1) * points; ++k) {
        const double* c = of_block->cauchy.data() + 3 * k;
        sum += von_mises_of(eigenvalues(c[0], c[1], c[2]));
      }
      mean.values.push_back(sum / static_cast<double>(points));
    }
  }
  state.fields.push_back(std::move(mean));
  for (const FoilResults& r : results) {
    if (r.tension_field) state.fields.push_back(surface_state(state.mesh, r));
  }
  for (const FoilResults& r : results) {
    state.fields.push_back({"cauchy_stress." + r.name, "Pa", Location::gauss, 3, r.block, r.cauchy});
    state.fields.push_back({"thickness." + r.name, "m", Location::gauss, 1, r.block, r.thickness});
  }
}

} // namespace pneuma::stages::common
