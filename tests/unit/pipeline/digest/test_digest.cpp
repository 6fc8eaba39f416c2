// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/digest/digest.h"

#include <fstream>

#include <gtest/gtest.h>

#include "geometry/base/errors.h"

namespace pneuma::pipeline::digest {
namespace {

// FIPS 180-2, appendix B.1
constexpr const char* sha256_of_abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";

TEST(Digest, OfATextIsThatOfTheStandard) {
  EXPECT_EQ(sha256_of_text("abc"), sha256_of_abc);
}

TEST(Digest, OfAFileIsThatOfItsBytes) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "pneuma_digest_abc";
  std::ofstream(path, std::ios::binary) << "abc";
  EXPECT_EQ(sha256_of_file(path), sha256_of_abc);
  std::filesystem::remove(path);
}

TEST(Digest, OfAMissingFileIsAStateErrorThatNamesIt) {
  try {
    sha256_of_file("/nowhere/state.hdf");
    FAIL();
  } catch (const geometry::base::StateError& error) {
    EXPECT_STREQ(error.what(), "/nowhere/state.hdf: cannot be read: No such file or directory");
  }
}

} // namespace
} // namespace pneuma::pipeline::digest
