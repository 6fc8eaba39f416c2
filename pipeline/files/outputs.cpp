// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/files/outputs.h"

#include <sstream>

#include <fmt/format.h>

namespace pneuma::pipeline::files {

namespace fs = std::filesystem;

namespace {

fs::path list_of(const fs::path& state) {
  return state.parent_path() / fmt::format(".{}.outputs", state.filename().string());
}

// Whether a listed name is that of a file in the folder: a damaged list must not remove what lies elsewhere.
bool is_inside(const fs::path& folder, const fs::path& name) {
  if (!name.has_filename() || name.is_absolute() || name != name.lexically_normal()) return false;
  if (*name.begin() == ".." || name == ".") return false;
  std::error_code ignored;
  return !name.has_parent_path() || !fs::is_symlink(folder / name.parent_path(), ignored);
}

fs::path without_last_run(const fs::path& state, const fs::path& input) {
  std::set<std::string> old = outputs_of(state);
  std::error_code ignored;
  if (fs::equivalent(state, input, ignored)) {
    for (const char* of : {"", ".sha256"}) old.erase(state.filename().string() + of);
  }
  remove_outputs(state.parent_path(), old);
  return list_of(state);
}

} // namespace

std::set<std::string> outputs_of(const fs::path& state) {
  std::error_code ignored;
  if (!fs::is_regular_file(fs::symlink_status(list_of(state), ignored))) return {};
  std::istringstream lines(read_whole(list_of(state)));
  std::set<std::string> names;
  for (std::string name; std::getline(lines, name);) {
    if (is_inside(state.parent_path(), name)) names.insert(name);
  }
  return names;
}

void remove_outputs(const fs::path& folder, const std::set<std::string>& names) {
  for (const std::string& name : names) {
    if (!is_inside(folder, name)) continue;
    std::error_code failure;
    if (fs::is_directory(fs::symlink_status(folder / name, failure))) continue; // nobody's output
    fs::remove(folder / name, failure);
    if (failure) refuse(folder / name, "cannot be removed", failure.value());
    const fs::path around = (folder / name).parent_path();
    if (around != folder) fs::remove(around, failure); // if empty
  }
}

Outputs::Outputs(const fs::path& state, const fs::path& input)
    : folder_(state.parent_path()), state_name_(state.filename().string()), list_(without_last_run(state, input)) {}

fs::path Outputs::file(const std::string& name) {
  list_.add(name + "\n");
  const fs::path path = folder_ / name;
  if (path.parent_path() != folder_) make_folder(path.parent_path());
  return path;
}

} // namespace pneuma::pipeline::files
