// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/workflows/damage/damage.h"

namespace pneuma::tests::damage {

// One stage of a workflow as the programs take it.
struct EffectiveStage {
  std::string run, id;
  std::string text; // stage.yaml
};

// What the programs take from a workflow file: every value by its path, "stages.form.prestress.upper", places left out.
struct Settings {
  std::vector<EffectiveStage> stages;
  std::map<std::string, std::string> values;
};

// Adds the values of a YAML text.
void add_values(const std::string& text, std::map<std::string, std::string>& values);

// The file that was damaged, and perhaps one that uses it, as messages name them.
struct Names {
  std::string damaged = "damaged.yaml";
  std::string user; // calls materials by their names; empty: none
  std::string user_text;
};

// What is wrong with messages about a damage; empty: it is refused at its place with the key or value, in a few lines
// and one for each place.
std::string wrong_refusal(const Damage& damage, const std::string& messages, const Names& names);

// What is wrong with a damage that was accepted; empty: the settings changed as it says, or equal the default.
// `in_materials`: the damaged file is one of materials.
std::string wrong_acceptance(const Damage& damage, const Settings& before, const Settings& after, bool in_materials);

// What is wrong with a dropped key that was accepted. `with_default`: with the default of the schema written out
// instead; nullptr: the schema has none, and nothing may be left of the key.
std::string wrong_default(const Damage& damage, const Settings& dropped, const Settings* with_default,
                          bool in_materials);

} // namespace pneuma::tests::damage
