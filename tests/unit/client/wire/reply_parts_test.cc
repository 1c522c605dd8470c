#include "client/wire/reply_parts.h"

#include <gtest/gtest.h>

namespace rigcal::client {
namespace {

TEST(ReplyParts, OnePartIsTheWhole) {
  ReplyParts parts;
  EXPECT_EQ(parts.Add(0, 1, "{}"), "{}");
}

TEST(ReplyParts, OrderAndRepetitionDoNotMatter) {
  ReplyParts parts;
  EXPECT_EQ(parts.Add(2, 3, "c"), std::nullopt);
  EXPECT_EQ(parts.Add(2, 3, "c"), std::nullopt);
  EXPECT_EQ(parts.Add(0, 3, "a"), std::nullopt);
  EXPECT_EQ(parts.Add(1, 3, "b"), "abc");
  EXPECT_EQ(parts.Add(1, 3, "b"), std::nullopt);
}

TEST(ReplyParts, ContradictionsAreIgnored) {
  ReplyParts parts;
  EXPECT_EQ(parts.Add(0, 2, "a"), std::nullopt);
  EXPECT_EQ(parts.Add(0, 1, "other"), std::nullopt);
  EXPECT_EQ(parts.Add(5, 2, "x"), std::nullopt);
  EXPECT_EQ(parts.Add(0, 4'000'000'000U, "x"), std::nullopt);
  EXPECT_EQ(parts.Add(1, 2, nullptr), std::nullopt);
  EXPECT_EQ(parts.Add(1, 2, "b"), "ab");
}

}  // namespace
}  // namespace rigcal::client
