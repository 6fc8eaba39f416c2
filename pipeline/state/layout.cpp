// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/state/layout.h"

#include <array>
#include <cstring>

#include <fmt/format.h>

#include "pipeline/state/check.h"
#include "pipeline/state/hdf5.h"

namespace pneuma::pipeline::state {

namespace {

using geometry::Block;
using geometry::BlockKind;
using geometry::ElementType;
using geometry::StressRule;
using hdf5::any;
using hdf5::Group;

constexpr std::array element_types = {ElementType::T3, ElementType::T6, ElementType::Q4, ElementType::Q9};

std::uint8_t vtk_cell_type(ElementType type) {
  constexpr std::array<std::uint8_t, 4> number = {5, 22, 9, 28};
  return number[static_cast<std::size_t>(type)];
}

std::string numbered(std::size_t i) {
  return fmt::format("{:04}", i);
}

const char* name_of(StressRule rule) {
  return rule == StressRule::full ? "full" : "reduced";
}

template <class Record, class Member>
auto column(const std::vector<Record>& records, Member Record::*member) {
  std::vector<Member> values;
  values.reserve(records.size());
  for (const Record& record : records) values.push_back(record.*member);
  return values;
}

template <class T>
void write_list(const Group& group, const std::string& name, const std::vector<T>& values, const std::string& unit) {
  group.write<T>(name, values, {values.size()}, unit);
}

template <class T>
void write_number(const Group& group, const std::string& name, T value, const std::string& unit) {
  group.write<T>(name, std::span<const T>(&value, 1), {1}, unit);
}

template <class T>
T read_number(const Group& group, const std::string& name) {
  return group.read<T>(name, {1})[0];
}

void require(bool fine, const std::string& fault) {
  if (!fine) throw hdf5::Failure(fault);
}

// --- /VTKHDF ---

std::size_t cell_count(const geometry::Mesh& mesh) {
  std::size_t count = 0;
  for (const Block& block : mesh.blocks) count += static_cast<std::size_t>(mesh.element_count(block));
  return count;
}

void write_grid(const Group& vtk, const State& state) {
  const geometry::Mesh& mesh = state.mesh;
  const std::size_t cells = cell_count(mesh);
  const auto nodes_each = static_cast<std::size_t>(geometry::nodes_per_element(mesh.element));
  vtk.set_attribute("Version", std::vector<std::int64_t>{1, 0});
  vtk.set_attribute("Type", "UnstructuredGrid");
  write_number(vtk, "NumberOfPoints", static_cast<std::int64_t>(mesh.nodes.size()), "1");
  write_number(vtk, "NumberOfCells", static_cast<std::int64_t>(cells), "1");
  write_number(vtk, "NumberOfConnectivityIds", static_cast<std::int64_t>(cells * nodes_each), "1");

  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  const double* first = mesh.nodes.empty() ? nullptr : mesh.nodes.front().data();
  vtk.write<double>("Points", {first, 3 * mesh.nodes.size()}, {mesh.nodes.size(), 3}, "m");

  std::vector<std::int64_t> connectivity;
  std::vector<std::int64_t> offsets;
  std::vector<std::int32_t> foil;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const Block& block = mesh.blocks[b];
    connectivity.insert(connectivity.end(), block.connectivity.begin(), block.connectivity.end());
    foil.resize(foil.size() + static_cast<std::size_t>(mesh.element_count(block)), static_cast<std::int32_t>(b));
  }
  for (std::size_t c = 0; c <= cells; ++c) offsets.push_back(static_cast<std::int64_t>(c * nodes_each));
  write_list(vtk, "Connectivity", connectivity, "1");
  write_list(vtk, "Offsets", offsets, "1");
  write_list(vtk, "Types", std::vector<std::uint8_t>(cells, vtk_cell_type(mesh.element)), "1");

  const Group points = vtk.create("PointData");
  const Group elements = vtk.create("CellData");
  write_list(elements, "foil", foil, "1");
  for (const Field& field : state.fields) {
    if (field.location == Location::gauss) continue;
    const auto components = static_cast<std::uint64_t>(field.components);
    hdf5::Shape shape = {field.values.size() / components};
    if (components > 1) shape.push_back(components);
    (field.location == Location::point ? points : elements).write<double>(field.name, field.values, shape, field.unit);
  }

