// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/workflows/damage/yaml_text.h"

#include <algorithm>
#include <stdexcept>

namespace pneuma::tests::damage {

namespace {

class Scanner {
public:
  explicit Scanner(const std::string& text) : text_(text) {}

  Piece document() {
    skip();
    Piece root = node(false, false);
    skip();
    if (at_ < text_.size()) refuse("what follows the document");
    return root;
  }

private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw std::runtime_error("line " + std::to_string(line_of(text_, at_)) + ": " + what + " is not understood");
  }

  char here(std::size_t further = 0) const { return at_ + further < text_.size() ? text_[at_ + further] : '\n'; }
  bool blank_after(std::size_t further) const { return here(further) == ' ' || here(further) == '\n'; }
  bool at_dash() const { return here() == '-' && blank_after(1); }
  std::size_t column() const { return at_ - (text_.rfind('\n', at_ == 0 ? 0 : at_ - 1) + 1); }

  void skip_spaces() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }
  bool at_line_end() const { return here() == '\n' || here() == '#'; }

  // Spaces, ends of lines, comments.
  void skip() {
    for (;;) {
      skip_spaces();
      if (at_ >= text_.size() || !at_line_end()) return;
      at_ = std::min(text_.find('\n', at_), text_.size());
      if (at_ < text_.size()) ++at_;
    }
  }

  // A word up to where it ends; `before_colon`: a key.
  std::string word(bool in_flow, bool& quoted) {
    quoted = here() == '"' || here() == '\'';
    const std::size_t begin = at_;
    if (quoted) {
      const char quote = here();
      for (++at_; at_ < text_.size() && text_[at_] != quote; ++at_) {
        if (text_[at_] == '\n') refuse("a quoted word of several lines");
        if (text_[at_] == '\\' && quote == '"') ++at_;
      }
      ++at_;
      return text_.substr(begin + 1, at_ - begin - 2);
    }
    const auto ends = [&] {
      if (here() == '\n' || (here() == ':' && blank_after(1))) return true;
      if (here() == ' ' && here(1) == '#') return true;
      return in_flow && std::string(",[]{}").find(here()) != std::string::npos;
    };
    while (at_ < text_.size() && !ends()) ++at_;
    std::size_t end = at_;
    while (end > begin && text_[end - 1] == ' ') --end;
    at_ = end;
    return text_.substr(begin, end - begin);
  }

  // `in_line`: behind a key, where no block can begin.
  Piece node(bool in_flow, bool in_line) {
    Piece piece;
    piece.begin = at_;
    if (here() == '&') {
      piece.anchored = true;
      while (!blank_after(0)) ++at_;
      skip_spaces();
      if (at_line_end() && !in_flow) {
        skip();
        in_line = false;
      }
    }
    if (here() == '*') {
      piece.kind = Piece::Kind::alias;
      while (!blank_after(0) && std::string(",]}").find(here()) == std::string::npos) ++at_;
      piece.text = text_.substr(piece.begin, at_ - piece.begin);
    } else if (here() == '[' || here() == '{') {
      flow(piece);
    } else if (at_dash() && !in_flow && !in_line) {
      block_list(piece);
    } else {
      const std::size_t begin = at_;
      piece.text = word(in_flow, piece.quoted);
      if (!in_flow && here() == ':' && blank_after(1)) {
        if (in_line) refuse("a second key in one line");
        at_ = begin;
        block_map(piece);
      } else {
        piece.kind = Piece::Kind::word;
        const bool odd = piece.text.empty() || std::string("|>!%@`?").find(piece.text[0]) != std::string::npos;
        if (odd && !piece.quoted) refuse("`" + piece.text + "`");
      }
    }
    piece.end = at_;
    return piece;
  }

  void flow(Piece& piece) {
    piece.kind = here() == '[' ? Piece::Kind::list : Piece::Kind::map;
    piece.in_flow = true;
    const char close = here() == '[' ? ']' : '}';
    ++at_;
    for (skip(); here() != close; skip()) {
      if (piece.kind == Piece::Kind::map) {
        read_key(piece, true);
        skip();
      }
      piece.values.push_back(here() == ',' || here() == close ? nothing() : node(true, true));
      piece.values.back().item_begin = piece.values.back().begin;
      skip();
      if (here() == ',') {
        ++at_;
      } else if (here() != close) {
        refuse("a flow");
      }
    }
    ++at_;
  }

  Piece nothing() const {
    Piece piece;
    piece.begin = piece.end = at_;
    return piece;
  }

  void read_key(Piece& map, bool in_flow) {
    Piece::Key key;
    bool quoted = false;
    key.begin = at_;
    key.text = word(in_flow, quoted);
    key.end = at_;
    skip_spaces();
    if (here() != ':') refuse("a key without colon");
    ++at_;
    map.keys.push_back(key);
  }

  void block_map(Piece& piece) {
    piece.kind = Piece::Kind::map;
    const std::size_t indent = column();
    std::size_t end = at_;
    do {
      read_key(piece, false);
      const std::size_t colon = at_;
      skip_spaces();
      if (!at_line_end()) {
        piece.values.push_back(node(false, true));
      } else {
        skip();
        const bool deeper = at_ < text_.size() && (column() > indent || (column() == indent && at_dash()));
        if (!deeper) at_ = colon;
        piece.values.push_back(deeper ? node(false, false) : nothing());
      }
      end = at_;
      skip();
    } while (at_ < text_.size() && column() == indent && !at_dash());
    if (at_ < text_.size() && column() > indent) refuse("a word of several lines");
    at_ = end;
  }

  void block_list(Piece& piece) {
    piece.kind = Piece::Kind::list;
    const std::size_t indent = column();
    std::size_t end = at_;
    do {
      const std::size_t dash = at_;
      ++at_;
      skip_spaces();
      if (at_line_end()) refuse("a dash with nothing behind");
      piece.values.push_back(node(false, false));
      piece.values.back().item_begin = dash;
      end = at_;
      skip();
    } while (at_ < text_.size() && column() == indent && at_dash());
    at_ = end;
  }

  const std::string& text_;
  std::size_t at_ = 0;
};

} // namespace

int line_of(const std::string& text, std::size_t offset) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(offset, text.size()));
  return 1 + static_cast<int>(std::count(text.begin(), end, '\n'));
}

Piece pieces_of(const std::string& text) {
  return Scanner(text).document();
}

} // namespace pneuma::tests::damage
