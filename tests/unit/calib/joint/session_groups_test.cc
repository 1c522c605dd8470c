// What is told of a session beside its poses, and cameras that saw several boards.
#include <algorithm>
#include <set>

#include "tests/unit/calib/joint/visit.h"

namespace rigcal::calib::joint {
namespace {

SessionViews WithoutCaptures(SessionViews views, const std::vector<CaptureId>& gone) {
  const auto is_gone = [&](const CaptureId& capture) {
    return std::find(gone.begin(), gone.end(), capture) != gone.end();
  };
  for (CameraViews& camera : views.cameras) {
    std::erase_if(camera.views, [&](const auto& view) { return is_gone(view.first); });
    for (const CaptureId& capture : gone) camera.estimate.T_cam_board.erase(capture);
  }
  for (LidarViews& lidar : views.lidars)
    for (const CaptureId& capture : gone) lidar.clouds.erase(capture);
  for (TrackerPoses& tracker : views.trackers)
    std::erase_if(tracker.poses, [&](const TimedPose& row) { return is_gone(row.capture); });
  return views;
}

std::size_t IndexOf(const SessionEstimate& estimate, const SensorId& sensor) {
  const auto at = std::find_if(estimate.poses.begin(), estimate.poses.end(),
                               [&](const RefinedPose& pose) { return pose.sensor == sensor; });
  return static_cast<std::size_t>(at - estimate.poses.begin());
}

// In sigmas of the first.
double Apart(const SessionEstimate& x, const SessionEstimate& y, const SensorId& sensor) {
  const std::size_t i = IndexOf(x, sensor), j = IndexOf(y, sensor);
  const int row = RowOf(x, i);
  const Vector6d step = (x.poses[i].T_ref_sensor.Inverse() * y.poses[j].T_ref_sensor).Log();
  return std::sqrt(step.dot(x.covariance.block<6, 6>(row, row).ldlt().solve(step)));
}

TEST(SessionGroups, HoldEachCaptureOnceAndMoveAPoseByWhatItIsWithoutThem) {
  const FeatureSession session = Visit(WithSeed(51));
  const SessionViews views = ViewsOf(session, NominalPoses(session));
  const SessionEstimate estimate = EstimateSession(views);
  ASSERT_TRUE(estimate.why_not.empty());
  std::vector<CaptureId> all;
  for (const CaptureGroup& group : estimate.groups) all.insert(all.end(), group.captures.begin(), group.captures.end());
  ASSERT_EQ(all.size(), static_cast<std::size_t>(kCaptures));
  EXPECT_TRUE(std::is_sorted(all.begin(), all.end()));
  EXPECT_EQ(std::set<CaptureId>(all.begin(), all.end()).size(), all.size());
  const auto most = std::max_element(estimate.groups.begin(), estimate.groups.end(),
                                     [](const auto& x, const auto& y) { return x.sigmas < y.sigmas; });
  const SessionEstimate without = EstimateSession(WithoutCaptures(views, most->captures));
  ASSERT_TRUE(without.why_not.empty());
  EXPECT_NEAR(Apart(estimate, without, most->sensor), most->sigmas, 0.6 * most->sigmas);
}

TEST(SessionGroups, NoiseIsThatOfTheSensors) {
  const SessionEstimate estimate = EstimateFrom(Visit(WithSeed(52)));
  ASSERT_EQ(estimate.noise.size(), estimate.poses.size());
  const auto is_near = [](double found, double drawn) { return std::abs(found - drawn) <= 0.4 * drawn; };
  for (const ResidualNoise& noise : estimate.noise) {
    const int kinds = (noise.corner_px > 0) + (noise.range_ratio > 0) + (noise.position_m > 0);
    EXPECT_EQ(kinds, 1) << noise.sensor.str();
    EXPECT_TRUE(is_near(noise.corner_px, 0.03) || is_near(noise.range_ratio, 1.0) || is_near(noise.position_m, 2e-4))
        << noise.sensor.str();
  }
}

// Every other capture shows the boards of the cameras in front under another name, as if there were two.
SessionViews WithTwoBoards(SessionViews views) {
  const TargetId front("front"), other("other");
  const auto found =
      std::find_if(views.targets.begin(), views.targets.end(), [&](const Target& t) { return t.id == front; });
  Target second = *found;
  second.id = other;
  views.targets.push_back(second);
  std::vector<CameraViews> added;
  for (CameraViews& camera : views.cameras) {
    if (camera.board.id != front) continue;
    CameraViews of_other{camera.camera, second, {}, camera.estimate};
    for (std::size_t i = 0; i < camera.views.size(); i += 2) {
      of_other.views.push_back(camera.views[i]);
      camera.estimate.T_cam_board.erase(camera.views[i].first);
    }
    added.push_back(std::move(of_other));
  }
  views.cameras.insert(views.cameras.end(), added.begin(), added.end());
  for (LidarViews& lidar : views.lidars) lidar.clouds.clear();
  return views;
}

TEST(SessionBoards, ACameraThatSawSeveralIsOneSensorWithOneLens) {
  const FeatureSession session = Visit(WithSeed(53));
  SessionViews one = ViewsOf(session, NominalPoses(session));
  const SessionViews two = WithTwoBoards(one);
  for (LidarViews& lidar : one.lidars) lidar.clouds.clear();
  const auto start_one = StartOf(one), start_two = StartOf(two);
  ASSERT_TRUE(start_one && start_two);
  EXPECT_EQ(start_one->problem.sensors, start_two->problem.sensors);
  EXPECT_EQ(start_one->problem.cameras.size(), start_two->problem.cameras.size());
  EXPECT_EQ(start_one->problem.boards.size() + 1, start_two->problem.boards.size());
  EXPECT_EQ(start_one->problem.corners.size(), start_two->problem.corners.size());
  const SessionEstimate estimate = EstimateSession(two);
  ASSERT_TRUE(estimate.why_not.empty());
  EXPECT_TRUE(estimate.moved.empty());
  EXPECT_LT(WorstT2(session, estimate), 40);
}

}  // namespace
}  // namespace rigcal::calib::joint
