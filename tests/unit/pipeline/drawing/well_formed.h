// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <regex>
#include <string>
#include <vector>

namespace pneuma::tests {

// Every tag is closed by its own name, in order; no stray < or &.
inline bool well_formed(const std::string& xml) {
  const std::regex tag(R"(<(\?[^<>]*\?|/?[a-z]+)((?:\s+[a-zA-Z:-]+="[^"<]*")*)\s*(/?)>)");
  std::vector<std::string> open;
  std::size_t end = 0;
  for (auto i = std::sregex_iterator(xml.begin(), xml.end(), tag); i != std::sregex_iterator(); ++i) {
    const std::string between = xml.substr(end, static_cast<std::size_t>(i->position()) - end);
    if (between.find_first_of("<>") != std::string::npos) return false;
    end = static_cast<std::size_t>(i->position() + i->length());
    const std::string name = (*i)[1];
    if (name[0] == '?' || (*i)[3] == "/") continue;
    if (name[0] != '/') {
      open.push_back(name);
    } else {
      if (open.empty() || open.back() != name.substr(1)) return false;
      open.pop_back();
    }
  }
  const bool entities = std::regex_search(xml, std::regex("&(?!(amp|lt|gt|quot);)"));
  return open.empty() && !entities && xml.find_first_not_of('\n', end) == std::string::npos;
}

} // namespace pneuma::tests
