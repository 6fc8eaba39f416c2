// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <deque>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include "pipeline/yaml/node.h"
#include "pipeline/yaml/slip.h"
#include "pipeline/yaml/text.h"

namespace pneuma::pipeline::yaml {

namespace {

// No workflow comes near; aliases of aliases can ask for any number.
constexpr std::size_t node_limit = 1'000'000;   // keys and values
constexpr std::size_t byte_limit = 256'000'000; // of their texts and file names
constexpr std::size_t depth_limit = 100;
constexpr std::size_t key_limit = 1024;   // bytes
constexpr std::size_t report_limit = 100; // keys that are doubled, and the like

std::size_t byte(const YAML::Mark& mark) {
  return static_cast<std::size_t>(std::max(mark.pos, 0));
}

struct Refusal {
  YAML::Mark mark;
  std::string message;
};

// A key or value as the parser reports it, in the order of the file; a list or map comes before its parts.
struct Event {
  NodeKind kind = NodeKind::null;
  bool plain = false; // without quotes; of a null: written as `~`
  YAML::Mark mark;
  std::string text;
  std::size_t target = 0;           // of an alias: the event it stands for, plus 1
  std::size_t end = 0;              // behind the last part; 0: the list or map is not closed yet
  std::size_t parts = 0;            // keys and values of a map, items of a list
  std::size_t nodes = 0, bytes = 0; // with all inside; while it is open, what was there before it
  std::size_t depth = 0;            // levels of lists and maps
};

// Keeps the parser's events: unlike YAML::Node they show every key, also the second of its name. Aliases are counted
// here and copied when all is known to be within the limits.
class Recorder : public YAML::EventHandler {
public:
  Recorder(const std::string& text, std::size_t name_size) : text_(text), name_size_(name_size) {}

  std::deque<Event> events;
  std::size_t last_quoted = 0; // where it begins
  bool complete() const { return !events.empty() && open_.empty(); }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (begun_ && text_.compare(std::min(byte(mark), text_.size()), 3, "---") == 0) {
      throw Refusal{mark, "a second YAML document begins here; a file holds one"};
    }
    if (begun_) throw YAML::ParserException(mark, YAML::ErrorMsg::END_OF_MAP);
    begun_ = true;
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    begin(NodeKind::null, mark, "?", anchor);
    events.back().plain = text_.compare(std::min(byte(mark), text_.size()), 1, "~") == 0;
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    begin(NodeKind::scalar, mark, tag, anchor, value);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const std::size_t target = anchors_.at(anchor);
    const Event& named = events[target];
    if (named.end == 0) throw Refusal{mark, "this alias refers to itself; write the values out"};
    if (open_.size() + named.depth > depth_limit) refuse_depth(mark);
    Event event = started(named.kind, mark);
    event.target = target + 1;
    event.depth = named.depth;
    grow(mark, named.nodes, named.bytes);
    events.push_back(std::move(event));
    end(events.size() - 1);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    begin(NodeKind::list, mark, tag, anchor);
  }
  void OnSequenceEnd() override { end_open(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    begin(NodeKind::map, mark, tag, anchor);
  }
  void OnMapEnd() override { end_open(); }

private:
  [[noreturn]] static void refuse_depth(const YAML::Mark& mark) {
    throw Refusal{mark, fmt::format("this is nested deeper than {} levels", depth_limit)};
  }

  // yaml-cpp turns the escapes of U+0085 and U+00A0 into single bytes.
  void check_quoted(const YAML::Mark& mark, const std::string& text) {
    last_quoted = byte(mark);
    for (std::size_t at = 0; at < text.size();) {
      const Character character = character_at(text, at);
      if (!character.valid) throw Refusal{mark, R"(`\N` and `\_` are not known in quotes; write `\x85` and `\xa0`)"};
      at += character.size;
    }
  }

  Event started(NodeKind kind, const YAML::Mark& mark) const {
    Event event;
    event.kind = kind;
    event.mark = mark;
    event.nodes = nodes_;
    event.bytes = bytes_;
    return event;
  }

  void grow(const YAML::Mark& mark, std::size_t nodes, std::size_t bytes) {
    nodes_ += nodes;
    bytes_ += bytes;
    if (nodes_ <= node_limit && bytes_ <= byte_limit) return;
    throw Refusal{mark,
                  fmt::format("with its aliases written out the file holds more than {} keys and values, or {} MB",
                              node_limit, byte_limit / 1'000'000)};
  }

  void begin(NodeKind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
             const std::string& text = {}) {
    if (tag != "?" && tag != "!") {
      constexpr std::string_view yaml = "tag:yaml.org,2002:";
      const std::string name = tag.starts_with(yaml) ? "!!" + tag.substr(yaml.size()) : tag;
      throw Refusal{mark, fmt::format("the tag `{}` is not known here; leave it out", name)};
    }
    const bool branch = kind == NodeKind::list || kind == NodeKind::map;
    if (branch && open_.size() >= depth_limit) refuse_depth(mark);
    Event event = started(kind, mark);
    event.plain = tag == "?";
    event.text = text;
    event.depth = branch ? 1 : 0;
    grow(mark, 1, text.size() + name_size_);
    if (kind == NodeKind::scalar && !event.plain) check_quoted(mark, text);
    events.push_back(std::move(event));
    const std::size_t index = events.size() - 1;
    if (anchor != 0) anchors_[anchor] = index;
    if (branch) {
      open_.push_back(index);
    } else {
      end(index);
    }
  }

  void end(std::size_t index) {
    Event& event = events[index];
    event.end = events.size();
    event.nodes = nodes_ - event.nodes;
    event.bytes = bytes_ - event.bytes;
    if (open_.empty()) return;
    Event& parent = events[open_.back()];
    parent.depth = std::max(parent.depth, event.depth + 1);
    ++parent.parts;
  }

  void end_open() {
    const std::size_t index = open_.back();
    open_.pop_back();
    end(index);
  }

  const std::string& text_;
  std::size_t name_size_;
  bool begun_ = false;
  std::vector<std::size_t> open_;
  std::map<YAML::anchor_t, std::size_t> anchors_;
  std::size_t nodes_ = 0, bytes_ = 0;
};

// Makes the tree of the events.
class Builder {
public:
  Builder(const std::deque<Event>& events, std::string_view text, const std::string& name,
          std::vector<Problem>& problems)
      : events_(events), text_(text), name_(name), problems_(problems),
        last_(std::min(text.find_last_not_of(" \t\r\n"), text.size())), last_place_(mark_at(text, last_, name)) {}

