// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/base/errors.h"

#include <cstdio>
#include <exception>
#include <new>
#include <system_error>

#include <fcntl.h>

namespace pneuma::geometry::base {

namespace {

// One that the caller closed would otherwise be the number of the next file, and what is said go into it.
void open_standard_streams() {
  for (int stream = 0; stream <= 2; ++stream) {
    if (fcntl(stream, F_GETFD) < 0) static_cast<void>(open("/dev/null", O_RDWR)); // takes the lowest free number
  }
}

} // namespace

int guarded_main(const char* program, const std::function<int()>& body) {
  open_standard_streams();
  try {
    return body();
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.code());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr,
                 "%s: the memory does not suffice; close other programs, raise the limit (ulimit -v), or take larger "
                 "elements\n",
                 program);
    return static_cast<int>(ExitCode::machine_refuses);
  } catch (const std::system_error& error) {
    std::fprintf(stderr, "%s: the system refuses: %s; see to it, and run again\n", program, error.what());
    return static_cast<int>(ExitCode::machine_refuses);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: internal error, please report it: %s\n", program, error.what());
    return static_cast<int>(ExitCode::bug);
  }
}

} // namespace pneuma::geometry::base
