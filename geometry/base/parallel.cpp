// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace pneuma::geometry::base {

void parallel_chunks(int threads, std::size_t chunks, const std::function<void(std::size_t)>& work) {
  const std::size_t workers = std::min(static_cast<std::size_t>(std::max(threads, 1)), chunks);
  if (workers <= 1) {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) work(chunk);
    return;
  }
  std::vector<std::exception_ptr> failed(chunks);
  std::atomic<std::size_t> next{0};
  const auto loop = [&] {
    for (std::size_t chunk = next++; chunk < chunks; chunk = next++) {
      try {
        work(chunk);
      } catch (...) {
        failed[chunk] = std::current_exception();
      }
    }
  };
  {
    std::vector<std::jthread> pool;
    for (std::size_t i = 1; i < workers; ++i) pool.emplace_back(loop);
    loop();
  }
  for (const std::exception_ptr& error : failed) {
    if (error) std::rethrow_exception(error);
  }
}

} // namespace pneuma::geometry::base
