// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/base/errors.h"

#include <cstdio>
#include <exception>

namespace pneuma::geometry::base {

int guarded_main(const char* program, int (*body)(int, char**), int argc, char** argv) {
  try {
    return body(argc, argv);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.code());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: internal error, please report it: %s\n", program, error.what());
    return static_cast<int>(ExitCode::bug);
  }
}

} // namespace pneuma::geometry::base