  const Group whole = vtk.create("FieldData"); // for the eye in ParaView; reading takes them from /pneuma
  write_number(whole, "load_factor", state.provenance.load_factor, "1");
  write_list(whole, "origin", std::vector<double>(state.origin.begin(), state.origin.end()), "m");
  if (!state.chambers.empty()) {
    write_list(whole, "gauge_pressure", column(state.chambers, &Chamber::gauge_pressure), "Pa");
    write_list(whole, "volume", column(state.chambers, &Chamber::volume), "m3");
  }
}

// Nodes and connectivity of all blocks, one after the other.
std::vector<Index> read_grid(const Group& vtk, geometry::Mesh& mesh) {
  const std::vector<double> points = vtk.read<double>("Points", {any, 3});
  mesh.nodes.resize(points.size() / 3);
  if (!points.empty()) std::memcpy(mesh.nodes.front().data(), points.data(), points.size() * sizeof(double));
  const std::vector<std::int64_t> file = vtk.read<std::int64_t>("Connectivity", {any});
  std::vector<Index> connectivity;
  connectivity.reserve(file.size());
  for (const std::int64_t node : file) {
    require(node >= 0 && static_cast<std::uint64_t>(node) < mesh.nodes.size(),
            fmt::format("/VTKHDF/Connectivity: names node {}, but there are {}", node, mesh.nodes.size()));
    connectivity.push_back(static_cast<Index>(node));
  }
  return connectivity;
}

// --- /pneuma ---

void write_blocks(const Group& group, const geometry::Mesh& mesh) {
  std::vector<std::uint8_t> kinds;
  std::vector<std::int64_t> counts;
  for (const Block& block : mesh.blocks) {
    kinds.push_back(static_cast<std::uint8_t>(block.kind));
    counts.push_back(mesh.element_count(block));
  }
  group.write("name", column(mesh.blocks, &Block::name));
  write_list(group, "kind", kinds, "1");
  write_list(group, "elements", counts, "1");
}

void read_blocks(const Group& group, geometry::Mesh& mesh, const std::vector<Index>& connectivity) {
  const std::vector<std::string> names = group.read_texts("name");
  const std::vector<std::uint8_t> kinds = group.read<std::uint8_t>("kind", {names.size()});
  const std::vector<std::int64_t> counts = group.read<std::int64_t>("elements", {names.size()});
  const auto nodes_each = static_cast<std::size_t>(geometry::nodes_per_element(mesh.element));
  auto next = connectivity.begin();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto left = static_cast<std::size_t>(connectivity.end() - next) / nodes_each;
    require(kinds[i] <= static_cast<std::uint8_t>(BlockKind::base), "/pneuma/blocks/kind: unknown kind");
    require(counts[i] >= 0 && static_cast<std::uint64_t>(counts[i]) <= left,
            "/pneuma/blocks/elements: do not sum to the cells of the grid");
    const auto end = next + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(counts[i]) * nodes_each);
    mesh.blocks.push_back({names[i], static_cast<BlockKind>(kinds[i]), {next, end}});
    next = end;
  }
  require(next == connectivity.end(), "/pneuma/blocks/elements: do not sum to the cells of the grid");
}

// The nodes of edges or seams, one list after the other, and how many each has.
template <class Line>
void write_node_lists(const Group& group, const std::vector<Line>& lines) {
  std::vector<std::int64_t> counts;
  std::vector<Index> nodes;
  for (const Line& line : lines) {
    counts.push_back(static_cast<std::int64_t>(line.nodes.size()));
    nodes.insert(nodes.end(), line.nodes.begin(), line.nodes.end());
  }
  write_list(group, "count", counts, "1");
  write_list(group, "nodes", nodes, "1");
}

