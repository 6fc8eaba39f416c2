// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/workflows/damage/damage.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <regex>

#include "tests/workflows/damage/yaml_text.h"

namespace pneuma::tests::damage {

namespace {

constexpr std::array names = {"key dropped",  "key doubled",    "key misspelt",    "unit dropped", "unit doubled",
                              "unit foreign", "list shortened", "list lengthened", "list emptied", "value as list",
                              "value as map", "value as word",  "value as number", "value empty",  "value .nan",
                              "value .inf",   "value 1e400",    "value negative",  "value zero",   "number behind",
                              "name unknown"};
static_assert(names.size() == kind_count);

using Words = std::vector<std::string>;

// A word in the text that may be called by others, or call them.
struct Called {
  std::string text;
  std::size_t offset = 0;
};

class Damager {
public:
  explicit Damager(const std::string& text) : text_(text), root_(pieces_of(text)) { collect(root_); }

  std::vector<Damage> all() {
    Around root;
    root.begin = 0;
    root.end = text_.size();
    if (root_.kind == Piece::Kind::map) map(root_, root);
    return std::move(damages_);
  }

private:
  // The map or list that a key or item stands in.
  struct Around {
    std::string path;
    std::string key;       // that it stands behind
    std::size_t begin = 0; // with that key
    std::size_t end = 0;
    std::vector<Called> owners; // names of what is around: others may call them
    bool shared = false;
  };

  void collect(const Piece& piece) {
    if (piece.kind == Piece::Kind::word) called_.push_back({piece.text, piece.begin});
    if (piece.kind == Piece::Kind::alias) called_.push_back({piece.text.substr(1), piece.begin});
    if (piece.anchored) { // is lost with its value
      const std::size_t end = text_.find_first_of(" \n", piece.begin);
      called_.push_back({text_.substr(piece.begin + 1, end - piece.begin - 1), piece.begin});
    }
    for (const Piece::Key& key : piece.keys) called_.push_back({key.text, key.begin});
    for (const Piece& value : piece.values) collect(value);
  }

  static std::string below(const std::string& path, const std::string& name) {
    return path.empty() ? name : path + "." + name;
  }

  std::size_t line_begin(std::size_t offset) const { return text_.rfind('\n', offset == 0 ? 0 : offset - 1) + 1; }
  std::size_t line_end(std::size_t offset) const { return std::min(text_.find('\n', offset), text_.size()); }
  bool first_in_line(std::size_t offset) const {
    return text_.find_first_not_of(' ', offset == 0 ? 0 : line_begin(offset)) == offset;
  }

  // `from`, `to`: offsets in the undamaged text between which a message may point.
  Damage& add(Kind kind, const std::string& path, std::size_t begin, std::size_t end, std::string with,
              std::size_t from, std::size_t to, Words words, const Around& around, Words lost = {}) {
    Damage damage;
    damage.kind = kind;
    damage.path = path;
    damage.begin = begin;
    damage.end = end;
    damage.with = std::move(with);
    damage.before = text_.substr(begin, end - begin);
    damage.shared = around.shared;
    const std::string now = damaged(text_, damage);
    const auto moved = [&](std::size_t offset) {
      if (offset >= end) return offset - end + begin + damage.with.size();
      return std::min(offset, begin + damage.with.size());
    };
    damage.at = {line_of(now, moved(from)), line_of(now, moved(std::max(from, to == 0 ? 0 : to - 1)))};
    const std::size_t start = now.rfind('\n', begin == 0 ? 0 : begin - 1) + 1;
    damage.line = now.substr(start, std::min(now.find('\n', begin), now.size()) - start);
    damage.words = std::move(words);
    damage.names = std::move(lost);
    for (const Called& owner : around.owners) damage.names.push_back(owner.text);
    for (const Called& call : called_) {
      if (call.offset >= begin && call.offset < end) continue;
      if (std::find(damage.names.begin(), damage.names.end(), call.text) == damage.names.end()) continue;
      const auto is_it = [&](const Called& owner) { return owner.offset == call.offset; };
      if (std::any_of(around.owners.begin(), around.owners.end(), is_it)) continue;
      damage.references.push_back(line_of(now, moved(call.offset)));
    }
    damages_.push_back(std::move(damage));
    return damages_.back();
  }

  // All words that begin in [begin, end), keys among them.
  Words all_in(std::size_t begin, std::size_t end) const {
    Words found;
    for (const Called& call : called_) {
      if (call.offset >= begin && call.offset < end) found.push_back(call.text);
    }
    return found;
  }

  // Those that are no numbers: names that are lost.
  Words words_in(std::size_t begin, std::size_t end) const {
    Words found = all_in(begin, end);
    std::erase_if(found, [](const std::string& word) { return number_in(word).is_number; });
    return found;
  }

