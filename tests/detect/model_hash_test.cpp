// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway/detect/network_detector.h>
#include <headway_test/folders.h>

#include <fstream>

namespace headway::detect {
namespace {

std::string hashOf(const std::string& content) {
  test::TemporaryFolder folder;
  std::ofstream(folder / "file", std::ios::binary) << content;
  return sha256OfFile(folder / "file");
}

TEST(ModelHashTest, AgreesWithTheStandardsExamples) {
  EXPECT_EQ("e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855", hashOf(""));
  EXPECT_EQ("ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad", hashOf("abc"));
  EXPECT_EQ("248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1",
            hashOf("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"))
      << "two blocks";
}

TEST(ModelHashTest, NamesAFileThatCannotBeRead) {
  EXPECT_THROW((void)sha256OfFile("/nowhere/model.onnx"), InputError);
}

}  // namespace
}  // namespace headway::detect
