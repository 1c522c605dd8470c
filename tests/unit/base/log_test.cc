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

// JSON for as long as it lives.
class JsonLines {
 public:
  JsonLines() {
    SetLogForm(LogForm::kJson);
    ::testing::internal::CaptureStderr();
  }
  ~JsonLines() { SetLogForm(LogForm::kText); }
  JsonLines(const JsonLines&) = delete;
  JsonLines& operator=(const JsonLines&) = delete;
  [[nodiscard]] std::string Taken() { return ::testing::internal::GetCapturedStderr(); }
};

TEST(LogAsJson, ALineIsAnObjectWithTheIdsThatThereAre) {
  JsonLines lines;
  Log(LogLevel::kInfo, {.event = "edge", .robot = "r", .session = "s", .job = "7"}, "left \"right\"\n\xff");
  EXPECT_THAT(
      lines.Taken(),
      ContainsRegex("^.\"time\":\"[0-9-]+T[0-9:]+[.][0-9]+Z\",\"level\":\"info\",\"event\":\"edge\",\"robot\":\"r\","
                    "\"session\":\"s\",\"job\":\"7\",\"text\":\"left .*right.* [^\n]*\".\n$"));
}

TEST(LogAsJson, APlainLineIsAMessage) {
  JsonLines lines;
  LogInfo("100% {}");
  EXPECT_THAT(lines.Taken(), HasSubstr(R"("event":"message","text":"100% {}"})"));
}

TEST(LogAsJson, WhatAThreadIsAtIsOnItsLinesUntilItIsDone) {
  JsonLines lines;
  {
    const LogAbout robot({.robot = "r", .job = "1"});
    {
      const LogAbout session({.session = "s", .job = "2"});
      LogError({ErrorCode::kStorage, "disk full", "Free space"});
    }
    LogInfo("outer");
  }
  LogInfo("none");
  const std::string text = lines.Taken();
  EXPECT_THAT(
      text,
      HasSubstr(
          R"("event":"error","robot":"r","session":"s","job":"2","kind":"storage","text":"disk full. Free space."})"));
  EXPECT_THAT(text, HasSubstr(R"("event":"message","robot":"r","job":"1","text":"outer"})"));
  EXPECT_THAT(text, HasSubstr(R"("event":"message","text":"none"})"));
}

TEST(Log, WhoCountsErrorsHearsOfEach) {
  std::vector<ErrorCode> heard;
  OnLoggedError([&](ErrorCode kind) { heard.push_back(kind); });
  ::testing::internal::CaptureStderr();
  LogError({ErrorCode::kStorage, "disk full", "Free space"});
  LogWarn("odd");
  OnLoggedError({});
  LogError({ErrorCode::kBusy, "busy", "Wait"});
  static_cast<void>(::testing::internal::GetCapturedStderr());
  EXPECT_THAT(heard, ::testing::ElementsAre(ErrorCode::kStorage));
}

TEST(Version, IsThatOfTheProject) { EXPECT_THAT(std::string(Version()), ContainsRegex("^[0-9]+[.][0-9]+[.][0-9]+$")); }

}  // namespace
}  // namespace rigcal
