// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/digest/digest.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <openssl/evp.h>

#include "geometry/base/errors.h"

namespace pneuma::pipeline::digest {

namespace {

class Sha256 {
public:
  Sha256() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    check(context_ != nullptr && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
  }
  void add(const void* bytes, std::size_t count) { check(EVP_DigestUpdate(context_.get(), bytes, count) == 1); }
  std::string digits() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
    unsigned int count = 0;
    check(EVP_DigestFinal_ex(context_.get(), bytes.data(), &count) == 1);
    std::string text;
    for (unsigned int i = 0; i < count; ++i) text += fmt::format("{:02x}", bytes[i]);
    return text;
  }

private:
  static void check(bool fine) {
    if (!fine) throw std::runtime_error("OpenSSL could not compute a sha256");
  }
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

} // namespace

std::string sha256_of_file(const std::filesystem::path& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file)
    throw geometry::base::StateError(fmt::format("{}: cannot be read: {}", path.string(), std::strerror(errno)));
  Sha256 sha;
  std::array<char, 1 << 16> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), file.get())) {
    sha.add(buffer.data(), count);
  }
  if (std::ferror(file.get()) != 0) {
    throw geometry::base::StateError(fmt::format("{}: cannot be read: {}", path.string(), std::strerror(errno)));
  }
  return sha.digits();
}

std::string sha256_of_text(std::string_view text) {
  Sha256 sha;
  sha.add(text.data(), text.size());
  return sha.digits();
}

} // namespace pneuma::pipeline::digest
