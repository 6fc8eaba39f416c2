// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/state/trial.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

namespace pneuma::pipeline::state {

namespace {

// Address space of this process now, bytes.
std::size_t address_space() {
  unsigned long pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%lu", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

// Only lowers a limit: raising it needs rights.
void limit(__rlimit_resource_t what, rlim_t most) {
  rlimit now{};
  if (getrlimit(what, &now) != 0) return;
  now.rlim_cur = std::min(most, now.rlim_max);
  now.rlim_max = now.rlim_cur;
  setrlimit(what, &now);
}

// Crashes must look like crashes to the parent, whatever handlers this program has.
void restore_signals() {
  for (const int signal : {SIGABRT, SIGALRM, SIGBUS, SIGFPE, SIGILL, SIGINT, SIGSEGV, SIGTERM}) {
    std::signal(signal, SIG_DFL);
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

[[noreturn]] void child(const std::function<void()>& work, unsigned seconds, std::size_t memory, int out) {
  restore_signals();
  const int silent = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (silent >= 0) dup2(silent, STDERR_FILENO);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_AS, memory);
  alarm(seconds);
  std::string reason;
  try {
    work();
    _exit(0);
  } catch (const std::exception& error) {
    reason = error.what();
  }
  const ssize_t written = ::write(out, reason.data(), std::min<std::size_t>(reason.size(), PIPE_BUF));
  _exit(written < 0 ? 2 : 1);
}

std::string read_all(int in) {
  std::string text;
  std::array<char, PIPE_BUF> buffer{};
  while (true) {
    const ssize_t count = ::read(in, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

} // namespace

std::string try_in_child(const std::function<void()>& work, unsigned seconds, std::size_t bytes) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    return fmt::format("no pipe to a child process: {}", std::strerror(errno));
  }
  const std::size_t memory = address_space() + bytes;
  const pid_t id = fork();
  if (id == 0) child(work, seconds, memory, ends[1]);
  const int fork_error = errno;
  close(ends[1]);
  std::string reason = id > 0 ? read_all(ends[0]) : "";
  close(ends[0]);
  if (id < 0) return fmt::format("no child process: {}", std::strerror(fork_error));
  int status = 0;
  while (waitpid(id, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  if (!reason.empty()) return reason;
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM) {
    return fmt::format("reading did not end within {} s", seconds);
  }
  return "reading crashed";
}

} // namespace pneuma::pipeline::state
