// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/drawing/xml.h"

namespace pneuma::pipeline::drawing {

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
    case '&':
      result += "&amp;";
      break;
    case '<':
      result += "&lt;";
      break;
    case '>':
      result += "&gt;";
      break;
    case '"':
      result += "&quot;";
      break;
    default:
      result += static_cast<unsigned char>(c) < ' ' ? ' ' : c; // XML 1.0 knows no control characters
    }
  }
  return result;
}

} // namespace pneuma::pipeline::drawing