template <class Line>
void read_node_lists(const Group& group, std::vector<Line>& lines, const std::string& place) {
  const std::vector<std::int64_t> counts = group.read<std::int64_t>("count", {lines.size()});
  const std::vector<Index> nodes = group.read<Index>("nodes", {any});
  const std::string fault = place + "/count: does not sum to the nodes";
  auto next = nodes.begin();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    require(counts[i] >= 0 && counts[i] <= nodes.end() - next, fault);
    lines[i].nodes.assign(next, next + counts[i]);
    next += counts[i];
  }
  require(next == nodes.end(), fault);
}

void write_edges(const Group& group, const geometry::Mesh& mesh) {
  std::vector<std::uint8_t> closed;
  closed.reserve(mesh.edges.size());
  for (const geometry::Edge& edge : mesh.edges) closed.push_back(edge.closed ? 1 : 0);
  group.write("name", column(mesh.edges, &geometry::Edge::name));
  write_list(group, "closed", closed, "1");
  write_node_lists(group, mesh.edges);
}

void read_edges(const Group& group, geometry::Mesh& mesh) {
  const std::vector<std::string> names = group.read_texts("name");
  const std::vector<std::uint8_t> closed = group.read<std::uint8_t>("closed", {names.size()});
  for (std::size_t i = 0; i < names.size(); ++i) {
    require(closed[i] <= 1, "/pneuma/edges/closed: neither 0 nor 1");
    mesh.edges.push_back({names[i], closed[i] == 1, {}});
  }
  read_node_lists(group, mesh.edges, "/pneuma/edges");
}

void write_seams(const Group& group, const std::vector<Seam>& seams) {
  group.write("name", column(seams, &Seam::name));
  write_list(group, "left", column(seams, &Seam::left), "1");
  write_list(group, "right", column(seams, &Seam::right), "1");
  write_node_lists(group, seams);
}

std::vector<Seam> read_seams(const Group& group, const std::string& place) {
  const std::vector<std::string> names = group.read_texts("name");
  const std::vector<Index> left = group.read<Index>("left", {names.size()});
  const std::vector<Index> right = group.read<Index>("right", {names.size()});
  std::vector<Seam> seams;
  for (std::size_t i = 0; i < names.size(); ++i) seams.push_back({names[i], left[i], right[i], {}});
  read_node_lists(group, seams, place);
  return seams;
}

std::uint64_t points_per_element(const State& state) {
  return geometry::stress_rule(state.mesh.element, state.stress_rule).size();
}

void write_foil(const Group& group, const State& state, const Foil& foil) {
  const auto corners = static_cast<std::uint64_t>(geometry::nodes_per_element(state.mesh.element));
  const std::uint64_t points = points_per_element(state);
  const auto per_element = [&](const std::string& name, const std::vector<double>& values, std::uint64_t places,
                               std::uint64_t components, const std::string& unit) {
    const std::uint64_t elements = values.empty() ? 0 : values.size() / (places * components);
    group.write<double>(name, values, {elements, places, components}, unit);
  };
  group.write("material", std::vector{foil.material});
  write_number(group, "thickness", foil.thickness, "m");
  write_number(group, "warp_angle", foil.warp_angle, "rad");
  per_element("reference", foil.reference, corners, 3, "m");
  per_element("predeformation", foil.predeformation, points, 3, "1");
  per_element("prestress", foil.prestress, points, 3, "N/m");
  group.write("history_names", foil.history_names);
  per_element("history", foil.history, points, foil.history_names.size(), "SI"); // each component has its own
  group.write("strips", foil.strips);
  write_list(group, "strip_of_element", foil.strip_of_element, "1");
  write_seams(group.create("seams"), foil.seams);
}

Foil read_foil(const Group& foils, const std::string& number, const State& state) {
  const Group group = foils.open(number);
  const auto corners = static_cast<std::uint64_t>(geometry::nodes_per_element(state.mesh.element));
  const std::uint64_t points = points_per_element(state);
  Foil foil;
  foil.material = group.read_texts("material", 1)[0];
  foil.thickness = read_number<double>(group, "thickness");
  foil.warp_angle = read_number<double>(group, "warp_angle");
  foil.reference = group.read<double>("reference", {any, corners, 3});
  foil.predeformation = group.read<double>("predeformation", {any, points, 3});
  foil.prestress = group.read<double>("prestress", {any, points, 3});
  foil.history_names = group.read_texts("history_names");
  foil.history = group.read<double>("history", {any, points, foil.history_names.size()});
  foil.strips = group.read_texts("strips");
  foil.strip_of_element = group.read<Index>("strip_of_element", {any});
  foil.seams = read_seams(group.open("seams"), "/pneuma/foils/" + number + "/seams");
  return foil;
}

