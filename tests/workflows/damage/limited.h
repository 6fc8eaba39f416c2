// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pneuma::tests::damage {

// How a program ended.
struct Ending {
  int code = -1;  // exit code; -1: it did not exit by itself
  int signal = 0; // that ended it
  bool hung = false;
  std::string text; // both streams, the first megabyte

  std::string words() const; // "exit code 2", "ended by signal 11 (...)", "did not end"
};

struct Limits {
  int seconds = 10;     // of processor time: how busy the machine is does not count
  double gigabytes = 2; // of address space; not under a sanitizer, which takes terabytes
};

// Runs a program in a folder, with limits, and waits for it. May be called from several threads.
Ending run_limited(const std::vector<std::string>& words, const std::filesystem::path& folder,
                   const Limits& limits = {});

} // namespace pneuma::tests::damage
