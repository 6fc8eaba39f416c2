// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/workflows/damage/limited.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace pneuma::tests::damage {

namespace {

void limit(int resource, rlim_t most) {
  rlimit both{};
  both.rlim_cur = both.rlim_max = most;
  setrlimit(static_cast<__rlimit_resource_t>(resource), &both);
}

} // namespace

std::string Ending::words() const {
  if (hung) return "did not end in time";
  if (signal != 0) return fmt::format("ended by signal {} ({})", signal, strsignal(signal));
  return fmt::format("exit code {}", code);
}

Ending run_limited(const std::vector<std::string>& words, const std::filesystem::path& folder, const Limits& limits) {
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str())); // as execv has it
  argv.push_back(nullptr);
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error(std::strerror(errno));
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(std::strerror(errno));
  if (child == 0) { // only what a signal handler may do: the parent has threads
    setpgid(0, 0);
    dup2(ends[1], 1);
    dup2(ends[1], 2);
#ifndef __SANITIZE_ADDRESS__
    limit(RLIMIT_AS, static_cast<rlim_t>(limits.gigabytes * (1 << 30)));
#endif
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, static_cast<rlim_t>(limits.seconds));
    if (chdir(folder.c_str()) == 0) execv(argv[0], argv.data());
    _exit(127);
  }
  close(ends[1]);

  Ending ending;
  // a program that waits for what never comes takes no processor time
  const auto last = std::chrono::steady_clock::now() + std::chrono::minutes(10);
  constexpr std::size_t enough = 1 << 20;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(last - std::chrono::steady_clock::now());
    pollfd wait{ends[0], POLLIN, 0};
    const int ready = left.count() > 0 ? poll(&wait, 1, static_cast<int>(left.count())) : 0;
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) {
      ending.hung = true;
      kill(-child, SIGKILL);
      break;
    }
    std::array<char, 4096> buffer{};
    const ssize_t got = read(ends[0], buffer.data(), buffer.size());
    if (got <= 0) break;
    if (ending.text.size() < enough) ending.text.append(buffer.data(), static_cast<std::size_t>(got));
  }
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (WIFEXITED(status)) ending.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) ending.signal = WTERMSIG(status);
  ending.hung = ending.hung || ending.signal == SIGKILL || ending.signal == SIGXCPU;
  return ending;
}

} // namespace pneuma::tests::damage
