// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/files/file.h"

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

namespace pneuma::pipeline::files {

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

bool write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(fd, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

// What helps against it.
const char* remedy(int error) {
  switch (error) {
  case ENOSPC:
  case EDQUOT:
    return "make room, or choose a folder on another disk";
  case EACCES:
  case EPERM:
  case EROFS:
    return "give yourself the right to it, or choose another folder";
  case ENAMETOOLONG:
    return "choose a shorter name or folder";
  case EMFILE:
  case ENFILE:
    return "close other programs, or raise the limit of open files (ulimit -n)";
  case ENOMEM:
    return "close other programs, or raise the limit of memory (ulimit -v)";
  case EFBIG:
    return "raise the limit of a file's size (ulimit -f)";
  case ELOOP:
    return "a link has its name, and results would lie elsewhere: remove it";
  case EEXIST:
  case ENOTDIR:
    return "a file has the name of a folder: remove it, or choose another name";
  default:
    return "see to it, and run again";
  }
}

// Opens a file of its own at a name: what had the name before is gone, and a link is not followed.
int open_new(const std::filesystem::path& path) {
  ::unlink(path.c_str());
  return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
}

} // namespace

void refuse(const std::filesystem::path& path, std::string_view tried, int error) {
  throw base::MachineError(fmt::format("`{}` {}: {}; {}", path.string(), tried, std::strerror(error), remedy(error)));
}

std::string read_whole(const std::filesystem::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)); // a pipe must not make us wait
  if (file.fd() < 0) refuse(path, "cannot be read", errno);
  struct stat info {};
  if (fstat(file.fd(), &info) != 0) refuse(path, "cannot be read", errno);
  if (!S_ISREG(info.st_mode)) {
    throw base::StateError(
        fmt::format("{}: is {}, not a file", path.string(), S_ISDIR(info.st_mode) ? "a folder" : "a device or a pipe"));
  }
  std::string bytes(static_cast<std::size_t>(info.st_size), '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::read(file.fd(), bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse(path, "cannot be read", errno);
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

PendingFile::PendingFile(const std::filesystem::path& path, std::string_view bytes) : path_(path), pending_(path) {
  pending_ += ".tmp";
  Descriptor file(open_new(pending_));
  if (file.fd() < 0) refuse(path_, "cannot be written", errno);
  if (!write_all(file.fd(), bytes) || fsync(file.fd()) != 0 || !file.close()) {
    const int error = errno;
    ::unlink(pending_.c_str());
    refuse(path_, "cannot be written", error);
  }
}

PendingFile::~PendingFile() {
  if (!pending_.empty()) ::unlink(pending_.c_str());
}

void PendingFile::publish() {
  if (std::rename(pending_.c_str(), path_.c_str()) != 0) refuse(path_, "cannot be replaced", errno);
  pending_.clear();
  // the name, too, must survive a power cut
  const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
  const Descriptor entries(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (entries.fd() < 0 || fsync(entries.fd()) != 0) refuse(folder, "cannot be written", errno);
}

void write_file(const std::filesystem::path& path, std::string_view bytes) {
  PendingFile(path, bytes).publish();
}

GrowingFile::GrowingFile(std::filesystem::path path) : path_(std::move(path)), descriptor_(open_new(path_)) {
  if (descriptor_ < 0) refuse(path_, "cannot be written", errno);
}

GrowingFile::~GrowingFile() {
  ::close(descriptor_);
}

void GrowingFile::add(std::string_view text) {
  if (!write_all(descriptor_, text)) refuse(path_, "cannot be written", errno);
}

void make_folder(const std::filesystem::path& folder, Links links) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) refuse(folder, "cannot be made", failure.value());
  const std::filesystem::path name = folder.has_filename() ? folder : folder.parent_path();
  if (links == Links::refused && std::filesystem::is_symlink(name, failure))
    refuse(folder, "is not written into", ELOOP);
}

} // namespace pneuma::pipeline::files
