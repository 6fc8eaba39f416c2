// SPDX-License-Identifier: GPL-3.0-or-later
// Rules between the keys of one group.
#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "pipeline/workflow/settings.h"

namespace pneuma::pipeline::workflow {

void MeshSettings::check(Reader& reader, const At<MeshSettings>& mesh) {
  if (mesh->stress_rule == geometry::StressRule::full || mesh->element == geometry::ElementType::Q9) return;
  static constexpr const char* elements[] = {"T3", "T6", "Q4", "Q9"};
  reader.fail(mesh[&MeshSettings::stress_rule].path, fmt::format("the reduced rule is for Q9, not {}; allowed: full",
                                                                 elements[static_cast<std::size_t>(mesh->element)]));
}

void Roll::check(Reader& reader, const At<Roll>& roll) {
  const double lost = roll->weld + 2 * roll->selvedge;
  if (lost < roll->width) return;
  reader.fail(roll.path, fmt::format("the {} and two times the {} ({} m) leave nothing of the {} {} m; it must be "
                                     "larger than they are together",
                                     schema::name(&Roll::weld), schema::name(&Roll::selvedge), lost,
                                     schema::name(&Roll::width), roll->width));
}

void PatternSettings::check(Reader& reader, const At<PatternSettings>& pattern) {
  if (!pattern->foils) return;
  std::set<std::string> seen;
  const auto foils = pattern[&PatternSettings::foils].path;
  for (std::size_t i = 0; i < pattern->foils->size(); ++i) {
    const std::string& foil = (*pattern->foils)[i];
    if (seen.insert(foil).second) continue;
    reader.fail(schema::below(foils, std::to_string(i)), fmt::format("the foil `{}` stands here a second time", foil));
  }
}

void DisplacementControl::check(Reader& reader, const At<DisplacementControl>& control) {
  if (control->at || control->until > 0) return;
  const std::string until = control[&DisplacementControl::until].path;
  reader.fail(until, fmt::format("{} must be positive, not {}: the largest displacement (`at: max`) has no sign",
                                 schema::name(&DisplacementControl::until), reader.written(until)));
}

void PathSettings::check(Reader& reader, const At<PathSettings>& path) {
  Moment last;
  for (const At<Moment>& moment : items(path[&PathSettings::history])) {
    const bool begins = &moment.value == &path->history.front() && moment->time == 0 && moment->factor == 0;
    if (moment->time < last.time) {
      reader.fail(moment.path, fmt::format("time goes back: {} s after {} s", moment->time, last.time));
    } else if (moment->time == last.time && moment->factor == last.factor && !begins) {
      reader.fail(moment.path, "nothing happens up to this moment: neither time nor factor change");
    }
    last = moment.value;
  }
}

void WindSettings::check(Reader& reader, const At<WindSettings>& wind) {
  PathSettings::check(reader, wind);
  std::set<std::string> seen;
  for (const At<Load>& load : items(wind[&WindSettings::loads])) {
    if (seen.insert(load->name).second) continue;
    reader.fail(load[&Load::name].path,
                fmt::format("a second load `{}`: every load needs a name of its own", load->name));
  }
}

} // namespace pneuma::pipeline::workflow

namespace pneuma::pipeline::schema {

#define PNEUMA_INSTANCE(T) template const Keys<workflow::T>& keys_of<workflow::T>();
PNEUMA_DECLARED(PNEUMA_INSTANCE)
#undef PNEUMA_INSTANCE

} // namespace pneuma::pipeline::schema
