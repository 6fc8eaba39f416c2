// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <stdexcept>
#include <string>

#include "geometry/base/namespace.h"

namespace pneuma::geometry::base {

// Exit codes of every program.
enum class ExitCode : int {
  done = 0,
  bug = 1,
  bad_input = 2,
  bad_state = 3,
  impossible_geometry = 4,
  no_equilibrium = 5,
  machine_refuses = 6,
  interrupted = 130,
};

// What a program tells its user: what is wrong, where, what is allowed, what to do; with the exit code it ends in.
class Error : public std::runtime_error {
public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

private:
  ExitCode code_;
};

// The user's file asks for something wrong or not yet available.
struct InputError : Error {
  explicit InputError(const std::string& message) : Error(ExitCode::bad_input, message) {}
};

// A state file is missing, damaged or foreign.
struct StateError : Error {
  explicit StateError(const std::string& message) : Error(ExitCode::bad_state, message) {}
};

// The shapes asked for cannot be meshed or enclosed.
struct GeometryError : Error {
  explicit GeometryError(const std::string& message) : Error(ExitCode::impossible_geometry, message) {}
};

// Disk, permission, memory or a missing program; says what was tried and what to do.
struct MachineError : Error {
  explicit MachineError(const std::string& message) : Error(ExitCode::machine_refuses, message) {}
};

// Runs `body`; prints what went wrong to standard error and returns the exit code. The boundary of every program.
int guarded_main(const char* program, const std::function<int()>& body);

} // namespace pneuma::geometry::base