  Node build(std::size_t index) {
    const Event& event = events_[index];
    if (event.target != 0) {
      ++copies_;
      Node copy = build(event.target - 1);
      --copies_;
      return copy;
    }
    Node node{event.kind, place(event), event.text, {}, {}};
    if (event.kind == NodeKind::map) fill(node, index);
    if (event.kind != NodeKind::list) return node;
    node.items.reserve(event.parts);
    for (std::size_t i = index + 1; i < event.end; i = events_[i].end) {
      if (!node.items.empty() && has_comma(node.items.back(), events_[i])) {
        node.items.back().text += "," + events_[i].text;
        continue;
      }
      node.items.push_back(build(i));
      // where nothing stands, the parser names the place of what comes next
      if (events_[i].kind == NodeKind::null && !events_[i].plain) node.items.back().mark = node.mark;
    }
    return node;
  }

private:
  using Lines = std::map<std::string, int>; // where each key stands first

  Mark place(const Event& event) const {
    if (byte(event.mark) > last_) return last_place_; // not in the line behind the last
    return {name_, event.mark.line + 1, event.mark.column + 1};
  }

  // What is wrong in a value is said once, not for each alias of it.
  void report(const Mark& mark, const std::string& message) {
    if (copies_ == 0 && ++reports_ <= report_limit) problems_.push_back({mark, message});
  }

  bool is_key(const Event& written, const Event& key, Lines& lines) {
    const Mark mark = place(written);
    if (key.kind != NodeKind::scalar) {
      report(mark, "a key must be a word, not a list or a map, nor empty");
    } else if (key.text.size() > key_limit) {
      report(mark, fmt::format("a key has at most {} characters", key_limit));
    } else if (const auto [first, is_new] = lines.emplace(key.text, mark.line); !is_new) {
      report(mark, fmt::format("the key `{}` stands here a second time (first in line {}); keep one", key.text,
                               first->second));
    } else {
      return true;
    }
    return false;
  }

  // `b` or `b:1` where `b: 1` was meant: yaml-cpp takes it for a key, in brackets and at the end of a block.
  bool lacks_colon(const Event& key) const {
    const std::size_t at = byte(key.mark), behind = at + key.text.size();
    const bool found = key.plain && key.target == 0 && at < text_.size() && text_.substr(at).starts_with(key.text);
    const std::size_t next = found ? text_.find_first_not_of(" \t", behind) : 0;
    return found && (next == std::string_view::npos || text_[next] != ':');
  }

  // `0,5 m` in brackets, which YAML takes for `0` and `5 m`: of one piece the quantity tells of its comma.
  bool has_comma(const Node& before, const Event& rest) const {
    constexpr const char* digits = "0123456789";
    const std::size_t at = byte(rest.mark), sign = before.text.find_first_of("+-") == 0 ? 1 : 0;
    return before.kind == NodeKind::scalar && rest.plain && rest.target == 0 && at > 0 && at < text_.size() &&
           text_[at - 1] == ',' && before.text.size() > sign &&
           before.text.find_first_not_of(digits, sign) == std::string::npos && rest.text.find_first_of(digits) == 0 &&
           rest.text.find_first_not_of("0123456789.eE+-") != std::string::npos;
  }

