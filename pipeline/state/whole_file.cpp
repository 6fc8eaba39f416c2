// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/state/whole_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "geometry/base/errors.h"
#include "geometry/base/types.h"

namespace pneuma::pipeline::state {

namespace {

// An open file; -1: not opened.
class Descriptor {
public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  int fd() const { return fd_; }
  bool close() { return ::close(std::exchange(fd_, -1)) == 0; }

private:
  int fd_;
};

[[noreturn]] void fail(const std::filesystem::path& path, const char* what, int error) {
  throw base::StateError(fmt::format("{}: {}: {}", path.string(), what, std::strerror(error)));
}

bool write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(fd, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

} // namespace

std::string read_whole(const std::filesystem::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)); // a pipe must not make us wait
  if (file.fd() < 0) fail(path, "cannot be read", errno);
  struct stat info {};
  if (fstat(file.fd(), &info) != 0) fail(path, "cannot be read", errno);
  if (!S_ISREG(info.st_mode)) {
    throw base::StateError(
        fmt::format("{}: is {}, not a file", path.string(), S_ISDIR(info.st_mode) ? "a folder" : "a device or a pipe"));
  }
  std::string bytes(static_cast<std::size_t>(info.st_size), '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::read(file.fd(), bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(path, "cannot be read", errno);
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

PendingFile::PendingFile(const std::filesystem::path& path, std::string_view bytes) : path_(path), pending_(path) {
  pending_ += ".tmp";
  Descriptor file(::open(pending_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (file.fd() < 0) fail(path_, "cannot be written", errno);
  if (!write_all(file.fd(), bytes) || fsync(file.fd()) != 0 || !file.close()) {
    const int error = errno;
    ::unlink(pending_.c_str());
    fail(path_, "cannot be written", error);
  }
}

PendingFile::~PendingFile() {
  if (!pending_.empty()) ::unlink(pending_.c_str());
}

void PendingFile::publish() {
  if (std::rename(pending_.c_str(), path_.c_str()) != 0) fail(path_, "cannot be replaced", errno);
  pending_.clear();
  // the name, too, must survive a power cut
  const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
  const Descriptor entries(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (entries.fd() < 0 || fsync(entries.fd()) != 0) fail(folder, "cannot be written", errno);
}

} // namespace pneuma::pipeline::state
