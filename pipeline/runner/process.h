// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

namespace pneuma::pipeline::runner {

// A program started without a shell, in a process group of its own; what it prints (both streams) comes through
// `output`. It dies with the runner, so that no orphan writes into a folder that the next runner uses.
struct Child {
  pid_t pid = -1;
  int output = -1;
};
Child start(const std::filesystem::path& program, const std::vector<std::string>& arguments);

// Sends a signal to the child and all it started.
void send_signal(const Child& child, int number);

bool is_program(const std::filesystem::path& file);

// Throws MachineError where a program cannot be run: what is missing and what to do.
void check_program(const std::filesystem::path& program);

// Waits for the end: the exit code, or 128 + the number of the signal that ended it.
int wait_for(const Child& child);

// While it lives, SIGINT, SIGTERM and SIGHUP do not end this process but can be read from `descriptor`.
class Interrupts {
public:
  Interrupts();
  ~Interrupts();
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;
  int descriptor() const { return descriptor_; }
  int take() const; // number of the signal that arrived

private:
  int descriptor_;
};

// Keeps other runners out of a folder; throws InputError if one is there already.
class FolderLock {
public:
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

private:
  int descriptor_;
};

// The folder of this program, or what PNEUMA_STAGES says: where the stages are.
std::filesystem::path program_folder();

// Replaces this process by the program; returns only to throw.
void become(const std::filesystem::path& program, const std::vector<std::string>& arguments);

} // namespace pneuma::pipeline::runner
