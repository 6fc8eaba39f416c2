// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace pneuma::pipeline::workflow {

// Circles among names of which each leads to one other (`next`, or to none of them), each from its first name in the
// order back to it.
inline std::vector<std::vector<std::string>> circles(const std::vector<std::string>& order,
                                                     const std::map<std::string, std::string>& next) {
  std::map<std::string, std::size_t> position, visit; // by which start a name was come to, from 1
  for (std::size_t i = 0; i < order.size(); ++i) position.emplace(order[i], i);
  std::vector<std::vector<std::string>> found;
  for (std::size_t start = 1; start <= order.size(); ++start) {
    std::vector<std::string> chain;
    std::string at = order[start - 1];
    for (; position.contains(at) && visit[at] == 0; at = next.contains(at) ? next.at(at) : "") {
      visit[at] = start;
      chain.push_back(at);
    }
    if (!position.contains(at) || visit[at] != start) continue;
    std::vector<std::string> circle(std::find(chain.begin(), chain.end(), at), chain.end());
    const auto earlier = [&](const auto& a, const auto& b) { return position.at(a) < position.at(b); };
    std::rotate(circle.begin(), std::min_element(circle.begin(), circle.end(), earlier), circle.end());
    circle.push_back(circle.front());
    found.push_back(std::move(circle));
  }
  return found;
}

} // namespace pneuma::pipeline::workflow