void write_chambers(const Group& group, const std::vector<Chamber>& chambers) {
  std::vector<std::uint8_t> laws;
  laws.reserve(chambers.size());
  for (const Chamber& chamber : chambers) laws.push_back(static_cast<std::uint8_t>(chamber.law));
  group.write("name", column(chambers, &Chamber::name));
  write_list(group, "outer", column(chambers, &Chamber::outer), "1");
  write_list(group, "inner", column(chambers, &Chamber::inner), "1");
  write_list(group, "connected_to", column(chambers, &Chamber::connected_to), "1");
  write_list(group, "law", laws, "1");
  write_list(group, "kappa", column(chambers, &Chamber::kappa), "1");
  write_list(group, "dead_volume", column(chambers, &Chamber::dead_volume), "m3");
  write_list(group, "gauge_pressure", column(chambers, &Chamber::gauge_pressure), "Pa");
  write_list(group, "ambient_pressure", column(chambers, &Chamber::ambient_pressure), "Pa");
  write_list(group, "temperature", column(chambers, &Chamber::temperature), "K");
  write_list(group, "volume", column(chambers, &Chamber::volume), "m3");
}

std::vector<Chamber> read_chambers(const Group& group) {
  const std::vector<std::string> names = group.read_texts("name");
  std::vector<Chamber> chambers(names.size());
  const auto fill = [&]<class T>(const std::string& name, T Chamber::*member) {
    const std::vector<T> values = group.read<T>(name, {names.size()});
    for (std::size_t i = 0; i < values.size(); ++i) chambers[i].*member = values[i];
  };
  fill("outer", &Chamber::outer);
  fill("inner", &Chamber::inner);
  fill("connected_to", &Chamber::connected_to);
  fill("kappa", &Chamber::kappa);
  fill("dead_volume", &Chamber::dead_volume);
  fill("gauge_pressure", &Chamber::gauge_pressure);
  fill("ambient_pressure", &Chamber::ambient_pressure);
  fill("temperature", &Chamber::temperature);
  fill("volume", &Chamber::volume);
  const std::vector<std::uint8_t> laws = group.read<std::uint8_t>("law", {names.size()});
  for (std::size_t i = 0; i < names.size(); ++i) {
    require(laws[i] <= static_cast<std::uint8_t>(GasLaw::volume), "/pneuma/chambers/law: unknown gas law");
    chambers[i].name = names[i];
    chambers[i].law = static_cast<GasLaw>(laws[i]);
  }
  return chambers;
}

void write_loads(const Group& group, const std::vector<Load>& loads) {
  group.write("name", column(loads, &Load::name));
  write_list(group, "block", column(loads, &Load::block), "1");
  write_list(group, "pressure", column(loads, &Load::pressure), "Pa");
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const Load& load = loads[i];
    const Group one = group.create(numbered(i));
    write_list(one, "offset", load.offset, "1");
    static_assert(sizeof(geometry::QuadraturePoint) == 3 * sizeof(double));
    const double* first = load.points.empty() ? nullptr : &load.points.front().xi;
    one.write<double>("points", {first, 3 * load.points.size()}, {load.points.size(), 3}, "1");
    one.write<double>("dead", load.dead, {load.dead.size() / 3, 3}, "N");
  }
}

std::vector<Load> read_loads(const Group& group) {
  const std::vector<std::string> names = group.read_texts("name");
  const std::vector<Index> blocks = group.read<Index>("block", {names.size()});
  const std::vector<double> pressures = group.read<double>("pressure", {names.size()});
  std::vector<Load> loads;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Group one = group.open(numbered(i));
    Load load{names[i], blocks[i], pressures[i], one.read<Index>("offset", {any}), {}, {}};
    const std::vector<double> points = one.read<double>("points", {any, 3});
    for (std::size_t k = 0; k < points.size(); k += 3) load.points.push_back({points[k], points[k + 1], points[k + 2]});
    load.dead = one.read<double>("dead", {any, 3});
    loads.push_back(std::move(load));
  }
  return loads;
}

