// SPDX-License-Identifier: GPL-3.0-or-later
// The agreed house: who may include whom, foreign libraries behind few files, what each folder must have.
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/places.h"

namespace {

namespace fs = std::filesystem;

const fs::path top = pneuma::tests::source_folder;
const std::vector<std::string> source_folders = {"geometry", "solver", "pipeline", "stages"};

struct Source {
  std::string path; // from the top
  std::string text;
};

std::vector<Source> sources(const std::vector<std::string>& folders) {
  std::vector<Source> found;
  for (const std::string& folder : folders) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(top / folder)) {
      const std::string extension = entry.path().extension();
      if (extension != ".h" && extension != ".cpp") continue;
      std::ostringstream text;
      text << std::ifstream(entry.path()).rdbuf();
      found.push_back({fs::relative(entry.path(), top).generic_string(), text.str()});
    }
  }
  return found;
}

std::vector<std::string> includes(const std::string& text, const char* open, const char* close) {
  const std::regex pattern("#include " + std::string(open) + "([^\"<>]+)" + close);
  std::vector<std::string> result;
  for (auto i = std::sregex_iterator(text.begin(), text.end(), pattern); i != std::sregex_iterator(); ++i) {
    result.push_back((*i)[1]);
  }
  return result;
}

bool in(const std::string& path, const std::string& folder) {
  return path.rfind(folder + "/", 0) == 0;
}

// geometry/base <- geometry <- {solver, pipeline} <- stages/common <- one stage
bool allowed(const std::string& from, const std::string& to) {
  if (in(from, "geometry/base")) return in(to, "geometry/base");
  if (in(from, "geometry/meshing") || in(from, "geometry/strips")) return in(to, "geometry");
  if (in(from, "geometry")) return in(to, "geometry") && !in(to, "geometry/meshing");
  if (in(from, "solver")) return in(to, "geometry") || in(to, "solver");
  if (in(from, "pipeline")) return in(to, "geometry") || in(to, "pipeline");
  if (in(from, "stages/common"))
    return in(to, "geometry") || in(to, "solver") || in(to, "pipeline") || in(to, "stages/common");
  if (in(from, "stages")) {
    const std::string own = from.substr(0, from.find('/', std::string("stages/").size()));
    return allowed("stages/common/x", to) || in(to, own);
  }
  return false;
}

TEST(House, IncludesRunInTheAgreedDirectionOnly) {
  for (const Source& source : sources(source_folders)) {
    for (const std::string& included : includes(source.text, "\"", "\"")) {
      EXPECT_TRUE(allowed(source.path, included)) << source.path << " includes " << included;
    }
  }
}

TEST(House, TheDirectionCheckSeesForbiddenIncludes) {
  EXPECT_FALSE(allowed("geometry/mesh.h", "solver/path/newton.h"));
  EXPECT_FALSE(allowed("geometry/base/types.h", "geometry/mesh.h"));
  EXPECT_FALSE(allowed("solver/path/newton.h", "pipeline/state/state.h"));
  EXPECT_FALSE(allowed("pipeline/state/state.h", "solver/path/newton.h"));
  EXPECT_FALSE(allowed("pipeline/runner/main.cpp", "stages/common/stage.h"));
  EXPECT_FALSE(allowed("stages/wind/main.cpp", "stages/inflate/main.h"));
  EXPECT_FALSE(allowed("stages/common/stage.h", "stages/wind/x.h"));
  EXPECT_FALSE(allowed("geometry/volume.cpp", "geometry/meshing/plan_mesh.h"));
  EXPECT_TRUE(allowed("stages/formfind/main.cpp", "stages/formfind/self_check.h"));
}

TEST(House, ForeignLibrariesStayBehindOneOrTwoFilesAndInNoHeader) {
  const std::map<std::string, std::regex> foreign = {
      {"gmsh", std::regex("gmsh.*")},       {"CGAL", std::regex("CGAL/.*")},
      {"CHOLMOD", std::regex("cholmod.*")}, {"MUMPS", std::regex(".*mumps.*")},
      {"HDF5", std::regex("hdf5.*")},       {"yaml-cpp", std::regex("yaml-cpp/.*")},
      {"VTK", std::regex("vtk.*")},         {"UDUNITS", std::regex("udunits.*")},
      {"dxflib", std::regex("dxflib/.*")},  {"OpenSSL", std::regex("openssl/.*")},
      {"EGL", std::regex("EGL/.*")}};
  std::map<std::string, std::set<std::string>> users;
  for (const Source& source : sources(source_folders)) {
    for (const std::string& included : includes(source.text, "<", ">")) {
      for (const auto& [name, pattern] : foreign) {
        if (std::regex_match(included, pattern)) users[name].insert(source.path);
      }
    }
  }
  EXPECT_FALSE(users.empty());
  for (const auto& [name, files] : users) {
    EXPECT_LE(files.size(), 2u) << name;
    for (const std::string& file : files) EXPECT_EQ(fs::path(file).extension(), ".cpp") << name << " in " << file;
  }
}

TEST(House, EveryFolderExplainsItself) {
  for (const char* folder : {"geometry", "solver", "pipeline", "stages", "configs", "tests", "projects"}) {
    EXPECT_TRUE(fs::exists(top / folder / "README.md")) << folder;
    for (auto entry = fs::recursive_directory_iterator(top / folder); entry != fs::recursive_directory_iterator();
         ++entry) {
      if (!entry->is_directory()) continue;
      const std::string name = entry->path().filename();
      if (name == "cmake" || name == "out" || name.starts_with(".") || name == "__pycache__") { // of the build, or made
        entry.disable_recursion_pending();
        continue;
      }
      EXPECT_TRUE(fs::is_empty(entry->path()) || fs::exists(entry->path() / "README.md")) << entry->path();
    }
  }
}

TEST(House, EverySourceNamesItsLicenceAndKeepsItsNamespace) {
  for (const Source& source : sources(source_folders)) {
    EXPECT_EQ(source.text.rfind("// SPDX-License-Identifier: GPL-3.0-or-later\n", 0), 0u) << source.path;
    std::string expected = "namespace pneuma::" + fs::path(source.path).parent_path().generic_string();
    for (std::size_t at = 0; (at = expected.find('/')) != std::string::npos;) expected.replace(at, 1, "::");
    EXPECT_NE(source.text.find(expected), std::string::npos) << source.path << " is not in " << expected;
  }
}

} // namespace
