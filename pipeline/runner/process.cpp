// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/runner/process.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include "geometry/base/errors.h"
#include "pipeline/files/file.h"

namespace pneuma::pipeline::runner {

namespace {

sigset_t interrupting() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  struct sigaction hang_up {};
  sigaction(SIGHUP, nullptr, &hang_up);
  if (hang_up.sa_handler != SIG_IGN) sigaddset(&set, SIGHUP); // nohup: goes on without its terminal
  return set;
}

std::vector<char*> argument_pointers(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

[[noreturn]] void throw_system(const std::string& what) {
  throw base::MachineError(fmt::format("{}: {}; close other programs, or see to it", what, std::strerror(errno)));
}

} // namespace

Child start(const std::filesystem::path& program, const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers = argument_pointers(words);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw_system("no pipe for a stage");
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  const pid_t runner = getpid();
  const pid_t pid = fork();
  if (pid < 0) throw_system("no process for a stage");
  if (pid == 0) {
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != runner) _exit(127);
    // a runner started in the background may have been told to ignore them
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
    const sigset_t set = interrupting();
    sigprocmask(SIG_UNBLOCK, &set, nullptr);
    setenv("OPENBLAS_NUM_THREADS", "1", 1); // its threads would only wait, and reserve memory
    dup2(nothing, STDIN_FILENO);
    dup2(ends[1], STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    execv(pointers[0], pointers.data());
    dprintf(STDERR_FILENO, "%s cannot be started: %s\n", pointers[0], std::strerror(errno));
    _exit(127);
  }
  setpgid(pid, pid); // here too: a signal may come before the child gets to it
  close(ends[1]);
  if (nothing >= 0) close(nothing);
  return {pid, ends[0]};
}

bool is_program(const std::filesystem::path& file) {
  return access(file.c_str(), X_OK) == 0;
}

void check_program(const std::filesystem::path& program) {
  if (is_program(program)) return;
  throw base::MachineError(fmt::format("the program `{}` cannot be run: {}; build it with ./pipeline/run, or let "
                                       "PNEUMA_STAGES name the folder that has it",
                                       program.string(), std::strerror(errno)));
}

void send_signal(const Child& child, int number) {
  if (child.pid > 0) kill(-child.pid, number);
}

int wait_for(const Child& child) {
  int status = 0;
  while (waitpid(child.pid, &status, 0) < 0) {
    if (errno != EINTR) throw_system("a stage is lost");
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

Interrupts::Interrupts() {
  const sigset_t set = interrupting();
  sigprocmask(SIG_BLOCK, &set, nullptr);
  descriptor_ = signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
  if (descriptor_ < 0) throw_system("signals cannot be watched");
}

Interrupts::~Interrupts() {
  close(descriptor_);
  const sigset_t set = interrupting();
  sigprocmask(SIG_UNBLOCK, &set, nullptr);
}

int Interrupts::take() const {
  signalfd_siginfo info{};
  return read(descriptor_, &info, sizeof info) == sizeof info ? static_cast<int>(info.ssi_signo) : 0;
}

FolderLock::FolderLock(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / ".lock";
  descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor_ < 0) files::refuse(file, "cannot be written", errno);
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    close(descriptor_);
    throw base::InputError(fmt::format(
        "another pneuma works in `{}`; wait for it to end, or choose another folder with --out", folder.string()));
  }
}

FolderLock::~FolderLock() {
  close(descriptor_);
}

std::filesystem::path program_folder() {
  if (const char* folder = std::getenv("PNEUMA_STAGES"); folder != nullptr && *folder != '\0') return folder;
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

void become(const std::filesystem::path& program, const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers = argument_pointers(words);
  execv(pointers[0], pointers.data());
  throw_system(program.string() + " cannot be started");
}

} // namespace pneuma::pipeline::runner
