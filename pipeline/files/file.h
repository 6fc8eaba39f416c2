// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace pneuma::pipeline::files {

// Throws MachineError for what the system refused (`error`: its errno): what was tried, why not, and what to do.
[[noreturn]] void refuse(const std::filesystem::path& path, std::string_view tried, int error);

// The bytes of a file. Throws StateError where it is none (a folder, a pipe), MachineError with the system's reason.
std::string read_whole(const std::filesystem::path& path);

// A file beside its final name, complete and on the disk; it takes the name with `publish` or vanishes. A link of the
// name is replaced, never followed. Both throw MachineError, e.g. of a full disk.
class PendingFile {
public:
  PendingFile(const std::filesystem::path& path, std::string_view bytes);
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;
  ~PendingFile();
  void publish(); // atomic and durable

private:
  std::filesystem::path path_;
  std::filesystem::path pending_;
};

// Whole or not at all.
void write_file(const std::filesystem::path& path, std::string_view bytes);

// A file that grows while others read it, as a log does: begun anew, every addition written at once. Throws
// MachineError.
class GrowingFile {
public:
  explicit GrowingFile(std::filesystem::path path);
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;
  ~GrowingFile();
  void add(std::string_view text);

private:
  std::filesystem::path path_;
  int descriptor_;
};

// A folder, and those around it where they are missing. `refused`: where a link has its name, as what is written into
// it would lie elsewhere. Throws MachineError.
enum class Links : std::uint8_t { followed, refused };
void make_folder(const std::filesystem::path& folder, Links links = Links::refused);

} // namespace pneuma::pipeline::files
