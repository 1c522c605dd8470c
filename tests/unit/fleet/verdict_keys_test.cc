// By which lists of robots count a verdict that no root cause is behind.
#include "server/fleet/findings/verdict_keys.h"

#include <gmock/gmock.h>

#include "tests/unit/fleet/rig.h"

namespace rigcal::fleet {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> KeysOf(const Rig& rig, const std::vector<SessionEstimate>& estimates = {},
                                const std::vector<std::string>& causes = {}) {
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {}, estimates);
  return KeysOfVerdict(verdict, rig.edges, rig.solution, {}, estimates, causes);
}

SessionEstimate Bumped(const char* sensor, bool by_lens) {
  SensorMovedWithin moved;
  moved.sensor = SensorId(sensor);
  moved.step[tangent::kX] = 0.02;
  if (by_lens) moved.lens = {-0.003, 1e-5, true};
  SessionEstimate estimate;
  estimate.moved = {moved};
  return estimate;
}

TEST(VerdictKeys, NothingIsCountedWhereAllIsWell) { EXPECT_THAT(KeysOf(Rig()), IsEmpty()); }

TEST(VerdictKeys, SensorsThatWereMovedAreCountedBesideCauses) {
  EXPECT_THAT(KeysOf(Rig(), {Bumped("right", false)}), ElementsAre("moved right"));
  EXPECT_THAT(KeysOf(Rig(), {Bumped("right", true)}), ElementsAre("lens_changed right"));
  EXPECT_THAT(KeysOf(Rig(), {Bumped("right", false)}, {"files_missing top"}), ElementsAre("moved right"));
}

TEST(VerdictKeys, OfTwoThatMayHaveBeenMovedNeitherIsCountedAlone) {
  SessionEstimate either = Bumped("right", false);
  either.moved.front().or_sensor = SensorId("left");
  EXPECT_THAT(KeysOf(Rig(), {either}), ElementsAre("moved left right"));
}

TEST(VerdictKeys, CamerasWithTheIntrinsicsOfOthersAreCountedAndNoLoopIs) {
  SessionEstimate estimate;
  estimate.contradicted_lenses = {{SensorId("left"), 14.0, 0.0097, {}}, {SensorId("right"), 14.0, 0.0096, {}}};
  EXPECT_THAT(KeysOf(Rig(), {estimate}), ElementsAre("wrong_intrinsics left", "wrong_intrinsics right"));
}

TEST(VerdictKeys, APairThatTheOthersContradictIsCountedWhateverItsDirection) {
  Rig rig;
  rig.solution.residuals.back() = ResidualOf(rig.edges.back(), 0.05);
  std::vector<std::string> keys = KeysOf(rig);
  ASSERT_EQ(keys.size(), 1U);
  EXPECT_EQ(keys.front().find("disagree "), 0U) << keys.front();
  std::swap(rig.edges.back().frame_a, rig.edges.back().frame_b);
  EXPECT_EQ(KeysOf(rig), keys);
  EXPECT_THAT(KeysOf(rig, {}, {"exchanged left right"}), IsEmpty()) << "the root cause alone";
}

TEST(VerdictKeys, WhatIsLessCertainThanWantedIsCountedBySensor) {
  Rig rig;
  rig.solution.poses.back().covariance *= 1e4;
  const std::string sensor = rig.solution.poses.back().sensor.str();
  EXPECT_THAT(KeysOf(rig), testing::Contains("uncertain " + sensor));
}

}  // namespace
}  // namespace rigcal::fleet
