// SPDX-License-Identifier: GPL-3.0-or-later
// A run writes below its folder of results and TMPDIR only, starts the stages and nothing else, and talks to nobody.
#include <regex>
#include <set>

#include "tests/workflows/stages/programs.h"

namespace pneuma::tests {
namespace {

using InsideItsFolder = InFolder;

// What a traced call names, as paths from the root.
std::vector<fs::path> paths_in(const std::string& line, const fs::path& from) {
  static const std::regex named("(?:<([^>]*)>, )?\"([^\"]*)\""); // perhaps from an open folder
  std::vector<fs::path> paths;
  for (auto i = std::sregex_iterator(line.begin(), line.end(), named); i != std::sregex_iterator(); ++i) {
    paths.push_back((from / (*i)[1].str() / (*i)[2].str()).lexically_normal());
  }
  return paths;
}

bool is_below(const fs::path& path, const fs::path& folder) {
  const auto relative = path.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != "..";
}

TEST_F(InsideItsFolder, AWholeRunStays) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "a traced program cannot look for its leaks";
#endif
  const fs::path temporary = folder / "tmp", trace = folder / "trace";
  fs::create_directory(temporary);
  if (call("strace -o /dev/null true").code != 0) GTEST_SKIP() << "strace is missing, or ptrace is forbidden here";
  std::string free_mesh = every_stage; // by gmsh
  free_mesh.replace(free_mesh.find("size: 0.25 m"), 12, "size: 0.25 m, pattern: unstructured");
  write(free_mesh);
  const Outcome run = call(
      "cd " + folder.string() + " && TMPDIR=" + temporary.string() +
      " strace -f -qq -y -o trace -e trace=open,openat,creat,mkdir,mkdirat,unlink,unlinkat,rename,renameat,renameat2,"
      "link,linkat,symlink,symlinkat,truncate,chmod,socket,connect,execve " +
      (programs / "pneuma").string() + " run w.yaml");
  ASSERT_EQ(run.code, 0) << run.text;
  std::set<std::string> started;
  std::size_t written = 0;
  std::ifstream lines(trace);
  for (std::string line; std::getline(lines, line);) {
    if (line.find(" = -1 ") != std::string::npos) continue;
    const std::size_t name = line.find_first_not_of("0123456789 ");
    const std::string call = line.substr(name, line.find('(') - name);
    const std::vector<fs::path> paths = paths_in(line, folder);
    EXPECT_NE(call, "socket") << line;
    EXPECT_NE(call, "connect") << line;
    if (call == "execve") {
      EXPECT_EQ(paths.front().parent_path(), programs) << line;
      started.insert(paths.front().filename());
      continue;
    }
    const bool opens = call == "open" || call == "openat";
    const bool writes = line.find("O_WRONLY") != std::string::npos || line.find("O_RDWR") != std::string::npos ||
                        line.find("O_CREAT") != std::string::npos;
    if (paths.empty() || (opens && !writes)) continue;
    for (const fs::path& path : paths) {
      if (path == "/dev/null") continue;
      ++written;
      EXPECT_TRUE(is_below(path, folder / "out") || is_below(path, temporary)) << line;
    }
  }
  EXPECT_GT(written, 30U);
  const std::set<std::string> expected = {"pneuma",         "pneuma-mesh",    "pneuma-formfind",
                                          "pneuma-pattern", "pneuma-inflate", "pneuma-wind"};
  EXPECT_EQ(started, expected);
  EXPECT_TRUE(fs::is_empty(temporary));
}

} // namespace
} // namespace pneuma::tests
