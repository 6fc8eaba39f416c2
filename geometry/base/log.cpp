// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/base/log.h"

#include <chrono>
#include <cstdio>

#include <unistd.h>

namespace pneuma::geometry::base {

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

} // namespace

void say(const std::string& line) {
  std::fprintf(stdout, "%s\n", line.c_str());
  std::fflush(stdout);
}

void warn(const std::string& line) {
  std::fflush(stdout);
  std::fprintf(stderr, "warning: %s\n", line.c_str());
}

Progress::Progress() : terminal_(isatty(STDOUT_FILENO) == 1) {}

Progress::~Progress() {
  done();
}

void Progress::show(const std::string& line) {
  const double time = now();
  if (time - last_ < (terminal_ ? 0.1 : 1.0)) return;
  last_ = time;
  if (terminal_) {
    std::fprintf(stdout, "\r\033[K%s", line.c_str());
    std::fflush(stdout);
    open_ = true;
  } else {
    say(line);
  }
}

void Progress::done() {
  if (open_) {
    std::fprintf(stdout, "\r\033[K");
    std::fflush(stdout);
  }
  open_ = false;
}

} // namespace pneuma::geometry::base
