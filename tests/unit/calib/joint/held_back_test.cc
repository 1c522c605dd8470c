// Which looks are a sensor's last, by a problem and weights that are made up.
#include "server/calib/joint/misfit/held_back.h"

#include <gtest/gtest.h>

namespace rigcal::calib::joint {
namespace {

const SensorId kLeft("left"), kRight("right");

// Twelve captures whose names have no leading zeros; both cameras see a board that stands still, each its own place in
// the list of looks.
struct Made {
  SessionProblem problem;
  Refined refined;

  Made() {
    problem.sensors = {kLeft, kRight};
    problem.boards = {{TargetId("wall"), {}}};
    for (int k = 0; k < 12; ++k) {
      problem.captures.emplace_back(std::to_string(k + 1));
      problem.capture_of_place.push_back(k);
      refined.groups.group_of_place.push_back(0);
      for (const int sensor : {0, 1}) See(sensor, k);
    }
  }
  void See(int sensor, int place) {
    CornersSeen look;
    look.sensor = sensor, look.place = place, look.board = 0;
    problem.corners.push_back(look);
    refined.weights.corners.push_back(1.0);
  }
  void HoldBack(int sensor, int from) {
    for (std::size_t i = 0; i < problem.corners.size(); ++i)
      if (problem.corners[i].sensor == sensor && problem.corners[i].place >= from) refined.weights.corners[i] = 0.1;
  }
};

TEST(JointHeldBack, CapturesComeInTheirOrderNotInThatOfTheirNamesAsTexts) {
  Made made;
  made.HoldBack(0, 8);
  const auto late = LateContradictions(made.problem, made.refined);
  ASSERT_EQ(late.size(), 1u);
  EXPECT_EQ(late[0].sensor, kLeft);
  EXPECT_EQ(late[0].first.str(), "9");
  EXPECT_EQ(late[0].captures, 4);
  EXPECT_EQ(late[0].or_sensor, kRight) << "the only other that saw these places";
  const auto looks = LooksHeldBack(made.problem, made.refined);
  ASSERT_EQ(looks.size(), 4u);
  EXPECT_EQ(looks[0].capture.str(), "9");
  EXPECT_EQ(looks[3].capture.str(), "12");
}

TEST(JointHeldBack, ABoardIsNamedOnlyWhereNobodySawItAsItWas) {
  Made seen_as_before;
  seen_as_before.HoldBack(0, 11);
  EXPECT_TRUE(LateContradictions(seen_as_before.problem, seen_as_before.refined).at(0).or_board.empty());
  Made by_both;
  by_both.HoldBack(0, 11);
  by_both.HoldBack(1, 11);
  const auto late = LateContradictions(by_both.problem, by_both.refined);
  ASSERT_EQ(late.size(), 2u);
  for (const LateContradiction& one : late) EXPECT_EQ(one.or_board.str(), "wall");
}

TEST(JointHeldBack, OneThatFitsAtTheEndLeavesNoDoubt) {
  Made made;
  made.HoldBack(0, 8);
  made.refined.weights.corners[22] = 1.0;  // of the left camera in the last capture
  EXPECT_TRUE(LateContradictions(made.problem, made.refined).empty());
}

TEST(JointHeldBack, LooksThatNeverTookPartAreToldWithTheirReason) {
  SessionStart start;
  start.unused = {{kRight, CaptureId("7"), WhyUnused::kBehindTheCamera},
                  {kLeft, CaptureId("10"), WhyUnused::kPlaceUnknown},
                  {kLeft, CaptureId("9"), WhyUnused::kPlaceUnknown},
                  {kLeft, CaptureId("8"), WhyUnused::kNoBoardThere}};
  const auto left_out = LooksLeftOut(start);
  ASSERT_EQ(left_out.size(), 3u) << "clouds without a board are judged by themselves";
  EXPECT_EQ(left_out[0].capture.str(), "9");
  EXPECT_EQ(left_out[0].why, WhyHeldBack::kPlaceUnknown);
  EXPECT_EQ(left_out[1].capture.str(), "10");
  EXPECT_EQ(left_out[2].sensor, kRight);
  EXPECT_EQ(left_out[2].why, WhyHeldBack::kBehindTheCamera);
}

}  // namespace
}  // namespace rigcal::calib::joint
