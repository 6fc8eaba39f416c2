// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/blas.h"

#include <array>
#include <cstring>
#include <new>
#include <vector>

#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

extern "C" {
void openblas_set_num_threads(int threads);
// of OpenBLAS alone: the work space of one caller, and its return to those that are kept for the next
void* blas_memory_alloc(int procedure) __attribute__((weak));
void blas_memory_free(void* space) __attribute__((weak));
}

namespace pneuma::solver::linear {

namespace {

constexpr std::size_t work_space = std::size_t{1}
                                   << 27; // bytes, of a caller: what Debian's OpenBLAS maps, seen by strace

// Whether that much memory is to be had now.
bool is_available(std::size_t bytes) {
  void* const found = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (found == MAP_FAILED) return false;
  munmap(found, bytes);
  return true;
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

bool is_limited() {
  for (const auto what : {RLIMIT_AS, RLIMIT_DATA}) {
    rlimit now{};
    if (getrlimit(what, &now) == 0 && now.rlim_cur != RLIM_INFINITY) return true;
  }
  return false;
}

// OpenBLAS starts its threads as it is loaded, each with a work space, for which it asks for ever where memory is
// limited; libgomp ends the process. A variable must keep them from it, set before any library begins: so the program
// begins again, once.
void begin_with_single_threads(int, char** arguments, char** environment) {
  constexpr std::array single = {"OPENBLAS_NUM_THREADS=1", "OMP_THREAD_LIMIT=1"};
  constexpr std::size_t most = 4000; // variables; nothing is allocated yet
  static const char* variables[most];
  if (!is_limited()) return;
  std::size_t count = 0, known = 0;
  for (char** one = environment; *one != nullptr; ++one) {
    bool is_ours = false;
    for (const char* wanted : single) {
      is_ours = is_ours || std::strncmp(*one, wanted, std::strlen(wanted) - 1) == 0;
      if (std::strcmp(*one, wanted) == 0) ++known;
    }
    if (count + single.size() + 1 == most) return;
    if (!is_ours) variables[count++] = *one;
  }
  if (known == single.size()) return;
  for (const char* one : single) variables[count++] = one;
  variables[count] = nullptr;
  static char program[4096];
  if (readlink("/proc/self/exe", program, sizeof program - 1) > 0) {
    execve(program, arguments, const_cast<char* const*>(variables));
  }
}

using Start = void (*)(int, char**, char**);
__attribute__((section(".preinit_array"), used)) const Start before_all_libraries = begin_with_single_threads;

#endif

} // namespace

void prepare_blas(int threads) {
  openblas_set_num_threads(1);
  if (blas_memory_alloc == nullptr || blas_memory_free == nullptr) return; // another BLAS
  const auto callers = static_cast<std::size_t>(threads);
  if (!is_available(callers * work_space)) throw std::bad_alloc();
  std::vector<void*> spaces(callers);
  for (void*& space : spaces) space = blas_memory_alloc(0);
  for (void* space : spaces) blas_memory_free(space);
}

} // namespace pneuma::solver::linear
