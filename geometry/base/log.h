// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "geometry/base/namespace.h"

namespace pneuma::geometry::base {

// One plain line to standard output, flushed, so that a runner reading the pipe sees it at once.
void say(const std::string& line);

// One line to standard error, marked as a warning.
void warn(const std::string& line);

// Progress of a long computation. On a terminal the line is rewritten in place, at most ten times a second; elsewhere
// it is printed plainly, at most once a second. A program whose output goes through a pipe to one that has a terminal
// (the runner) marks its progress, so that the other can rewrite it in place.
class Progress {
public:
  static constexpr char mark = '\r'; // a marked line begins with it
  static void expect_in_pipes();     // programs started from now on mark their progress

  Progress();
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void show(const std::string& line);
  void done(); // ends the rewritten line

private:
  enum class Style : unsigned char { in_place, marked, plain };
  Style style_;
  bool open_ = false;
  double last_ = -1e9; // s, when a line was last shown
};

} // namespace pneuma::geometry::base
