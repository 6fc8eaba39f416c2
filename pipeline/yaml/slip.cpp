// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/yaml/slip.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <yaml-cpp/exceptions.h>

namespace pneuma::pipeline::yaml {

namespace {

constexpr auto none = std::string_view::npos;
constexpr std::string_view blanks = " \t\r\n";

struct Slip {
  std::size_t at = 0;
  std::string words;
};

// What is open behind a text. Nearly YAML's own rules: enough for a message, not for reading.
struct Outline {
  std::vector<std::size_t> brackets;     // `[` and `{` not closed
  std::size_t quote = none;              // not closed
  std::size_t quoted = none, behind = 0; // the last closed quote: where it begins, the byte behind it
};

bool blank_at(std::string_view text, std::size_t at) {
  return at >= text.size() || blanks.find(text[at]) != none;
}

std::size_t begin_of_line(std::string_view text, std::size_t at) {
  return at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
}

std::size_t end_of_line(std::string_view text, std::size_t at) {
  return std::min(text.find('\n', at), text.size());
}

// Where a line's content begins, behind its blanks and the dashes of lists.
std::size_t content_of_line(std::string_view text, std::size_t at) {
  std::size_t begin = begin_of_line(text, at);
  while (begin < text.size() && (text[begin] == ' ' || (text[begin] == '-' && blank_at(text, begin + 1)))) ++begin;
  return begin;
}

std::size_t column_of(std::string_view text, std::size_t at) {
  return at - begin_of_line(text, at);
}

int line_of(std::string_view text, std::size_t at) {
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

std::size_t behind_quote(std::string_view text, std::size_t begin) {
  for (std::size_t i = begin + 1; i < text.size(); ++i) {
    if (text[begin] == '"' && text[i] == '\\') {
      ++i;
    } else if (text[i] == text[begin]) {
      if (text[begin] == '"' || i + 1 >= text.size() || text[i + 1] != '\'') return i + 1;
      ++i;
    }
  }
  return none;
}

// Behind the lines of a block of text whose `|` or `>` stands at `at`: those indented deeper than its key.
std::size_t behind_block(std::string_view text, std::size_t at) {
  const std::size_t content = content_of_line(text, at);
  const std::size_t parent = content == at ? begin_of_line(text, at) : content;
  const std::size_t column = column_of(text, parent);
  std::size_t end = end_of_line(text, at);
  while (end < text.size()) {
    const std::size_t first = text.find_first_not_of(' ', end + 1);
    if (first == none) return text.size();
    if (blanks.find(text[first]) == none && column_of(text, first) <= column) break;
    end = end_of_line(text, first);
  }
  return end;
}

Outline outline(std::string_view text) {
  Outline seen;
  bool fresh = true; // a value or a key can begin here
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool flow = !seen.brackets.empty();
    if (blanks.find(c) != none) {
      fresh = fresh || c == '\n';
    } else if (c == '#' && (i == 0 || blank_at(text, i - 1))) {
      i = end_of_line(text, i) - 1;
    } else if (fresh && (c == '"' || c == '\'')) {
      const std::size_t behind = behind_quote(text, i);
      if (behind == none) {
        seen.quote = i;
        return seen;
      }
      seen.quoted = i;
      seen.behind = behind;
      i = behind - 1;
      fresh = false;
    } else if ((flow || fresh) && (c == '[' || c == '{')) {
      seen.brackets.push_back(i);
      fresh = true;
    } else if (flow && (c == ']' || c == '}')) {
      seen.brackets.pop_back();
      fresh = false;
    } else if (fresh && !flow && (c == '|' || c == '>')) {
      i = behind_block(text, i) - 1;
    } else if (fresh && (c == '&' || c == '!')) {
      while (!blank_at(text, i + 1)) ++i;
    } else {
      fresh = (flow && c == ',') || (blank_at(text, i + 1) && (c == ':' || (fresh && (c == '-' || c == '?'))));
    }
  }
  return seen;
}

// A word of the text for a message, to the end of its line or of the word.
std::string word_at(std::string_view text, std::size_t at) {
  const std::size_t end = std::min(text.find_first_of(" \t\r\n,]}", at), text.size());
  return std::string(text.substr(at, std::max<std::size_t>(1, end - at)));
}

// A tab in the indentation of a line or of the one before it.
std::size_t tab_before(std::string_view text, std::size_t at) {
  const std::size_t begin = begin_of_line(text, at);
  for (const std::size_t line : {begin_of_line(text, begin == 0 ? 0 : begin - 1), begin}) {
    const std::size_t first = text.find_first_not_of(' ', line);
    if (first != none && text[first] == '\t') return first;
  }
  return none;
}

Slip unclosed(std::string_view text, std::size_t quote) {
  return {quote, fmt::format("the quote {} that begins here is not closed", text[quote])};
}

Slip of_quote(std::string_view text, std::size_t at, const Outline& seen) {
  if (seen.quote != none) return unclosed(text, seen.quote);
  const int first = line_of(text, seen.quoted), last = line_of(text, seen.behind - 1);
  if (first < last) {
    return {seen.quoted, fmt::format("the quote {} that begins here ends in line {} only, before `{}`; close it where "
                                     "its text ends",
                                     text[seen.quoted], last, word_at(text, at))};
  }
  return {at, fmt::format("`{}` follows a closing quote; a quote inside quotes is written {}", word_at(text, at),
                          text[seen.quoted] == '"' ? "`\\\"`" : "`''`")};
}

Slip of_brackets(std::string_view text, std::size_t at, bool at_end, const Outline& seen) {
  const bool closes = text[at] == ']' || text[at] == '}';
  if (seen.brackets.empty()) return {at, fmt::format("`{}` closes nothing", word_at(text, at))};
  const std::size_t open = seen.brackets.back();
  const char close = text[open] == '[' ? ']' : '}';
  const int line = line_of(text, open);
  if (closes && !at_end && text[at] != close) {
    return {at,
            fmt::format("`{}` cannot close the `{}` of line {}; `{}` is missing", text[at], text[open], line, close)};
  }
  const bool outside = begin_of_line(text, at) != begin_of_line(text, open) &&
                       column_of(text, content_of_line(text, at)) <= column_of(text, content_of_line(text, open));
  if (at_end || outside)
    return {open, fmt::format("the `{}` that begins here is not closed by `{}`", text[open], close)};
  if (text[at] == '-') return {at, "in brackets the items of a list are parted by commas, without `-`"};
  return {at, fmt::format("a comma is missing before `{}`, or the `{}` of line {} is not closed", word_at(text, at),
                          text[open], line)};
}

// The content of a line without a comment.
std::string_view words_of_line(std::string_view text, std::size_t at) {
  const std::size_t begin = content_of_line(text, at);
  std::string_view line = text.substr(begin, end_of_line(text, begin) - begin);
  line = line.substr(0, line.find(" #"));
  return line.substr(0, line.find_last_not_of(blanks) + 1);
}

// A `:` where no value can begin.
Slip of_value(std::string_view text, std::size_t at) {
  const std::size_t begin = content_of_line(text, at);
  std::string_view key = text.substr(begin, at > begin ? at - begin : 0);
  key = key.substr(0, key.find_last_not_of(blanks) + 1);
  if (key.find(": ") != none) {
    return {at, "a second `: ` in one line; put a value that holds one in quotes, and the entries of a map in `{}`"};
  }
  if (key.size() > 1000) return {begin, "this key is longer than 1024 characters"};
  std::size_t last = text.substr(0, begin_of_line(text, begin)).find_last_not_of(blanks);
  while (last != none && text[content_of_line(text, last)] == '#') {
    last = text.substr(0, begin_of_line(text, last)).find_last_not_of(blanks);
  }
  if (last == none || key.empty()) return {at, "there is no key before this `:`"};
  const std::size_t above = content_of_line(text, last);
  const std::string words = without_colon(words_of_line(text, last));
  if (!words.empty()) return {above, words};
  return {begin, fmt::format("`{}` is indented deeper than line {}, whose key has its value already", key,
                             line_of(text, above))};
}

// Something in a block that is no key (or no item) of it.
Slip of_block(std::string_view text, std::size_t at) {
  const bool first = content_of_line(text, at) == at || text[at] == '-';
  if (text[at] == ':') return {at, "a blank is missing after this `:`"};
  if (!first) {
    return {at,
            fmt::format("`{}` cannot follow here; is a line break or a comma missing before it?", word_at(text, at))};
  }
  if (const std::string words = text[at] == '-' ? "" : without_colon(words_of_line(text, at)); !words.empty()) {
    return {at, words};
  }
  return {at, fmt::format("`{}` fits nothing above: keys and items of a list do not mix, and those of one map or list "
                          "begin in the same column",
                          words_of_line(text, at))};
}

Slip of_mark(std::string_view text, std::size_t at, const std::string& complaint) {
  namespace msg = YAML::ErrorMsg;
  const auto is = [&](const char* begin) { return complaint.starts_with(begin); };
  if (is(msg::UNKNOWN_ANCHOR)) {
    return {at, fmt::format("no value above is named `&{}`; put a text that begins with `*` in quotes",
                            word_at(text, at).substr(1))};
  }
  if (is(msg::INVALID_ESCAPE) || is(msg::INVALID_HEX) || is(msg::INVALID_UNICODE)) {
    return {std::min(at, text.rfind('\\', at)),
            R"(in double quotes `\` begins a special character; write `\\`, or use single quotes)"};
  }
  if (is(msg::CHAR_IN_BLOCK) || is(msg::ZERO_INDENT_IN_BLOCK)) {
    return {at, "`|` and `>` begin a block of text on the lines below; put a text that begins so in quotes"};
  }
  if (is(msg::ALIAS_NOT_FOUND) || is(msg::ANCHOR_NOT_FOUND) || is(msg::CHAR_IN_ALIAS) || is(msg::CHAR_IN_ANCHOR)) {
    return {at, "`*` and `&` begin the name of a value; put a text that begins so in quotes"};
  }
  if (is(msg::MULTIPLE_ANCHORS)) return {at, "a value has one name `&` only"};
  if (is(msg::BLOCK_ENTRY)) return {at, "an item `- ` of a list begins on a line of its own"};
  if (is(msg::MAP_KEY)) return {at, "a text that begins with `?` goes in quotes"};
  return {at, fmt::format("`{}` cannot stand here; put a text that begins so in quotes", word_at(text, at))};
}

Slip explain(std::string_view text, std::size_t at, bool at_end, const std::string& complaint) {
  namespace msg = YAML::ErrorMsg;
  const Outline seen = outline(text.substr(0, at_end ? text.size() : at));
  if (seen.brackets.empty() && seen.quote == none) {
    if (const std::size_t tab = tab_before(text, at); tab != none) {
      return {tab, fmt::format("line {} is indented with a tab; use spaces", line_of(text, tab))};
    }
  }
  const auto is = [&](const char* words) { return complaint == words; };
  if (is(msg::INVALID_HEX) || complaint.starts_with(msg::INVALID_ESCAPE) ||
      complaint.starts_with(msg::INVALID_UNICODE)) {
    return of_mark(text, at, complaint);
  }
  const bool after_quote = seen.quoted != none && seen.behind <= at && !at_end &&
                           text.substr(seen.behind, at - seen.behind).find_first_not_of(blanks) == none &&
                           begin_of_line(text, seen.behind) == begin_of_line(text, at);
  if (seen.quote != none || (after_quote && text[at] != ':' && !is(msg::FLOW_END))) return of_quote(text, at, seen);
  if (!seen.brackets.empty() || is(msg::FLOW_END)) {
    const bool flow = is(msg::FLOW_END) || is(msg::END_OF_MAP_FLOW) || is(msg::END_OF_SEQ_FLOW) || is(msg::BLOCK_ENTRY);
    if (flow || at_end) return of_brackets(text, at, at_end, seen);
  }
  if (is(msg::MAP_VALUE)) return of_value(text, at);
  if (is(msg::END_OF_MAP) || is(msg::END_OF_SEQ)) return of_block(text, at);
  return of_mark(text, at, complaint);
}

} // namespace

Mark mark_at(std::string_view text, std::size_t at, const std::string& name) {
  return {name, line_of(text, at), static_cast<int>(column_of(text, at)) + 1};
}

std::string without_colon(std::string_view line) {
  const std::size_t colon = line.find(':');
  if (line.find(": ") != none || line.empty() || line.back() == ':') return {};
  if (colon == none) return fmt::format("`{}` is no `key: value`; is a `:` missing, or quotes around it?", line);
  return fmt::format("a blank is missing after the `:` of `{}`", line);
}

std::optional<Problem> open_quote(std::string_view text, std::size_t at, const std::string& name) {
  while (at < text.size() && (text[at] == '&' || text[at] == '!')) { // its name
    while (!blank_at(text, at)) ++at;
    at = std::min(text.find_first_not_of(blanks, at), text.size());
  }
  const bool quote = at < text.size() && (text[at] == '"' || text[at] == '\'');
  if (!quote || behind_quote(text, at) != none) return {};
  return Problem{mark_at(text, at, name), "not valid YAML: " + unclosed(text, at).words};
}

Problem slip(std::string_view text, std::size_t at, const std::string& complaint, const std::string& name) {
  const std::size_t last = text.find_last_not_of(blanks);
  if (last == none) return {{name, 1, 1}, "not valid YAML: there is nothing but blanks"};
  const Slip found = explain(text, std::min(at, last), at > last, complaint);
  return {mark_at(text, found.at, name), "not valid YAML: " + found.words};
}

} // namespace pneuma::pipeline::yaml
