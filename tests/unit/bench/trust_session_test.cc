// A measure's own parts: what is told of a session stands beside the right truth, boards are searched for and not cut
// out.
#include "tests/bench/trust/trust_session.h"

#include <gtest/gtest.h>

#include "tests/bench/trust/found_plates.h"

namespace rigcal {
namespace {

HostileVisit TwoCameras() {
  HostileVisit visit;
  visit.two_cameras = true;
  visit.options.captures = 12;
  return visit;
}

TEST(TrustSession, ToldPosesStandBesideTheTruthOfTheirOwnVisit) {
  const JudgedVisit judged = JudgeVisit(TwoCameras());
  ASSERT_EQ(judged.poses.size(), 1u);
  const PoseFigures& pose = judged.poses.at(SensorId("front_right"));
  ASSERT_TRUE(pose.known);
  ASSERT_EQ(pose.errors.size(), 1u);
  EXPECT_LT(pose.errors[0].head<3>().norm(), 2e-3);
  EXPECT_GT(pose.errors[0].norm(), 1e-7);
  EXPECT_GT(pose.limit, 12.59);  // chi-square's, of a covariance that is known
  EXPECT_EQ(judged.told.said.front().text, judged.told.verdict.why + " " + judged.told.verdict.what_to_do);
  EXPECT_EQ(judged.told.failed_edges, 0);
}

TEST(TrustSession, NextVisitsAreOtherVisitsOfTheSameRobot) {
  HostileVisit visit = TwoCameras();
  visit.options.disturb.visit_scatter = {0.01, 0.01};
  visit.visits = 2;
  visit.next_visits = 3;
  const JudgedVisit judged = JudgeVisit(visit);
  const PoseFigures& pose = judged.poses.at(SensorId("front_right"));
  ASSERT_EQ(pose.errors.size(), 3u);
  const SensorPose* told = nullptr;
  for (const SensorPose& one : judged.told.poses)
    if (one.sensor == SensorId("front_right")) told = &one;
  ASSERT_NE(told, nullptr);
  for (std::uint64_t i = 0; i < 3; ++i) {
    const Se3 truth = ExperimentOf(visit, 3 + i).T_ref_sensor(SensorId("front_right"));
    EXPECT_LT(((told->T_ref_sensor * Se3::Exp(pose.errors[i])).Inverse() * truth).Log().norm(), 1e-9);
    EXPECT_GT(pose.errors[i].head<3>().norm(), 1e-3);
  }
}

TEST(TrustSession, PlatesAreFoundInWholeClouds) {
  HostileVisit visit;
  visit.options.captures = 1;
  FeatureSession session = RecordFeatures(ExperimentOf(visit, 1), 0);
  const auto cut_out = session.seen.clouds;
  FindPlates(session);
  const SensorId lidar("lidar_vertical");
  const CaptureId capture = session.experiment.captures[0];
  const Se3 T_lidar_world = session.experiment.T_world_sensor(lidar, 0).Inverse();
  int found = 0;
  for (const auto& [board, view] : session.seen.clouds.at(lidar).at(capture)) {
    if (!cut_out.at(lidar).at(capture).at(board).found) continue;
    ASSERT_TRUE(view.found) << board.str();
    const Eigen::Vector3d middle_m = T_lidar_world * session.experiment.BoardAt(board, 0).T_world_plate.p_m;
    double nearest_m = 1e9;
    for (const PlanePatch& patch : view.candidates) nearest_m = std::min(nearest_m, (patch.centre_m - middle_m).norm());
    EXPECT_LT(nearest_m, 0.1) << board.str();
    EXPECT_NE(view.candidates.front().points_m.size(),
              cut_out.at(lidar).at(capture).at(board).candidates.front().points_m.size());
    ++found;
  }
  EXPECT_GE(found, 3);
}

}  // namespace
}  // namespace rigcal