  void fill(Node& map, std::size_t index) {
    Lines lines;
    std::size_t merged = 0;
    Mark merge_mark;
    map.entries.reserve(events_[index].parts / 2);
    for (std::size_t i = index + 1; i < events_[index].end;) {
      const Event& written = events_[i];
      const Event& key = written.target == 0 ? written : events_[written.target - 1];
      const std::size_t at = written.end;
      i = events_[at].end;
      if (!is_key(written, key, lines)) continue;
      const Mark mark = place(written);
      if (key.plain && key.text == "<<") {
        merged = at;
        merge_mark = mark;
        continue;
      }
      if (copies_ == 0 && events_[at].kind == NodeKind::null && lacks_colon(written)) {
        if (!map.entries.empty() && has_comma(map.entries.back().value, written)) {
          map.entries.back().value.text += "," + key.text;
        } else {
          report(mark, without_colon(key.text));
        }
        continue;
      }
      Node value = build(at);
      if (value.kind == NodeKind::null) value.mark = mark;
      map.entries.push_back({key.text, mark, std::move(value)});
    }
    if (merged != 0) merge(map, build(merged), merge_mark, lines);
  }

  void merge(Node& map, Node source, const Mark& mark, Lines& lines) {
    const auto is_map = [](const Node& node) { return node.kind == NodeKind::map; };
    const bool maps = source.kind == NodeKind::list && std::all_of(source.items.begin(), source.items.end(), is_map);
    if (!is_map(source) && !maps) {
      return report(mark, "`<<` takes over the entries of maps: `<<: *name`, or `<<: [*name, *other]`");
    }
    for (Node& item : source.items) merge(map, std::move(item), mark, lines);
    for (Entry& entry : source.entries) {
      if (lines.emplace(entry.key, entry.mark.line).second) map.entries.push_back(std::move(entry));
    }
  }

  const std::deque<Event>& events_;
  std::string_view text_;
  const std::string& name_;
  std::vector<Problem>& problems_;
  std::size_t last_; // the last byte that is not blank
  Mark last_place_;
  int copies_ = 0; // aliases around what is being built
  std::size_t reports_ = 0;
};

// What keeps a text from the parser: bytes that are no text, or so many marks that it would take all the memory to
// hold them at once (as it does where a bracket could still turn out to begin a key).
std::optional<Problem> unfit(const std::string& text, const std::string& name) {
  const auto no_text = [&](std::size_t at, const std::string& why) {
    return Problem{mark_at(text, at, name), "not valid YAML: this is no text file in UTF-8" + why};
  };
  if (text.starts_with("\xFE\xFF") || text.starts_with("\xFF\xFE")) return no_text(0, ", but in UTF-16");
  constexpr std::string_view signs = ",[{&*!:?";
  std::size_t marks = 0;
  for (std::size_t at = 0; at < text.size();) {
    const auto [code, size, valid] = character_at(text, at);
    const bool line_end = code == '\n' || (code == '\r' && text.compare(at, 2, "\r\n") == 0);
    if (!valid || (is_control(code) && code != '\t' && !line_end)) {
      return no_text(
          at, fmt::format("; the {} 0x{:02x} stands here", valid ? "character" : "byte", static_cast<unsigned>(code)));
    }
    if (code == '%' && (at == 0 || text[at - 1] == '\n') && !(at == 0 && text.starts_with("%YAML "))) {
      return Problem{mark_at(text, at, name), "not valid YAML: a line cannot begin with `%`; put the text in quotes"};
    }
    // nearly every key and value has a comma, colon or bracket; quotes add least to what the parser holds
    marks += code == '"' || code == '\'' ? 1 : code < 0x80 && signs.find(text[at]) != std::string_view::npos ? 8 : 0;
    if (marks > 10 * node_limit) {
      return Problem{mark_at(text, at, name), fmt::format("the file holds more than {} keys and values", node_limit)};
    }
    at += size;
  }
  return {};
}

} // namespace

Node parse_yaml(const std::string& text, const std::string& name, std::vector<Problem>& problems) {
  if (text.starts_with("\xEF\xBB\xBF")) return parse_yaml(text.substr(3), name, problems);
  const Mark begin{name, 1, 1};
  Node nothing{NodeKind::null, begin, "", {}, {}};
  if (const auto problem = unfit(text, name)) {
    problems.push_back(*problem);
    return nothing;
  }
  Recorder recorder(text, name.size());
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    parser.HandleNextDocument(recorder);
    if (parser) parser.HandleNextDocument(recorder);
    // yaml-cpp takes the end of the file for the end of a quote
    if (const auto problem = open_quote(text, recorder.last_quoted, name)) {
      problems.push_back(*problem);
      return nothing;
    }
  } catch (const Refusal& refusal) {
    problems.push_back({mark_at(text, std::min(byte(refusal.mark), text.size()), name), refusal.message});
  } catch (const YAML::Exception& error) {
    problems.push_back(slip(text, byte(error.mark), error.msg, name));
  }
  if (!recorder.complete() || recorder.events[0].kind == NodeKind::null) return nothing;
  return Builder(recorder.events, text, name, problems).build(0);
}

} // namespace pneuma::pipeline::yaml
