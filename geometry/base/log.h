// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace pneuma::geometry::base {

// One plain line to standard output, flushed, so that a runner reading the pipe sees it at once.
void say(const std::string& line);

// One line to standard error, marked as a warning.
void warn(const std::string& line);

// Progress of a long computation: on a terminal the line is rewritten in place at most ten times a second, elsewhere
// it is printed plainly at most once a second. `done` ends the rewritten line.
class Progress {
public:
  Progress();
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void show(const std::string& line);
  void done();

private:
  bool terminal_;
  bool open_ = false;
  double last_ = -1e9; // s, when a line was last shown
};

} // namespace pneuma::geometry::base
