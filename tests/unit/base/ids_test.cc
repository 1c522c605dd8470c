#include "server/base/ids.h"

#include <gtest/gtest.h>

#include <type_traits>

namespace rigcal {
namespace {

static_assert(!std::is_convertible_v<RobotId, SensorId>);
static_assert(!std::is_constructible_v<SensorId, RobotId>);
static_assert(!std::is_convertible_v<std::string, RobotId>);

TEST(Id, AcceptsNames) {
  for (const char* text : {"a", "mapper-01", "front_left", "v1.2", "007", "A.-_"})
    EXPECT_EQ(RobotId::Parse(text).value().str(), text);
  EXPECT_TRUE(SensorId::Parse(std::string(64, 'x')).has_value());
}

TEST(Id, RefusesWhatIsUnsafeInPathsPartitionsAndPages) {
  for (const char* text : {"", ".", "..", ".hidden", "-v", "a/b", "a\\b", "a b", "a*", "a?", "a,b", "<b>", "ä", "a\n"})
    EXPECT_FALSE(RobotId::Parse(text).has_value()) << text;
  EXPECT_FALSE(SensorId::Parse(std::string(65, 'x')).has_value());
  EXPECT_FALSE(SensorId::Parse(std::string_view("a\0b", 3)).has_value());
}

TEST(Id, TheErrorNamesKindAndText) {
  const Error error = RobotId::Parse("a/b").error();
  EXPECT_EQ(error.code, ErrorCode::kInvalidInput);
  EXPECT_EQ(error.what, "robot id \"a/b\" is not a valid name");
  EXPECT_NE(error.cure.find("letters"), std::string::npos);
}

TEST(Id, DigestsAre64LowerCaseHexDigits) {
  EXPECT_TRUE(Digest::Parse(std::string(64, 'a')).has_value());
  EXPECT_FALSE(Digest::Parse(std::string(63, 'a')).has_value());
  EXPECT_FALSE(Digest::Parse(std::string(65, 'a')).has_value());
  EXPECT_FALSE(EdgeId::Parse(std::string(64, 'A')).has_value());
  EXPECT_FALSE(EdgeId::Parse(std::string(64, 'g')).has_value());
}

TEST(Id, OrderIsThatOfTheText) {
  EXPECT_LT(SensorId("a"), SensorId("b"));
  EXPECT_LT(SensorId("B"), SensorId("a"));
  EXPECT_EQ(SensorId("a"), SensorId("a"));
}

}  // namespace
}  // namespace rigcal