// The list keeps the fields' order and what a dataset in PointData or CellData cannot say; the values of Gauss fields
// lie here, too.
void write_fields(const Group& group, const State& state) {
  std::vector<std::uint8_t> locations;
  locations.reserve(state.fields.size());
  for (const Field& field : state.fields) locations.push_back(static_cast<std::uint8_t>(field.location));
  group.write("name", column(state.fields, &Field::name));
  write_list(group, "location", locations, "1");
  write_list(group, "components", column(state.fields, &Field::components), "1");
  write_list(group, "block", column(state.fields, &Field::block), "1");
  const Group gauss = group.create("gauss");
  const std::uint64_t points = points_per_element(state);
  for (std::size_t i = 0; i < state.fields.size(); ++i) {
    const Field& field = state.fields[i];
    if (field.location != Location::gauss) continue;
    const auto components = static_cast<std::uint64_t>(field.components);
    gauss.write<double>(numbered(i), field.values, {field.values.size() / (points * components), points, components},
                        field.unit);
  }
}

std::vector<Field> read_fields(const Group& group, const Group& vtk, const State& state) {
  const Group points = vtk.open("PointData");
  const Group cells = vtk.open("CellData");
  const Group gauss = group.open("gauss");
  const std::vector<std::string> names = group.read_texts("name");
  const std::vector<std::uint8_t> locations = group.read<std::uint8_t>("location", {names.size()});
  const std::vector<int> components = group.read<int>("components", {names.size()});
  const std::vector<Index> blocks = group.read<Index>("block", {names.size()});
  std::vector<Field> fields;
  for (std::size_t i = 0; i < names.size(); ++i) {
    require(locations[i] <= static_cast<std::uint8_t>(Location::gauss), "/pneuma/fields/location: unknown place");
    require(components[i] >= 1, "/pneuma/fields/components: must be positive");
    Field field{names[i], "", static_cast<Location>(locations[i]), components[i], blocks[i], {}};
    const bool in_gauss = field.location == Location::gauss;
    const Group& home = in_gauss ? gauss : field.location == Location::point ? points : cells;
    const std::string dataset = in_gauss ? numbered(i) : field.name;
    const auto c = static_cast<std::uint64_t>(field.components);
    hdf5::Shape shape = {any};
    if (in_gauss) shape.push_back(points_per_element(state));
    if (in_gauss || c > 1) shape.push_back(c);
    field.values = home.read<double>(dataset, shape);
    field.unit = home.unit(dataset);
    fields.push_back(std::move(field));
  }
  return fields;
}

void write_provenance(const Group& group, const Provenance& provenance) {
  std::vector<std::string> names;
  std::vector<std::string> digests;
  for (const auto& [name, digest] : provenance.inputs) {
    names.push_back(name);
    digests.push_back(digest);
  }
  group.write("program", std::vector{provenance.program});
  group.write("stage_kind", std::vector{provenance.stage_kind});
  group.write("stage_id", std::vector{provenance.stage_id});
  group.write("input_names", names);
  group.write("input_digests", digests);
  group.write("settings", std::vector{provenance.settings});
  group.write("verdict", std::vector{provenance.verdict});
  write_number<std::uint8_t>(group, "converged", provenance.converged ? 1 : 0, "1");
  write_number(group, "load_factor", provenance.load_factor, "1");
}

Provenance read_provenance(const Group& group) {
  Provenance provenance;
  const auto text = [&](const char* name) { return group.read_texts(name, 1)[0]; };
  provenance.program = text("program");
  provenance.stage_kind = text("stage_kind");
  provenance.stage_id = text("stage_id");
  provenance.settings = text("settings");
  provenance.verdict = text("verdict");
  provenance.converged = read_number<std::uint8_t>(group, "converged") != 0;
  provenance.load_factor = read_number<double>(group, "load_factor");
  const std::vector<std::string> names = group.read_texts("input_names");
  const std::vector<std::string> digests = group.read_texts("input_digests", names.size());
  for (std::size_t i = 0; i < names.size(); ++i) provenance.inputs[names[i]] = digests[i];
  return provenance;
}

