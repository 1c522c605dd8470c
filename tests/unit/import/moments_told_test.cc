#include <gmock/gmock.h>

#include "client/import/report.h"
#include "server/formats/sessions/session_folder.h"

namespace rigcal::importing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

MomentsTold Told() {
  MomentsTold told;
  told.moments = 812, told.chosen = 27;
  told.left_out[static_cast<std::size_t>(moments::LeftOut::kMoved)] = 610;
  told.left_out[static_cast<std::size_t>(moments::LeftOut::kBlurred)] = 20;
  told.usual_motion_px = 8.1, told.usual_motion_m = 0.031;
  told.least_motion_px = 0.6, told.least_motion_m = 0.0012;
  told.worst_kept_px = 0.3, told.worst_kept_m = 0.0007;
  moments::SensorClock right{moments::ClockSource::kEstimated, 1'700'000'000'000'000'000, 0.0271, 1.9e-5, 4e-5, 2e-6};
  told.clocks = {{"left", {moments::ClockSource::kReference}}, {"right", right}, {"rear", {}}};
  return told;
}

TEST(MomentsTold, SaysHowManyWereLeftOutAndWhy) {
  const std::string text = MomentsText(Told());
  EXPECT_THAT(text, HasSubstr("27 of 812 moments are captures, which move by 0.70 mm, 0.30 px at most"));
  EXPECT_THAT(text, HasSubstr("610 something moved (31 mm, 8.10 px in the middle, 1.20 mm, 0.60 px at least; allowed "
                              "are 1.00 mm, 0.50 px)"));
  EXPECT_THAT(text, HasSubstr("20 blurred"));
  EXPECT_THAT(text, Not(HasSubstr("too soon")));
  EXPECT_EQ(ClocksText(Told()), "right 27.10 ms (sigma 0.04), 19.0 ppm (sigma 2.0); rear not known");
}

TEST(MomentsTold, AnOutcomeReadsBackAsItWasWritten) {
  ImportOutcome outcome;
  outcome.captures = 27;
  outcome.sensors = {{"left", "/left", 900, 27, 0, "", {27, 3, 0, 0, 870}, 0}};
  outcome.moments = Told();
  outcome.shows_no_board = true;
  const std::string text = OutcomeJson(outcome, "");
  const auto again = ReadOutcome(text);
  ASSERT_TRUE(again) << again.error().what;
  EXPECT_EQ(OutcomeJson(*again, ""), text);
  EXPECT_EQ(again->sensors[0].use.left_out, 870U);
  ASSERT_TRUE(again->moments);
  EXPECT_EQ(MomentsText(*again->moments), MomentsText(Told()));
}

TEST(MomentsTold, AnOutcomeWithoutAChoiceHasNone) {
  const auto again = ReadOutcome(OutcomeJson({}, ""));
  ASSERT_TRUE(again) << again.error().what;
  EXPECT_FALSE(again->moments);
}

constexpr const char* kStreamRig =
    "format: 1\nrobot: mapper-01\nimport: {moments: still, motion_px: 0.8, motion_m: 0.002}\n"
    "targets:\n  board: {type: checkerboard, inner_corners: [9, 6], square_size_m: 0.025}\n"
    "sensors:\n  left: {type: camera, topic: /left, sees: board}\n  right: {type: camera, topic: /right, "
    "clock_offset_s: -0.012}\n";

TEST(MomentsTold, RigYamlSaysWhatIsStillAndWhichClocksAreKnown) {
  const auto map = ReadRigMap(kStreamRig, "rig.yaml");
  ASSERT_TRUE(map) << map.error().what;
  EXPECT_EQ(map->moments, MomentsWanted::kStill);
  EXPECT_EQ(map->motion_px, 0.8);
  EXPECT_EQ(map->motion_m, 0.002);
  EXPECT_FALSE(map->sensors[0].clock_offset_s);
  EXPECT_EQ(map->sensors[1].clock_offset_s, -0.012);
  EXPECT_EQ(map->header.sensors.size(), 2U);
  for (const auto& [from, to] : {std::pair("still", "calm"), std::pair("0.8", "0"), std::pair("-0.012", "-12")}) {
    std::string text = kStreamRig;
    text.replace(text.find(from), std::string(from).size(), to);
    EXPECT_FALSE(ReadRigMap(text, "rig.yaml")) << to;
  }
}

TEST(MomentsTold, TheSessionSaysItUnderConditions) {
  auto map = ReadRigMap(kStreamRig, "rig.yaml");
  ASSERT_TRUE(map);
  AddCondition("chosen_moments", MomentsText(Told()), *map);
  AddCondition("chosen_moments", "again: once", *map);
  const auto header = formats::ReadSessionYaml(SessionYaml(*map, Stamp{}), "session.yaml");
  ASSERT_TRUE(header) << header.error().what;
  EXPECT_EQ(header->conditions.size(), 1U);
  EXPECT_EQ(header->conditions.at("chosen_moments"), "again: once");
}

}  // namespace
}  // namespace rigcal::importing
