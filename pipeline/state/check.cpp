// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/state/check.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <set>
#include <span>
#include <tuple>

#include <fmt/format.h>

namespace pneuma::pipeline::state {

namespace {

using geometry::Block;
using geometry::BlockKind;

std::string fault_in_numbers(const std::vector<Index>& nodes, std::size_t node_count, const std::string& whose) {
  const auto outside = [&](Index n) { return n < 0 || static_cast<std::size_t>(n) >= node_count; };
  const auto found = std::find_if(nodes.begin(), nodes.end(), outside);
  if (found == nodes.end()) return {};
  return fmt::format("{} names node {}, but there are {} nodes", whose, *found, node_count);
}

// The first value that is none, with its number; empty: all are finite.
std::string fault_in_values(std::span<const double> values, const std::string& whose) {
  const auto found = std::find_if(values.begin(), values.end(), [](double value) { return !std::isfinite(value); });
  if (found == values.end()) return {};
  return fmt::format("{}: value {} is {}", whose, found - values.begin(), *found);
}

// A single value that must be finite and at least `least`, or (`above`) more.
struct Bounded {
  const char* what;
  double value;
  double least = -std::numeric_limits<double>::infinity();
  bool above = false;
};

std::string fault_in_bounds(std::initializer_list<Bounded> all, const std::string& whose) {
  for (const auto& [what, value, least, above] : all) {
    if (std::isfinite(value) && (above ? value > least : value >= least)) continue;
    return fmt::format("{}: {} is {}", whose, what, value);
  }
  return {};
}

std::string fault_in_mesh(const State& state) {
  const geometry::Mesh& mesh = state.mesh;
  if (mesh.nodes.size() > static_cast<std::size_t>(std::numeric_limits<Index>::max())) return "too many nodes";
  if (state.stress_rule == geometry::StressRule::reduced && mesh.element != geometry::ElementType::Q9) {
    return fmt::format("a reduced stress rule exists for Q9, not for {}", geometry::name_of(mesh.element));
  }
  const auto nodes_each = static_cast<std::size_t>(geometry::nodes_per_element(mesh.element));
  for (const Block& block : mesh.blocks) {
    if (block.connectivity.size() % nodes_each != 0) {
      return fmt::format("block {}: {} node numbers are no whole number of {} elements", block.name,
                         block.connectivity.size(), geometry::name_of(mesh.element));
    }
    std::string fault = fault_in_numbers(block.connectivity, mesh.nodes.size(), "block " + block.name);
    if (!fault.empty()) return fault;
  }
  for (const geometry::Edge& edge : mesh.edges) {
    std::string fault = fault_in_numbers(edge.nodes, mesh.nodes.size(), "edge " + edge.name);
    if (!fault.empty()) return fault;
  }
  const double* first = mesh.nodes.empty() ? nullptr : mesh.nodes.front().data();
  for (std::string fault : {fault_in_values({first, 3 * mesh.nodes.size()}, "the positions of the nodes"),
                            fault_in_values({state.origin.data(), 3}, "the origin")}) {
    if (!fault.empty()) return fault;
  }
  if (state.fixed.size() != 3 * mesh.nodes.size()) {
    return fmt::format("{} marks of held coordinates for {} nodes", state.fixed.size(), mesh.nodes.size());
  }
  if (std::any_of(state.fixed.begin(), state.fixed.end(), [](std::uint8_t mark) { return mark > 1; })) {
    return "a mark of a held coordinate is neither 0 nor 1";
  }
  return {};
}

std::string fault_in_strips(const State& state, const Block& block, const Foil& foil) {
  const auto strips = static_cast<Index>(foil.strips.size());
  const auto unknown = [&](Index strip) { return strip < 0 || strip >= strips; };
  if (block.kind == BlockKind::base && (strips > 0 || !foil.strip_of_element.empty() || !foil.seams.empty())) {
    return fmt::format("the base {} has strips", block.name);
  }
  if (std::set(foil.strips.begin(), foil.strips.end()).size() != foil.strips.size()) {
    return fmt::format("foil {}: two strips have the same name", block.name);
  }
  const std::size_t elements = strips > 0 ? static_cast<std::size_t>(state.mesh.element_count(block)) : 0;
  if (foil.strip_of_element.size() != elements) {
    return fmt::format("foil {}: strip_of_element has {} values instead of {}", block.name,
                       foil.strip_of_element.size(), elements);
  }
  const auto found = std::find_if(foil.strip_of_element.begin(), foil.strip_of_element.end(), unknown);
  if (found != foil.strip_of_element.end()) {
    return fmt::format("foil {}: an element is in strip {}, but there are {}", block.name, *found, strips);
  }
  for (const Seam& seam : foil.seams) {
    const std::string whose = fmt::format("seam {} of foil {}", seam.name, block.name);
    for (const Index side : {seam.left, seam.right}) {
      if (unknown(side)) return fmt::format("{} names strip {}, but there are {}", whose, side, strips);
    }
    if (seam.left == seam.right) return fmt::format("{} joins strip {} with itself", whose, seam.left);
    if (seam.nodes.size() < 2) return fmt::format("{} has {} nodes; a line has 2 at least", whose, seam.nodes.size());
    std::string fault = fault_in_numbers(seam.nodes, state.mesh.nodes.size(), whose);
    if (!fault.empty()) return fault;
  }
  return {};
}

std::string fault_in_foil_values(const Foil& foil, const std::string& whose) {
  for (std::string fault :
       {fault_in_bounds({{"thickness", foil.thickness, 0, true}, {"warp angle", foil.warp_angle}}, whose),
        fault_in_values(foil.reference, whose + ": reference"),
        fault_in_values(foil.predeformation, whose + ": predeformation"),
        fault_in_values(foil.prestress, whose + ": prestress"), fault_in_values(foil.history, whose + ": history")}) {
    if (!fault.empty()) return fault;
  }
  for (std::size_t i = 0; i + 2 < foil.prestress.size(); i += 3) { // its smaller principal value
    const double mean = (foil.prestress[i] + foil.prestress[i + 1]) / 2;
    const double radius = std::hypot((foil.prestress[i] - foil.prestress[i + 1]) / 2, foil.prestress[i + 2]);
    if (mean - radius < 0) return fmt::format("{}: the prestress of Gauss point {} is a compression", whose, i / 3);
  }
  return {};
}

// A seam joins its two strips: each of its nodes belongs to an element of both.
std::string fault_in_seams(const State& state, const Block& block, const Foil& foil) {
  if (foil.seams.empty()) return {};
  const auto each = static_cast<std::size_t>(geometry::nodes_per_element(state.mesh.element));
  std::set<std::pair<Index, Index>> strip_and_node;
  for (std::size_t i = 0; i < block.connectivity.size(); ++i) {
    strip_and_node.emplace(foil.strip_of_element[i / each], block.connectivity[i]);
  }
  for (const Seam& seam : foil.seams) {
    for (const Index side : {seam.left, seam.right}) {
      for (const Index node : seam.nodes) {
        if (strip_and_node.contains({side, node})) continue;
        return fmt::format("seam {} of foil {}: its node {} is not in the strip {}", seam.name, block.name, node,
                           foil.strips[static_cast<std::size_t>(side)]);
      }
    }
  }
  return {};
}

std::string fault_in_foils(const State& state) {
  const geometry::Mesh& mesh = state.mesh;
  if (state.foils.size() != mesh.blocks.size()) {
    return fmt::format("{} foils for {} blocks of elements", state.foils.size(), mesh.blocks.size());
  }
  for (std::size_t i = 0; i < mesh.blocks.size(); ++i) {
    const Block& block = mesh.blocks[i];
    const Foil& foil = state.foils[i];
    const std::size_t points = gauss_count(state, block);
    const auto wrong = [&](const char* what, const std::vector<double>& values, std::size_t expected) {
      if (values.empty() || (values.size() == expected && block.kind == BlockKind::foil)) return std::string();
      if (block.kind == BlockKind::base) return fmt::format("the base {} has a {}", block.name, what);
      return fmt::format("foil {}: {} has {} values instead of {}", block.name, what, values.size(), expected);
    };
    for (const std::string& fault :
         {wrong("reference", foil.reference, 3 * block.connectivity.size()),
          wrong("predeformation", foil.predeformation, 3 * points), wrong("prestress", foil.prestress, 3 * points),
          wrong("history", foil.history, foil.history_names.size() * points), fault_in_strips(state, block, foil)}) {
      if (!fault.empty()) return fault;
    }
    if (block.kind == BlockKind::base) continue;
    for (std::string fault : {fault_in_foil_values(foil, "foil " + block.name), fault_in_seams(state, block, foil)}) {
      if (!fault.empty()) return fault;
    }
  }
  return {};
}

std::string fault_in_chambers(const State& state) {
  const auto blocks = static_cast<Index>(state.mesh.blocks.size());
  const auto chambers = static_cast<Index>(state.chambers.size());
  for (const Chamber& chamber : state.chambers) {
    for (const Index wall : {chamber.outer, chamber.inner}) {
      if (wall < 0 || wall >= blocks) {
        return fmt::format("chamber {} names block {}, but there are {}", chamber.name, wall, blocks);
      }
    }
    const Index other = chamber.connected_to;
    if (other < -1 || other >= chambers) {
      return fmt::format("chamber {} is connected to chamber {}, but there are {}", chamber.name, other, chambers);
    }
    if (other >= 0 && state.chambers[static_cast<std::size_t>(other)].connected_to != -1) {
      return fmt::format("chamber {} is connected to chamber {}, which has no air of its own", chamber.name, other);
    }
    if (chamber.law > GasLaw::volume) return fmt::format("chamber {} has an unknown gas law", chamber.name);
    std::string fault = fault_in_bounds({{"dead volume", chamber.dead_volume, 0},
                                         {"kappa", chamber.kappa, 0, true},
                                         {"gauge pressure", chamber.gauge_pressure},
                                         {"ambient pressure", chamber.ambient_pressure, 0},
                                         {"temperature", chamber.temperature, 0, true},
                                         {"volume", chamber.volume}},
                                        "chamber " + chamber.name);
    if (!fault.empty()) return fault;
  }
  return {};
}

std::string fault_in_loads(const State& state) {
  std::set<std::string> names;
  for (const Load& load : state.loads) {
    const std::string whose = fmt::format("load {}", load.name);
    if (!names.insert(load.name).second) return fmt::format("two loads are called {}", load.name);
    if (load.block < 0 || static_cast<std::size_t>(load.block) >= state.mesh.blocks.size()) {
      return fmt::format("{} names block {}, but there are {}", whose, load.block, state.mesh.blocks.size());
    }
    if (!load.dead.empty() && load.dead.size() != 3 * state.mesh.nodes.size()) {
      return fmt::format("{} has {} forces for {} nodes", whose, load.dead.size() / 3, state.mesh.nodes.size());
    }
    for (std::string fault :
         {fault_in_bounds({{"pressure", load.pressure}}, whose), fault_in_values(load.dead, whose + ": forces")}) {
      if (!fault.empty()) return fault;
    }
    for (const geometry::QuadraturePoint& point : load.points) {
      std::string fault = fault_in_bounds({{"a place", point.xi + point.eta}, {"a weight", point.weight}}, whose);
      if (!fault.empty()) return fault;
    }
    if (load.offset.empty() && load.points.empty()) continue;
    const Index elements = state.mesh.element_count(state.mesh.blocks[static_cast<std::size_t>(load.block)]);
    if (load.offset.size() != static_cast<std::size_t>(elements) + 1 || load.offset.front() != 0 ||
        !std::is_sorted(load.offset.begin(), load.offset.end()) ||
        static_cast<std::size_t>(load.offset.back()) != load.points.size()) {
      return fmt::format("{}: its places do not belong to {} elements", whose, elements);
    }
  }
  return {};
}

std::string fault_in_field(const State& state, const Field& field) {
  if (field.name.empty() || field.name == "." || field.name.find('/') != std::string::npos) {
    return fmt::format("a field cannot be called '{}'", field.name);
  }
  if (field.unit.empty()) return fmt::format("field {} has no unit ('1' if it has none)", field.name);
  if (field.components < 1) return fmt::format("field {} has {} components", field.name, field.components);
  std::size_t places = 0;
  switch (field.location) {
  case Location::point:
    places = state.mesh.nodes.size();
    break;
  case Location::cell:
    if (field.name == "foil") return "the cell field foil is written by the state itself (number of the block)";
    for (const Block& block : state.mesh.blocks) {
      places += static_cast<std::size_t>(state.mesh.element_count(block));
    }
    break;
  case Location::gauss:
    if (field.block < 0 || static_cast<std::size_t>(field.block) >= state.mesh.blocks.size()) {
      return fmt::format("field {} is at the Gauss points of block {}, which does not exist", field.name, field.block);
    }
    places = gauss_count(state, state.mesh.blocks[static_cast<std::size_t>(field.block)]);
    break;
  default:
    return fmt::format("field {} is at an unknown place", field.name);
  }
  const std::size_t expected = places * static_cast<std::size_t>(field.components);
  if (field.values.size() == expected) return {}; // where there is no value, NaN says so
  return fmt::format("field {} has {} values instead of {}", field.name, field.values.size(), expected);
}

} // namespace

std::size_t gauss_count(const State& state, const Block& block) {
  const auto points = geometry::stress_rule(state.mesh.element, state.stress_rule).size();
  return static_cast<std::size_t>(state.mesh.element_count(block)) * points;
}

std::string first_fault(const State& state) {
  for (std::string (*fault_in)(const State&) : {fault_in_mesh, fault_in_foils, fault_in_chambers, fault_in_loads}) {
    std::string fault = fault_in(state);
    if (!fault.empty()) return fault;
  }
  std::set<std::tuple<Location, Index, std::string>> names;
  for (const Field& field : state.fields) {
    std::string fault = fault_in_field(state, field);
    if (!fault.empty()) return fault;
    const Index block = field.location == Location::gauss ? field.block : -1;
    if (!names.emplace(field.location, block, field.name).second) {
      return fmt::format("two fields are called {}", field.name);
    }
  }
  return {};
}

} // namespace pneuma::pipeline::state
