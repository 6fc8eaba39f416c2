// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/workflow/settings.h"

namespace pneuma::pipeline::runner {

struct RunOptions {
  std::filesystem::path out;      // empty: out/<stem> beside the workflow file
  std::string only;               // this stage alone
  std::string from;               // this stage and all that depends on it, anew
  std::vector<std::string> force; // these stages anew
  int jobs = 0;                   // stages side by side; 0: as many as there are cores
};

std::filesystem::path output_folder(const workflow::Workflow& workflow, const std::filesystem::path& out);

// Runs what is out of date and prints why; returns the exit code. Throws InputError for a stage that does not exist,
// for options that exclude each other (a forced stage that `only` or `from` leaves out) and for a folder in use,
// StateError for an input that `only` needs and does not find.
int run(const workflow::Workflow& workflow, const RunOptions& options);

// Prints which stages are fresh, which are stale and why, and their key results.
void show_status(const workflow::Workflow& workflow, const std::filesystem::path& out);

} // namespace pneuma::pipeline::runner
