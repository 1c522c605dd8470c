// The text of /metrics: read back by a parser of its own, line by line.
#include "server/metrics/exposition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <regex>
#include <sstream>

#include "server/metrics/noted.h"

namespace rigcal::metrics {
namespace {

struct Parsed {
  std::map<std::string, std::string> types;  // of each name
  std::map<std::string, double> samples;     // of each name with its labels
  std::vector<std::string> unreadable;
};

Parsed Parse(const std::string& text) {
  static const std::regex kType(R"(# TYPE (\w+) (counter|gauge|histogram))"), kHelp(R"(# HELP (\w+) \S.*)");
  static const std::regex kSample(R"re(([a-z_]+(?:\{\w+="(?:[^"\\]|\\.)*"(?:,\w+="(?:[^"\\]|\\.)*")*\})?) (\S+))re");
  Parsed parsed;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch found;
    if (std::regex_match(line, found, kType)) {
      if (!parsed.types.emplace(found[1], found[2]).second) parsed.unreadable.push_back("type twice: " + line);
    } else if (std::regex_match(line, found, kSample)) {
      if (!parsed.samples.emplace(found[1], std::stod(found[2])).second)
        parsed.unreadable.push_back("sample twice: " + line);
    } else if (!std::regex_match(line, kHelp)) {
      parsed.unreadable.push_back(line);
    }
  }
  return parsed;
}

double SampleOf(const std::string& name) {
  const Parsed parsed = Parse(TextOf({}));
  const auto found = parsed.samples.find(name);
  return found == parsed.samples.end() ? std::numeric_limits<double>::quiet_NaN() : found->second;
}

TEST(Exposition, EveryLineIsReadAndEveryNameHasOneType) {
  const Parsed parsed = Parse(TextOf({{"rigcal_x_bytes", "Room", 12.5, {{"part", "a \"b\" \\ c"}}},
                                      {"rigcal_y_total", "Things", 3},
                                      {"rigcal_x_bytes", "Room", 7, {{"part", "b"}}},
                                      {"rigcal_x_bytes", "Room", 8, {{"part", "b"}}}}));
  EXPECT_THAT(parsed.unreadable, testing::IsEmpty());
  EXPECT_EQ(parsed.types.at("rigcal_x_bytes"), "gauge");
  EXPECT_EQ(parsed.types.at("rigcal_y_total"), "counter");
  EXPECT_EQ(parsed.types.at("rigcal_stage_duration_seconds"), "histogram");
  EXPECT_EQ(parsed.samples.at(R"(rigcal_x_bytes{part="a \"b\" \\ c"})"), 12.5);
  EXPECT_EQ(parsed.samples.at(R"(rigcal_x_bytes{part="b"})"), 7) << "no two samples of one name";
}

TEST(Exposition, IsTheSameTextTwice) {
  const std::vector<Reading> readings = {{"rigcal_z", "Z", 1, {{"a", "2"}}}, {"rigcal_z", "Z", 1, {{"a", "1"}}}};
  const std::string text = TextOf(readings);
  EXPECT_EQ(text, TextOf({readings[1], readings[0]}));
  EXPECT_LT(text.find("rigcal_z{a=\"1\"}"), text.find("rigcal_z{a=\"2\"}"));
}

TEST(Noted, WhatNeverHappenedIsZeroAndNotAbsent) {
  EXPECT_EQ(SampleOf(R"(rigcal_errors_total{kind="unreachable"})"), 0);
  EXPECT_EQ(SampleOf(R"(rigcal_answer_failures_total{channel="http",kind="busy"})"), 0);
}

TEST(Noted, ARunIsCountedInItsBucketsAndAFailureBeside) {
  const std::string count = R"(rigcal_stage_duration_seconds_count{stage="solve"})",
                    sum = R"(rigcal_stage_duration_seconds_sum{stage="solve"})";
  const std::string within_1_s = R"(rigcal_stage_duration_seconds_bucket{stage="solve",le="1"})";
  const std::string failures = R"(rigcal_stage_failures_total{stage="solve"})";
  const double count_before = SampleOf(count), sum_before = SampleOf(sum), bucket_before = SampleOf(within_1_s);
  const double failures_before = SampleOf(failures);
  Note({Stage::kSolve, 0.5, false});
  Note({Stage::kSolve, 7.0, true});
  EXPECT_EQ(SampleOf(count), count_before + 2);
  EXPECT_NEAR(SampleOf(sum), sum_before + 7.5, 1e-9);
  EXPECT_EQ(SampleOf(within_1_s), bucket_before + 1);
  EXPECT_EQ(SampleOf(failures), failures_before + 1);
}

TEST(Noted, ATimedStageFailedUnlessItWasDone) {
  const std::string count = R"(rigcal_stage_duration_seconds_count{stage="report"})",
                    failures = R"(rigcal_stage_failures_total{stage="report"})";
  const double count_before = SampleOf(count), failures_before = SampleOf(failures);
  { TimedStage timed(Stage::kReport); }
  {
    TimedStage timed(Stage::kReport);
    timed.Done();
  }
  {
    TimedStage timed(Stage::kReport);
    timed.Leave();
  }
  EXPECT_EQ(SampleOf(count), count_before + 2);
  EXPECT_EQ(SampleOf(failures), failures_before + 1);
}

TEST(Noted, AProcessThatWorksForAnotherKeepsNothing) {
  std::vector<StageRun> told;
  NoteElsewhere([&](const StageRun& run) { told.push_back(run); });
  const std::string count = R"(rigcal_stage_duration_seconds_count{stage="detect"})";
  const double before = SampleOf(count);
  Note({Stage::kDetect, 2.0, false});
  NoteElsewhere({});
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].took_s, 2.0);
  EXPECT_EQ(SampleOf(count), before);
}

TEST(Noted, AnswersErrorsAndBytesAreCounted) {
  const double answers = SampleOf(R"(rigcal_answer_duration_seconds_count{channel="dds"})"),
               bytes = SampleOf("rigcal_received_bytes_total");
  const double errors = SampleOf(R"(rigcal_errors_total{kind="storage"})"),
               edges = SampleOf(R"(rigcal_edges_calibrated_total{state="failed"})");
  NoteAnswer(Channel::kDds, 0.003);
  NoteReceived(1'000'000);
  NoteError(ErrorCode::kStorage);
  NoteCalibratedEdge(false);
  EXPECT_EQ(SampleOf(R"(rigcal_answer_duration_seconds_count{channel="dds"})"), answers + 1);
  EXPECT_EQ(SampleOf("rigcal_received_bytes_total"), bytes + 1e6);
  EXPECT_EQ(SampleOf(R"(rigcal_errors_total{kind="storage"})"), errors + 1);
  EXPECT_EQ(SampleOf(R"(rigcal_edges_calibrated_total{state="failed"})"), edges + 1);
}

TEST(Stage, IsFoundByItsName) {
  for (const Stage stage : kStages) EXPECT_EQ(StageOf(NameOf(stage)), stage);
  EXPECT_EQ(StageOf("rest"), std::nullopt);
}

}  // namespace
}  // namespace rigcal::metrics