  void map(const Piece& piece, const Around& around) {
    for (std::size_t i = 0; i < piece.keys.size(); ++i) {
      const Piece::Key& key = piece.keys[i];
      const Piece& value = piece.values[i];
      const std::string path = below(around.path, key.text);
      keys(piece, i, around, path);
      Around inner{path, key.text, key.begin, std::max(value.end, key.end), around.owners, around.shared};
      inner.owners.push_back({key.text, key.begin});
      node(value, inner, around, key.begin);
    }
  }

  void keys(const Piece& piece, std::size_t i, const Around& around, const std::string& path) {
    const Piece::Key& key = piece.keys[i];
    const std::size_t end = std::max(piece.values[i].end, key.end + 1);
    const bool last = i + 1 == piece.keys.size();
    Words group = {key.text};
    if (piece.keys.size() == 1 && !around.key.empty()) group.push_back(around.key);
    // what is lost: the key itself (of a table), and the names in its value
    const Words lost = words_in(key.begin, end);

    std::size_t from = key.begin, to = last ? end : piece.keys[i + 1].begin;
    if (last && piece.in_flow && i > 0) from = piece.values[i - 1].end;
    std::string instead;
    if (last && !piece.in_flow) {
      if (first_in_line(from) && piece.keys.size() > 1) {
        from = line_begin(from);
        to = std::min(line_end(to) + 1, text_.size());
      } else {
        instead = "{}"; // behind a dash, or alone
      }
    }
    Damage& dropped = add(Kind::key_dropped, path, from, to, instead, around.begin, around.end, group, around, lost);
    dropped.before = key.text;
    dropped.value_begin = text_.find(':', key.end) + 1;
    dropped.value_end = end;

    const std::string whole = text_.substr(key.begin, end - key.begin);
    if (piece.in_flow) {
      add(Kind::key_doubled, path, end, end, ", " + whole, key.begin, end + 2, {key.text}, around);
      damages_.back().at.first = damages_.back().at.last = line_of(damaged(text_, damages_.back()), end + 2);
    } else {
      const std::string indent(key.begin - line_begin(key.begin), ' ');
      const std::size_t to_line = line_end(end);
      add(Kind::key_doubled, path, to_line, to_line, "\n" + indent + whole, key.begin, key.end, {key.text}, around);
      damages_.back().at.first = damages_.back().at.last = line_of(text_, to_line) + 1;
    }
    damages_.back().before = key.text;

    std::string wrong = key.text;
    const std::size_t middle = wrong.size() / 2;
    if (wrong.size() >= 4 && wrong[middle] != wrong[middle - 1]) {
      std::swap(wrong[middle], wrong[middle - 1]);
    } else {
      wrong += "x";
    }
    Damage& misspelt =
        add(Kind::key_misspelt, path, key.begin, key.end, wrong, key.begin, key.end, {key.text, wrong}, around, lost);
    misspelt.after = wrong;
  }

  // `entry`: where its key or dash stands.
  void node(const Piece& piece, Around inner, const Around& outer, std::size_t entry) {
    inner.shared = inner.shared || piece.anchored;
    switch (piece.kind) {
    case Piece::Kind::null:
      break;
    case Piece::Kind::alias:
      replace(Kind::value_as_number, piece, "7", inner, outer, entry);
      break;
    case Piece::Kind::word:
      word(piece, inner, outer, entry);
      break;
    case Piece::Kind::list:
      list(piece, inner, outer, entry);
      break;
    case Piece::Kind::map: {
      collection(piece, inner, outer, entry);
      for (std::size_t i = 0; i < piece.keys.size(); ++i) { // {name: upper, ...}
        if (piece.keys[i].text != "name") continue;
        inner.owners.push_back({piece.values[i].text, piece.values[i].begin});
      }
      map(piece, inner);
      break;
    }
    }
  }

  void replace(Kind kind, const Piece& piece, const std::string& with, const Around& inner, const Around& outer,
               std::size_t entry) {
    const bool block = !piece.in_flow && (piece.kind == Piece::Kind::list || piece.kind == Piece::Kind::map);
    std::size_t begin = piece.begin;
    std::string instead = with;
    if (block) { // from behind the colon or dash
      while (begin > 0 && (text_[begin - 1] == ' ' || text_[begin - 1] == '\n')) --begin;
      const std::size_t comment = text_.find('#', line_begin(begin)); // between key and block
      if (comment < begin) return;
      instead = " " + with;
    }
    Words words = {inner.key};
    if (!with.empty()) words.push_back(with);
    if (with.find('7') != std::string::npos) words.emplace_back("7"); // in a list or map
    if (piece.kind == Piece::Kind::word) words.push_back(piece.text);
    Words lost = words_in(piece.begin, piece.end);
    // a message that points behind the key of an empty value points at what follows in its line
    Damage& damage = add(kind, inner.path, begin, piece.end, instead, entry, begin + 1, words, outer, lost);
    damage.after = with;
    damage.before = text_.substr(piece.begin, piece.end - piece.begin);
  }

