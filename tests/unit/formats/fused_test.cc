// What a revision tells of the sessions that it was fused from.
#include <nlohmann/json.hpp>

#include "tests/unit/formats/samples.h"

namespace rigcal::formats {
namespace {

using nlohmann::json;
using samples::SampleRevision;

TEST(RevisionDocument, TellsOfClocksWhereASessionWasAskedAboutOne) {
  RevisionInput input = SampleRevision();
  const SessionId session(std::string(64, 'a'));
  input.solution.fused.sessions = {session};
  const auto fused = [&] { return json::parse(WriteRevisionDocument(input))["fused"]; };
  EXPECT_FALSE(fused().contains("clocks"));
  input.solution.fused.clocks = {{session, {SensorId("body"), 0.0123, 0.0004, 0.05, 30}},
                                 {session, {SensorId("still"), 0.0, 0.05, 0.05, 0}}};
  EXPECT_EQ(fused()["clocks"][0]["known"], true);
  EXPECT_EQ(fused()["clocks"][1]["known"], false);
  const Result<RevisionInput> read = ReadRevisionDocument(WriteRevisionDocument(input));
  ASSERT_TRUE(read) << Sentence(read.error());
  ASSERT_EQ(read->solution.fused.clocks.size(), 2u);
  EXPECT_EQ(read->solution.fused.clocks[0].session, session);
  EXPECT_EQ(read->solution.fused.clocks[0].clock.tracker, SensorId("body"));
  EXPECT_EQ(read->solution.fused.clocks[0].clock.late_s, 0.0123);
  EXPECT_EQ(read->solution.fused.clocks[0].clock.sigma_s, 0.0004);
  EXPECT_EQ(read->solution.fused.clocks[1].clock.captures, 0);
}

TEST(RevisionDocument, TellsWhichCapturesDoMost) {
  RevisionInput input = SampleRevision();
  const SessionId session(std::string(64, 'a'));
  input.solution.fused.sessions = {session};
  EXPECT_FALSE(json::parse(WriteRevisionDocument(input))["fused"].contains("influential"));
  input.solution.fused.influential = {session, {CaptureId("007"), CaptureId("008")}, SensorId("left"), 1.4};
  const Result<RevisionInput> read = ReadRevisionDocument(WriteRevisionDocument(input));
  ASSERT_TRUE(read) << Sentence(read.error());
  ASSERT_TRUE(read->solution.fused.influential);
  EXPECT_EQ(read->solution.fused.influential->session, session);
  EXPECT_EQ(read->solution.fused.influential->captures.size(), 2u);
  EXPECT_EQ(read->solution.fused.influential->sensor, SensorId("left"));
  EXPECT_EQ(read->solution.fused.influential->sigmas, 1.4);
}

TEST(RevisionDocument, TellsHowPlacesGoOnFromVisitToVisit) {
  RevisionInput input = SampleRevision();
  input.solution.fused.sessions = {SessionId(std::string(64, 'a'))};
  SensorPose* pose = nullptr;
  for (SensorPose& one : input.solution.poses)
    if (one.known && one.sensor != input.reference) pose = &one;
  ASSERT_NE(pose, nullptr);
  pose->fused = FusedPose();
  EXPECT_EQ(WriteRevisionDocument(input).find("walk_m"), std::string::npos);  // as of before
  pose->fused->walk_m_per_sqrt_day = 2e-5, pose->fused->walk_rad_per_sqrt_day = 3e-5;
  input.solution.fused.next_visit_days = 7.5;
  const Result<RevisionInput> read = ReadRevisionDocument(WriteRevisionDocument(input));
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->solution.fused.next_visit_days, 7.5);
  for (const SensorPose& one : read->solution.poses)
    if (one.sensor == pose->sensor) {
      EXPECT_EQ(one.fused->walk_m_per_sqrt_day, 2e-5);
      EXPECT_EQ(one.fused->walk_rad_per_sqrt_day, 3e-5);
    }
}

TEST(RevisionDocument, NamesTheEstimatesThatItWasFusedFrom) {
  RevisionInput input = SampleRevision();
  input.solution.fused.sessions = {SessionId(std::string(64, 'a')), SessionId(std::string(64, 'b'))};
  EXPECT_FALSE(json::parse(WriteRevisionDocument(input))["fused"].contains("made_by"));  // as of before
  input.solution.fused.made_by = {"joint/7", "joint/7 board 0.03"};
  const Result<RevisionInput> read = ReadRevisionDocument(WriteRevisionDocument(input));
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->solution.fused.made_by, input.solution.fused.made_by);
  json one_lacks = json::parse(WriteRevisionDocument(input));
  one_lacks["fused"]["made_by"].erase(1);
  const Result<RevisionInput> refused = ReadRevisionDocument(one_lacks.dump());
  ASSERT_FALSE(refused);
  EXPECT_NE(Sentence(refused.error()).find("one name per session"), std::string::npos) << Sentence(refused.error());
}

}  // namespace
}  // namespace rigcal::formats
