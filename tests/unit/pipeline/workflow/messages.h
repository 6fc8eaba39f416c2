// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <ostream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/unit/pipeline/workflow/example.h"

namespace pneuma::pipeline::workflow {

// What is changed in the example, and the messages in the order of the file. `@` marks the place of each message.
struct Bad {
  const char* claim;
  const char* before;
  const char* after;
  std::vector<const char*> messages;
};

inline std::ostream& operator<<(std::ostream& out, const Bad& bad) {
  return out << bad.claim;
}

// Takes the marks out of the text; each becomes "line:column".
inline std::vector<std::string> take_places(std::string& text) {
  std::vector<std::string> places;
  std::string clean;
  int line = 1, column = 1;
  for (const char c : text) {
    if (c == '@') {
      places.push_back(std::to_string(line) + ":" + std::to_string(column));
      continue;
    }
    clean += c;
    column = c == '\n' ? 1 : column + 1;
    line += c == '\n' ? 1 : 0;
  }
  text = clean;
  return places;
}

// The example with a part changed has these faults in the order of the file, `@` in it marks the place of each;
// `others` are files beside it.
inline void expect_messages(const std::string& before, const std::string& after,
                            const std::vector<const char*>& messages,
                            const std::map<std::string, std::string>& others = {}) {
  std::string text = replaced(example, before, after);
  const std::vector<std::string> places = take_places(text);
  ASSERT_EQ(places.size(), messages.size());
  const Folder folder;
  for (const auto& [name, content] : others) folder.write(name, content);
  const ReadResult result = read_workflow(folder.write("w.yaml", text));
  std::string told;
  for (const Problem& problem : result.problems) told += to_string(problem) + "\n";
  ASSERT_EQ(result.problems.size(), places.size()) << told;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Problem& problem = result.problems[i];
    EXPECT_EQ(std::to_string(problem.mark.line) + ":" + std::to_string(problem.mark.column), places[i]) << told;
    EXPECT_THAT(to_string(problem), testing::HasSubstr(messages[i]));
    EXPECT_TRUE(problem.error);
  }
}

} // namespace pneuma::pipeline::workflow