  void collection(const Piece& piece, const Around& inner, const Around& outer, std::size_t entry) {
    replace(Kind::value_as_number, piece, "7", inner, outer, entry);
    replace(Kind::value_as_word, piece, "many", inner, outer, entry);
    replace(piece.kind == Piece::Kind::list ? Kind::value_as_map : Kind::value_as_list, piece,
            piece.kind == Piece::Kind::list ? "{x: 7}" : "[7, 7]", inner, outer, entry);
    empty(piece, inner, outer, entry);
  }

  void empty(const Piece& piece, const Around& inner, const Around& outer, std::size_t entry) {
    const bool in_list = piece.item_begin == entry && piece.item_begin != 0;
    replace(Kind::value_empty, piece, in_list ? "~" : "", inner, outer, entry);
  }

  void word(const Piece& piece, const Around& inner, const Around& outer, std::size_t entry) {
    const std::string written = text_.substr(piece.begin, piece.end - piece.begin);
    const auto with = [&](Kind kind, const std::string& instead) {
      if (instead != written) replace(kind, piece, instead, inner, outer, entry);
    };
    with(Kind::value_as_list, "[" + written + "]");
    with(Kind::value_as_map, "{x: " + written + "}");
    empty(piece, inner, outer, entry);
    const Number number = piece.quoted ? Number{} : number_in(written);
    const std::string unit = number.unit.empty() ? "" : " " + number.unit;
    with(Kind::value_nan, ".nan" + unit);
    with(Kind::value_inf, ".inf" + unit);
    with(Kind::value_huge, "1e400" + unit);
    if (!number.is_number) {
      with(Kind::value_as_number, "7");
      with(Kind::name_unknown, "nowhere");
      return;
    }
    with(Kind::value_as_word, "many");
    with(Kind::number_behind, written + " 50");
    if (number.value != 0) {
      const bool is_negative = number.digits.front() == '-';
      with(Kind::value_negative, (is_negative ? number.digits.substr(1) : "-" + number.digits) + unit);
      with(Kind::value_zero, "0" + unit);
    }
    if (number.unit.empty()) return;
    with(Kind::unit_dropped, number.digits);
    with(Kind::unit_doubled, written + unit);
    with(Kind::unit_foreign, number.digits + " kg");
  }

  void list(const Piece& piece, const Around& inner, const Around& outer, std::size_t entry) {
    collection(piece, inner, outer, entry);
    replace(Kind::list_emptied, piece, "[]", inner, outer, entry);
    if (!piece.values.empty()) {
      const Piece& last = piece.values.back();
      if (piece.values.size() > 1) {
        const Piece& before = piece.values[piece.values.size() - 2];
        Words words = all_in(last.begin, last.end);
        words.push_back(inner.key);
        add(Kind::list_shortened, inner.path, before.end, last.end, "", entry, piece.end, words, outer,
            words_in(last.begin, last.end));
      }
      const std::string again = text_.substr(last.begin, last.end - last.begin);
      Words words = all_in(last.begin, last.end);
      words.push_back(inner.key);
      words.push_back(again);
      const std::string between =
          piece.in_flow ? ", " : "\n" + std::string(last.item_begin - line_begin(last.item_begin), ' ') + "- ";
      add(Kind::list_lengthened, inner.path, last.end, last.end, between + again, entry, piece.end + 1, words, outer)
          .after = again;
      if (!piece.in_flow) damages_.back().at.last = line_of(text_, piece.end) + line_of(again, again.size());
    }
    for (std::size_t i = 0; i < piece.values.size(); ++i) {
      const Piece& item = piece.values[i];
      // an item is called by the key of its list, and so is what is around it
      Around one{
          below(inner.path, std::to_string(i)), inner.key, item.item_begin, item.end, inner.owners, inner.shared};
      node(item, one, inner, item.item_begin);
    }
  }

  const std::string& text_;
  Piece root_;
  std::vector<Called> called_;
  std::vector<Damage> damages_;
};

} // namespace

std::string to_string(Kind kind) {
  return names[static_cast<std::size_t>(kind)];
}

std::string damaged(const std::string& text, const Damage& damage) {
  return text.substr(0, damage.begin) + damage.with + text.substr(damage.end);
}

Number number_in(const std::string& text) {
  static const std::regex pattern(R"(([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)(?: +([^ 0-9].*))?)");
  std::smatch match;
  if (!std::regex_match(text, match, pattern)) return {};
  return {true, std::strtod(match[1].str().c_str(), nullptr), match[1], match[2]};
}

std::vector<Damage> damages_of(const std::string& text) {
  return Damager(text).all();
}

} // namespace pneuma::tests::damage
