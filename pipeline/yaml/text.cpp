// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/yaml/text.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "pipeline/yaml/node.h"

namespace pneuma::pipeline::yaml {

namespace {

constexpr std::size_t file_limit = 10'000'000; // bytes

// Not controls, but they hide or turn round what stands beside them.
bool is_invisible(char32_t code) {
  return (code >= 0x200b && code <= 0x200f) || (code >= 0x2028 && code <= 0x202e) ||
         (code >= 0x2060 && code <= 0x206f) || code == 0xfeff || (code >= 0xfff9 && code <= 0xfffb) ||
         (code >= 0xe0000 && code <= 0xe007f);
}

// Why a file is not opened at all; empty: it may be.
std::string refusal(const std::filesystem::path& file) {
  using std::filesystem::file_type;
  if (file.native().find('\0') != std::string::npos) return "its name holds a zero byte";
  std::error_code error;
  const file_type type = std::filesystem::status(file, error).type();
  const std::uintmax_t size = type == file_type::regular ? std::filesystem::file_size(file, error) : 0;
  if (type == file_type::directory) return "it is a folder";
  if (type == file_type::fifo) return "it is a pipe, not a file";
  if (type == file_type::socket) return "it is a socket, not a file";
  if (type == file_type::block || type == file_type::character) return "it is a device, not a file";
  if (size > file_limit) return fmt::format("it has {:.1f} MB, more than 10 MB", static_cast<double>(size) / 1e6);
  return error ? error.message() : "";
}

} // namespace

Character character_at(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(i < text.size() ? text[i] : '\0'); };
  const unsigned first = byte(at);
  if (first < 0x80) return {first, 1, true};
  const std::size_t size = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  char32_t code = first & (0x7fU >> size);
  bool valid = first >= 0xc2 && first <= 0xf4;
  for (std::size_t i = 1; i < size; ++i) {
    valid = valid && (byte(at + i) & 0xc0U) == 0x80;
    code = (code << 6U) | (byte(at + i) & 0x3fU);
  }
  const char32_t least = size == 4 ? 0x10000 : size == 3 ? 0x800 : 0x80;
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  if (!valid || code < least || code > 0x10ffff || surrogate) return {first, 1, false};
  return {code, size, true};
}

bool is_control(char32_t code) {
  return code < 0x20 || (code >= 0x7f && code <= 0x9f);
}

std::string printable(std::string_view text) {
  constexpr std::size_t head = 700, tail = 250;
  const auto begins = [&](std::size_t at) { return (static_cast<unsigned char>(text[at]) & 0xc0U) != 0x80; };
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    if (out.size() >= head && text.size() - at > tail + 50) {
      out += " ... ";
      at = text.size() - tail;
      for (int i = 0; i < 3 && !begins(at); ++i) ++at;
    }
    const auto [code, size, valid] = character_at(text, at);
    if (code == '\n') {
      out += "\\n";
    } else if (valid && !is_control(code) && !is_invisible(code)) {
      out += text.substr(at, size);
    } else {
      out += code < 0x100 ? fmt::format("\\x{:02x}", static_cast<unsigned>(code))
                          : fmt::format("\\u{:04x}", static_cast<unsigned>(code));
    }
    at += size;
  }
  return out;
}

std::string read_text(const std::filesystem::path& file, const Mark& where, std::vector<Problem>& problems) {
  std::string text;
  std::string reason = refusal(file);
  // what became a pipe since must not hang, what grows must end
  const int handle = reason.empty() ? ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC) : -1;
  if (reason.empty() && handle < 0) reason = std::strerror(errno);
  std::array<char, 65536> block;
  while (handle >= 0 && reason.empty()) {
    const ::ssize_t size = ::read(handle, block.data(), block.size());
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) reason = std::strerror(errno);
    if (size <= 0) break;
    text.append(block.data(), static_cast<std::size_t>(size));
    if (text.size() > file_limit) reason = "it has more than 10 MB";
  }
  if (handle >= 0) ::close(handle);
  if (reason.empty()) return text;
  problems.push_back({where, fmt::format("the file `{}` cannot be read: {}", file.string(), reason)});
  return {};
}

} // namespace pneuma::pipeline::yaml