ElementType element_of(const std::string& name) {
  for (const ElementType type : element_types) {
    if (name == geometry::name_of(type)) return type;
  }
  throw hdf5::Failure("/pneuma/@element: unknown element '" + name + "'");
}

StressRule stress_rule_of(const std::string& name) {
  for (const StressRule rule : {StressRule::full, StressRule::reduced}) {
    if (name == name_of(rule)) return rule;
  }
  throw hdf5::Failure("/pneuma/@stress_rule: unknown rule '" + name + "'");
}

} // namespace

std::string to_bytes(const State& state) {
  return hdf5::new_file([&](const Group& root) {
    write_grid(root.create("VTKHDF"), state);

    const Group pneuma = root.create("pneuma");
    pneuma.set_attribute("schema", std::vector<std::int64_t>{schema_version});
    pneuma.set_attribute("element", geometry::name_of(state.mesh.element));
    pneuma.set_attribute("stress_rule", name_of(state.stress_rule));
    write_list(pneuma, "origin", std::vector<double>(state.origin.begin(), state.origin.end()), "m");
    write_blocks(pneuma.create("blocks"), state.mesh);
    write_edges(pneuma.create("edges"), state.mesh);
    pneuma.write<std::uint8_t>("fixed", state.fixed, {state.mesh.nodes.size(), 3}, "1");
    const Group foils = pneuma.create("foils");
    for (std::size_t i = 0; i < state.foils.size(); ++i) write_foil(foils.create(numbered(i)), state, state.foils[i]);
    write_chambers(pneuma.create("chambers"), state.chambers);
    write_loads(pneuma.create("loads"), state.loads);
    write_fields(pneuma.create("fields"), state);
    write_provenance(pneuma.create("provenance"), state.provenance);
  });
}

State from_bytes(const std::string& bytes) {
  const hdf5::File file(bytes);
  const Group root = file.root();
  const Group pneuma = root.open("pneuma");
  const std::vector<std::int64_t> schema = pneuma.number_attribute("schema");
  require(schema.size() == 1, "/pneuma/@schema: one number is expected");
  require(schema[0] == schema_version,
          fmt::format("it has schema version {}, this program reads version {}", schema[0], schema_version));
  const Group vtk = root.open("VTKHDF");

  State state;
  state.mesh.element = element_of(pneuma.text_attribute("element"));
  state.stress_rule = stress_rule_of(pneuma.text_attribute("stress_rule"));
  require(state.stress_rule == StressRule::full || state.mesh.element == ElementType::Q9,
          "/pneuma/@stress_rule: reduced is for Q9 only");
  state.origin = Vec3(pneuma.read<double>("origin", {3}).data());
  const std::vector<Index> connectivity = read_grid(vtk, state.mesh);
  read_blocks(pneuma.open("blocks"), state.mesh, connectivity);
  const std::vector<std::uint8_t> types(cell_count(state.mesh), vtk_cell_type(state.mesh.element));
  require(vtk.read<std::uint8_t>("Types", {types.size()}) == types, "/VTKHDF/Types: do not fit the element");
  read_edges(pneuma.open("edges"), state.mesh);
  state.fixed = pneuma.read<std::uint8_t>("fixed", {state.mesh.nodes.size(), 3});
  const Group foils = pneuma.open("foils");
  for (std::size_t i = 0; i < state.mesh.blocks.size(); ++i) {
    state.foils.push_back(read_foil(foils, numbered(i), state));
  }
  state.chambers = read_chambers(pneuma.open("chambers"));
  state.loads = read_loads(pneuma.open("loads"));
  state.fields = read_fields(pneuma.open("fields"), vtk, state);
  state.provenance = read_provenance(pneuma.open("provenance"));
  const std::string fault = first_fault(state);
  require(fault.empty(), fault);
  return state;
}

} // namespace pneuma::pipeline::state
