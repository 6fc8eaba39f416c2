// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pneuma::pipeline::state {

// The bytes of a file; StateError with the system's reason.
std::string read_whole(const std::filesystem::path& path);

// A file beside its final name, complete and on the disk; it takes the name with `publish` or vanishes.
class PendingFile {
public:
  PendingFile(const std::filesystem::path& path, std::string_view bytes); // StateError, e.g. a full disk
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;
  ~PendingFile();
  void publish(); // atomic and durable; StateError

private:
  std::filesystem::path path_;
  std::filesystem::path pending_;
};

} // namespace pneuma::pipeline::state
