#include "server/base/log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/base/version.h"

namespace rigcal {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

std::string Logged(LogLevel level, std::string_view text) {
  ::testing::internal::CaptureStderr();
  Log(level, text);
  return ::testing::internal::GetCapturedStderr();
}

TEST(Log, ALineHasTimeLevelAndText) {
  EXPECT_THAT(Logged(LogLevel::kInfo, "started"), ContainsRegex("^[0-9-]+T[0-9:]+[.][0-9]+Z info started\n$"));
}

TEST(Log, TextIsNotAFormatAndStaysOnOneLine) {
  EXPECT_THAT(Logged(LogLevel::kWarn, "{} {0} 100%\nforged"), HasSubstr("warning {} {0} 100% forged\n"));
}

TEST(Log, LevelsBelowTheChosenOneAreSilent) {
  EXPECT_EQ(Logged(LogLevel::kDebug, "detail"), "");
  SetLogLevel(LogLevel::kDebug);
  EXPECT_THAT(Logged(LogLevel::kDebug, "detail"), HasSubstr("detail"));
  SetLogLevel(LogLevel::kError);
  EXPECT_THAT(Logged(LogLevel::kWarn, "odd"), Not(HasSubstr("odd")));
  SetLogLevel(LogLevel::kInfo);
}

TEST(Log, ErrorsAreSentences) {
  ::testing::internal::CaptureStderr();
  LogError({ErrorCode::kStorage, "disk full", "Free space"});
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("error disk full. Free space.\n"));
}

TEST(Version, IsThatOfTheProject) { EXPECT_THAT(std::string(Version()), ContainsRegex("^[0-9]+[.][0-9]+[.][0-9]+$")); }

}  // namespace
}  // namespace rigcal
