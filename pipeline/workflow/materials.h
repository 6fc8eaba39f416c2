// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <set>

#include "pipeline/workflow/material.h"

// The materials that a workflow names: their files, the tests of their tables, and what no single one can know.
namespace pneuma::pipeline::workflow {

using Materials = std::map<std::string, Material>;

// Every name of a map of materials is defined, those with faults too.
void define_materials(Reader& reader, const yaml::Node& map);

// Reads the materials of a file, which is named at a place: those without fault.
void read_materials_file(Reader& reader, const std::filesystem::path& file, const Mark& named, Materials& out);

// What tables are fitted to exists, has no rate and no axes of its own, and does not go in a circle.
void check_fits(Reader& reader, const Materials& materials);

// These materials and those that they are fitted to.
std::set<std::string> with_fits(const Materials& materials, const std::vector<std::string>& names);

// Reads the points of a table's files of tests; `of_site`: temperature there, K, where a site is known.
void read_tests(Reader& reader, Material& material, std::optional<double> of_site);

// Fills in where the user has its values.
void find_places(const Reader& reader, Material& material);

} // namespace pneuma::pipeline::workflow
