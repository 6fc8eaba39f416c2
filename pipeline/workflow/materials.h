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

// The tree of a file, kept by the reader, without templates; one that cannot be read is a problem at a place.
const yaml::Node& read_file(Reader& reader, const std::filesystem::path& file, const Mark& named);

// These materials and those that they are fitted to.
std::set<std::string> with_fits(const Materials& materials, const std::vector<std::string>& names);

// Checks what tables are fitted to, reads the tests of the materials of these names and finds out where the user has
// the values of all. Returns those names and what they are fitted to. `of_site`: temperature there, K, where a site is
// known.
std::set<std::string> settle_materials(Reader& reader, Materials& materials, const std::vector<std::string>& names,
                                       std::optional<double> of_site);

} // namespace pneuma::pipeline::workflow
