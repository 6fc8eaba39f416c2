// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/schema/option.h"
#include "pipeline/workflow/settings.h"

namespace pneuma::pipeline::workflow {

using schema::Value;

inline constexpr const char* all_foils = "all"; // key that stands for every foil

base::Vec2 vec2_of(const Value& list);
Vec3 vec3_of(const Value& list);

// Of length 1; a normalised one stays as it is to the last bit: it is read again from stage.yaml.
Vec3 unit(const Vec3& v);

// Turns checked values into settings and checks what no single option can know: names, neighbours, the graph. Used by
// read_workflow and read_stage alone.
class Builder {
public:
  Builder(std::filesystem::path file, bool is_stage_file);

  std::vector<Problem> problems;

  Workflow build(const schema::Node& tree);
  // Of a file of materials alone: those of these names, or all.
  MaterialsResult build_materials(const std::vector<std::string>& names);

private:
  void fail(const Mark& mark, std::string message) { problems.push_back({mark, std::move(message), true}); }
  void warn(const Mark& mark, std::string message) { problems.push_back({mark, std::move(message), false}); }
  // A key that a user gave and that cannot stand where it does: why.
  void refuse(const Value& group, const std::string& key, const std::string& reason);

  // builder_cushion.cpp
  void read_site(const Value& site);
  void read_cushion(const Value& cushion);
  void read_plan(const Value& plan);
  void read_edges(const Value& edges);
  void read_foils(const Value& foils);
  void check_foil_name(const Value& name);
  // Position of a wall from the weather side inwards; the base comes after the last foil.
  std::optional<std::size_t> wall_position(const Value& wall);
  void fail_unknown_foil(const Mark& mark, const std::string& name);
  void read_chambers(const Value& chambers);
  void check_connection(const std::string& name, const Value& connected_to);
  // The chamber whose air a chamber has: the one it is connected to, or itself.
  std::string air_of(const std::string& chamber) const;
  void read_walls(const Value& between, ChamberSettings& chamber, std::map<std::size_t, std::string>& gaps);
  // Of a value and of all that lies in it.
  void copy_origin(const std::string& from, const std::string& to);

  // builder_materials.cpp
  void read_materials(const Value& root);
  void read_materials_file(const std::filesystem::path& file, const Mark& named);
  void add_material(const std::string& name, const Value& value);
  Material material_of(const std::string& name, const Value& value);
  // `entry`: of another temperature; what it leaves out is as in the material
  MaterialLaw law_of(const Value& material, const Value* entry);
  MaterialLaw elastic_of(const Value& material, const Value* entry);
  J2Law j2_of(const Value& material, const Value* entry);
  void check_hardening(const Value& hardening, const J2Law& law);
  ViscositySettings viscosity_of(const Value& viscosity, const J2Law& law);
  OgdenLaw ogden_of(const Value& terms);
  TableLaw table_of(const Value& material);
  std::optional<Strength> strength_of(const Value& material);
  // A key that this kind of law needs: "`etfe` lacks ...".
  void need(const Value& material, const std::string& key, const std::string& why);
  // What is known only when all materials and foils are: what tables are fitted to, their points, the site's
  // temperature; drops what no foil uses.
  void finish_materials();
  void check_fits();
  // These materials and those that they are fitted to.
  std::set<std::string> with_fits(const std::vector<std::string>& names) const;
  // `of_site`: temperature there, K, where a site is known.
  void read_points(const std::string& name, std::optional<double> of_site);
  void check_test_temperatures(const Mark& data, const std::array<double, 2>& tests, std::optional<double> of_site);
  void check_temperature(const Material& material);

  // builder_stages.cpp
  void add_mesh(const Value& mesh);
  void check_size(const Value& mesh, const MeshSettings& out);
  // {FOIL or all: value} for every foil.
  std::map<std::string, double> per_foil(const Value& table, const std::string& path, const std::string& key);
  void check_chamber(const Mark& mark, const std::string& name);
  std::map<std::string, double> pressures_of(const Value& stage, const std::string& path);
  static SolverOptions options_of(const Value& stage);
  // `gas`: of the chambers in this stage; none: regulated
  Control control_of(const Value& stage, const std::string& path, const std::map<std::string, Gas>& gas = {});
  std::vector<Moment> schedule_of(const Value& stage, const std::string& path);
  DisplacementControl displacement_control(const Value& control);
  VolumeControl volume_control(const Value& control, const std::map<std::string, Gas>& gas);
  ArcLengthControl arc_length_control(const Value& control);
  // The foil or chamber that a control names, or the only one.
  std::string controlled_foil(const Value& control);
  std::string controlled_chamber(const Value& control);
  void read_stages(const Value& stages);
  // Kind of the stage that `from` names; empty: unknown, or refused where it stands.
  static std::string kind_of(const std::string& id, const std::map<std::string, const Value*>& known);
  void add_stage(const std::string& id, const Value& stage, const std::map<std::string, const Value*>& known);
  void check_from(const std::string& id, const Value& stage, const Value& from, const StageSettings& out,
                  const std::map<std::string, const Value*>& known);
  // Follows `from`; each circle is reported once, at its first stage in the file.
  bool in_cycle(const std::string& id, const Value& from, const std::map<std::string, const Value*>& known);
  FormfindSettings formfind_of(const Value& stage, const std::string& path);
  InflateSettings inflate_of(const Value& stage, const std::string& path, const std::string& from_run);
  WindSettings wind_of(const Value& stage, const std::string& path, const std::map<std::string, const Value*>& known);
  Gas gas_of(const Value& value);
  Load load_of(const Value& value, const Value* factors, const std::vector<Load>& before);
  void check_loaded_foil(const Value& foil, const Load& load);
  Region region_of(const Value& region);
  // The loads of the stages before, which a wind stage begins with: name -> stage. In stage.yaml they are not known.
  std::map<std::string, std::string> loads_before(const Value& stage, const std::map<std::string, const Value*>& known);
  // Factors of loads that are not the stage's own.
  std::map<std::string, double> carried_of(const Value* factors, const std::vector<Load>& own,
                                           const std::map<std::string, std::string>& before, bool from_wind);
  void check_gravity();

  // builder_pattern.cpp
  PatternSettings pattern_of(const Value& stage, const std::string& path);
  Roll roll_of(const Value& roll);
  Compensation compensation_of(const Value& stage);
  std::vector<std::string> foils_to_cut(const Value& foils);
  // `foils`: those to be cut; empty: not stated
  std::map<std::string, PlanCurves> curves_of(const Value& table, const std::string& path,
                                              const std::vector<std::string>& foils);

  Workflow workflow_;
  bool is_stage_file_ = false;
  bool materials_known_ = true;
  bool plan_known_ = false;
  bool connections_known_ = true; // between chambers
  std::vector<std::string> material_names_, foil_names_, chamber_names_;
  std::vector<std::pair<std::string, Mark>> material_places_; // where foils name them
  std::map<std::string, Value> tables_;                       // what was read of table materials
};

} // namespace pneuma::pipeline::workflow
