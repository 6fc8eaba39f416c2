// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pneuma::pipeline::digest {

// sha256 of a file's bytes as 64 lower-case hexadecimal digits; throws StateError if the file cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);

// The same of a text's bytes.
std::string sha256_of_text(std::string_view text);

} // namespace pneuma::pipeline::digest
