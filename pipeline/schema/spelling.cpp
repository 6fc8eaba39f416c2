// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/schema/spelling.h"

#include <algorithm>
#include <cctype>
#include <numeric>

namespace pneuma::pipeline::schema {

namespace {

std::string lower(std::string_view word) {
  std::string out(word);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

// Edits (insert, delete, replace, swap neighbours) between two words: optimal string alignment.
std::size_t edits(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
      row[j] = std::min({row[j - 1] + 1, last[j] + 1, last[j - 1] + change});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

constexpr std::size_t most_searched = 300; // of more names, as of many stages, none is searched

} // namespace

std::vector<std::string> others(const std::vector<std::string>& words, std::string_view than) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < words.size() && out.size() <= most_searched; ++i) {
    if (words[i] != than) out.push_back(words[i]);
  }
  return out;
}

bool is_among(std::string_view word, const std::vector<std::string>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::string nearest(std::string_view word, const std::vector<std::string>& known) {
  if (known.size() > most_searched) return "";
  std::string best;
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = edits(lower(word), lower(candidate));
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  return best;
}

std::string suggestion(std::string_view word, const std::vector<std::string>& known) {
  const std::string found = nearest(word, known);
  return found.empty() ? "" : "; did you mean `" + found + "`?";
}

std::string joined(const std::vector<std::string>& words) {
  if (words.empty()) return "none";
  constexpr std::size_t most = 40;
  std::string text;
  for (std::size_t i = 0; i < std::min(words.size(), most); ++i) text += (i == 0 ? "" : ", ") + words[i];
  return words.size() <= most ? text : text + ", ...";
}

} // namespace pneuma::pipeline::schema
