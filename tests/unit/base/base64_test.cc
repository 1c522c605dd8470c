// RFC 4648, section 10.
#include "server/base/digests/base64.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace rigcal {
namespace {

TEST(Base64, TheStandardsExamples) {
  const std::vector<std::pair<std::string, std::string>> examples = {
      {"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : examples) {
    EXPECT_EQ(ToBase64(bytes), text);
    EXPECT_EQ(FromBase64(text).value(), bytes);
  }
}

TEST(Base64, EveryByteComesBack) {
  std::string bytes;
  for (int i = 0; i < 1000; ++i) bytes.push_back(static_cast<char>(i * 7));
  EXPECT_EQ(FromBase64(ToBase64(bytes)).value(), bytes);
}

TEST(Base64, WhatIsNoBase64IsRefused) {
  for (const char* text : {"a", "ab!d", "Zg=", "\xff\xff\xff\xff"}) EXPECT_FALSE(FromBase64(text)) << text;
}

}  // namespace
}  // namespace rigcal
