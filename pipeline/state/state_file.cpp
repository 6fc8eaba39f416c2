// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/state/state_file.h"

#include <stdexcept>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "pipeline/digest/digest.h"
#include "pipeline/files/file.h"
#include "pipeline/state/check.h"
#include "pipeline/state/hdf5.h"
#include "pipeline/state/layout.h"
#include "pipeline/state/trial.h"

namespace pneuma::pipeline::state {

namespace {

namespace fs = std::filesystem;

constexpr const char* remedy = "run the stage that writes it again";

[[noreturn]] void refuse(const fs::path& path, const std::string& why) {
  throw base::StateError(fmt::format("{}: {}; {}", path.string(), why, remedy));
}

fs::path digest_path(const fs::path& path) {
  fs::path digest = path;
  digest += ".sha256";
  return digest;
}

// The last line of every state file: what was written, so that a flipped bit of a value shows even where the digest
// beside the file was lost. HDF5 does not look at what follows its own end of file.
std::string seal_of(std::string_view bytes) {
  return "\nsha256 " + digest::sha256_of_text(bytes) + "\n";
}

bool is_sealed(std::string_view bytes) {
  const std::size_t length = seal_of("").size();
  if (bytes.size() < length) return false;
  return bytes.substr(bytes.size() - length) == seal_of(bytes.substr(0, bytes.size() - length));
}

bool is_there(const fs::path& path) {
  std::error_code ignored; // reading it will say more
  return fs::exists(path, ignored);
}

// A digest beside the file that says something else: damaged since, or killed between digest and state.
void verify_digest(const fs::path& path, const std::string& bytes) {
  constexpr std::size_t digits = 64;
  const std::string said = files::read_whole(digest_path(path)).substr(0, digits);
  if (said != digest::sha256_of_text(bytes)) {
    refuse(path, "does not match its digest " + digest_path(path).filename().string() +
                     ": damaged, or its stage did not finish");
  }
}

// Without a digest nobody vouches for the bytes, and libhdf5 may crash or hang on them.
void try_first(const fs::path& path, const std::string& bytes) {
  constexpr std::size_t bytes_per_second = 20'000'000;
  constexpr std::size_t room = 256'000'000;
  const auto seconds = static_cast<unsigned>(5 + bytes.size() / bytes_per_second);
  const std::string fault = try_in_child([&] { from_bytes(bytes); }, seconds, room + 8 * bytes.size());
  if (!fault.empty()) refuse(path, "is damaged or no state of Pneuma: " + fault);
}

} // namespace

void write_state(const State& state, const fs::path& path) {
  const std::string fault = first_fault(state);
  if (!fault.empty()) {
    throw base::Error(base::ExitCode::bug,
                      fmt::format("{}: not written, the state is wrong: {}", path.string(), fault));
  }
  std::string bytes;
  try {
    bytes = to_bytes(state);
    bytes += seal_of(bytes);
  } catch (const std::invalid_argument& wrong) {
    throw base::Error(base::ExitCode::bug, fmt::format("{}: not written: {}", path.string(), wrong.what()));
  } catch (const hdf5::Failure& failure) { // in memory, so for want of it
    throw base::MachineError(fmt::format("`{}` cannot be written: {}; close other programs, or raise the limit of "
                                         "memory (ulimit -v)",
                                         path.string(), failure.what()));
  }
  std::error_code ignored;
  if (fs::is_directory(path, ignored))
    throw base::StateError(fmt::format("{}: is a folder, not a file", path.string()));
  // the line of sha256sum, so that `sha256sum -c` checks it
  const std::string line = digest::sha256_of_text(bytes) + "  " + path.filename().string() + "\n";
  files::PendingFile pending_digest(digest_path(path), line);
  files::PendingFile pending_state(path, bytes);
  pending_digest.publish();
  pending_state.publish();
}

void write_state(const State& state, files::Outputs& outputs, const std::string& name) {
  outputs.file(name + ".sha256");
  write_state(state, outputs.file(name));
}

State read_state(const fs::path& path) {
  if (!is_there(path)) refuse(path, "does not exist");
  const std::string bytes = files::read_whole(path);
  if (!bytes.starts_with("\x89HDF\r\n\x1a\n")) {
    throw base::StateError(fmt::format(
        "{}: is not a state file (it is no HDF5 file); give the .hdf file that a stage wrote", path.string()));
  }
  if (is_there(digest_path(path))) {
    verify_digest(path, bytes);
  } else {
    try_first(path, bytes);
  }
  if (!is_sealed(bytes)) refuse(path, "is damaged: its content is not what its stage wrote");
  try {
    return from_bytes(bytes);
  } catch (const hdf5::Failure& failure) {
    refuse(path, std::string("cannot be used: ") + failure.what());
  }
}

} // namespace pneuma::pipeline::state
