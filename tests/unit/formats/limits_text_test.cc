#include "server/formats/yaml/limits_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigcal::formats {
namespace {

using limits::Limits;
using limits::Setting;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::string Refusal(const Result<Limits>& limits) {
  if (limits) return "";
  EXPECT_EQ(limits.error().code, ErrorCode::kInvalidInput);
  EXPECT_THAT(limits.error().cure, HasSubstr("docs/limits.md"));
  return limits.error().what;
}

TEST(Limits, TheDefaultsLieInTheirRanges) {
  for (const Setting& one : limits::Settings()) {
    EXPECT_LE(one.least, Limits().*one.value) << one.name;
    EXPECT_GE(one.ceiling, Limits().*one.value) << one.name;
  }
  EXPECT_TRUE(CheckTogether({}));
  EXPECT_EQ(ChangedLimits({}), "");
}

TEST(Limits, EachIsSetByItsOwnName) {
  for (const Setting& one : limits::Settings()) {
    const auto limits = WithLimit({}, std::string(one.name) + "=" + std::to_string(one.least));
    ASSERT_TRUE(limits) << one.name;
    Limits wanted;
    wanted.*one.value = one.least;
    EXPECT_EQ(*limits, wanted) << one.name;
  }
}

TEST(Limits, AFileSetsSeveral) {
  const auto limits =
      ReadLimits("# of the depot\nopen_sessions: 16\nintake_bytes: 256MiB\npayload_bytes: 3 KiB\n", "l");
  ASSERT_TRUE(limits) << Sentence(limits.error());
  EXPECT_EQ(limits->open_sessions, 16);
  EXPECT_EQ(limits->intake_bytes, 268'435'456);
  EXPECT_EQ(limits->payload_bytes, 3072);
  EXPECT_EQ(ChangedLimits(*limits), "payload_bytes=3072, intake_bytes=268435456, open_sessions=16");
}

TEST(Limits, AFileWithoutAnyChangesNothing) {
  Limits given;
  given.open_sessions = 5;
  for (const char* text : {"", "# open_sessions: 16\n", "---\n"}) {
    const auto limits = ReadLimits(text, "limits.yaml", given);
    ASSERT_TRUE(limits) << Sentence(limits.error());
    EXPECT_EQ(*limits, given);
  }
}

TEST(Limits, AnUnknownNameNamesTheNearest) {
  EXPECT_THAT(Refusal(WithLimit({}, "open_session=3")),
              AllOf(HasSubstr("\"open_session\" is not known"), HasSubstr("did you mean \"open_sessions\"")));
  EXPECT_THAT(Refusal(WithLimit({}, "zzzzzzzzzzzz=3")), HasSubstr("known here: payload_bytes, "));
  EXPECT_THAT(Refusal(WithLimit({}, "=3")), HasSubstr("is not known"));
  EXPECT_THAT(Refusal(ReadLimits("image_pixels: 5\npaylod_bytes: 5\n", "limits.yaml")),
              AllOf(StartsWith("limits.yaml line 2: limit \"paylod_bytes\""), HasSubstr("payload_bytes")));
}

TEST(Limits, AValueBeyondItsRangeNamesTheRange) {
  for (const Setting& one : limits::Settings())
    for (const std::int64_t value : {one.least - 1, one.ceiling + 1})
      EXPECT_THAT(Refusal(WithLimit({}, std::string(one.name) + "=" + std::to_string(value))),
                  HasSubstr(std::to_string(one.least) + " to " + std::to_string(one.ceiling)))
          << one.name;
}

TEST(Limits, AValueIsAWholeNumber) {
  for (const char* value : {"", "many", "1.5", "-1", "+3", "1e3", "0x10", "3 ", "99999999999999999999", "4MiB"})
    EXPECT_THAT(Refusal(WithLimit({}, "open_sessions=" + std::string(value))), HasSubstr("must be a whole number"))
        << value;
  for (const char* value : {"MiB", "1TiB", "1mib", "3  MiB", "9007199254740993GiB", "9223372036854775807KiB"})
    EXPECT_THAT(Refusal(WithLimit({}, "intake_bytes=" + std::string(value))), HasSubstr("must be a whole number"))
        << value;
}

TEST(Limits, HostileFilesAreRefused) {
  for (const char* text :
       {"- 1\n", "open_sessions\n", "open_sessions: [1]\n", "open_sessions:\n", "open_sessions: 1\nopen_sessions: 2\n",
        "open_sessions: &a 1\n", "{", "open_sessions: \xff\n"})
    EXPECT_THAT(Refusal(ReadLimits(text, "limits.yaml")), HasSubstr("limits.yaml")) << text;
  EXPECT_FALSE(ReadLimits(std::string(1 << 20, '#'), "limits.yaml"));
}

TEST(Limits, AnAssignmentHasASign) {
  const auto limits = WithLimit({}, "open_sessions 3");
  ASSERT_FALSE(limits);
  EXPECT_THAT(Sentence(limits.error()), HasSubstr("is not NAME=VALUE"));
}

TEST(Limits, TheyMustFitTogether) {
  EXPECT_THAT(CheckTogether(*WithLimit({}, "window_bytes=128MiB")).error().what, HasSubstr("above intake_bytes"));
  EXPECT_THAT(CheckTogether(*WithLimit({}, "session_bytes=1MiB")).error().what, HasSubstr("above session_bytes"));
}

}  // namespace
}  // namespace rigcal::formats
