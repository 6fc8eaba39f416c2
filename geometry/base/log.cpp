// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/base/log.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>

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

namespace {

constexpr const char* marked_variable = "PNEUMA_MARK_PROGRESS";

} // namespace

void Progress::expect_in_pipes() {
  setenv(marked_variable, "1", 1);
}

Progress::Progress()
    : style_(isatty(STDOUT_FILENO) == 1                ? Style::in_place
             : std::getenv(marked_variable) != nullptr ? Style::marked
                                                       : Style::plain) {}

Progress::~Progress() {
  done();
}

void Progress::show(const std::string& line) {
  const double time = now();
  if (time - last_ < (style_ == Style::plain ? 1.0 : 0.1)) return;
  last_ = time;
  switch (style_) {
  case Style::in_place:
    std::fprintf(stdout, "\r\033[K%s", line.c_str());
    std::fflush(stdout);
    open_ = true;
    break;
  case Style::marked:
    say(mark + line);
    break;
  case Style::plain:
    say(line);
    break;
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
