// Virtual visits that are refined as a whole; corners are projected by OpenCV.
#pragma once

#include <gtest/gtest.h>

#include "client/sim/rig/rig_yaml.h"
#include "server/calib/joint/estimate_session.h"
#include "server/calib/joint/refine/refine.h"
#include "tests/bench/rig/joint_session.h"

namespace rigcal::calib::joint {

constexpr int kCaptures = 12;

inline sim::Options WithSeed(std::uint64_t seed) {
  sim::Options options;
  options.seed = seed;
  return options;
}

inline FeatureSession Visit(sim::Options options) {
  options.captures = kCaptures;
  auto experiment = sim::Prepare(*sim::LoadRig("mars-mapper"), options);
  return RecordFeatures(*experiment, 0);
}

inline SessionStart StartFrom(const FeatureSession& session) {
  auto start = StartOf(ViewsOf(session, NominalPoses(session)));
  EXPECT_TRUE(start) << Sentence(start.error());
  return std::move(start).value();
}

inline Refined RefinedFrom(const SessionStart& start) {
  auto refined = Refine(start.problem, start.state, start.noise, GroupsOf(start.problem, start.state));
  EXPECT_TRUE(refined) << Sentence(refined.error());
  return std::move(refined).value();
}

inline SessionEstimate EstimateFrom(const FeatureSession& session) {
  SessionEstimate estimate = EstimateSession(ViewsOf(session, NominalPoses(session)));
  EXPECT_TRUE(estimate.why_not.empty());
  return estimate;
}

inline double T2(const FeatureSession& session, const SensorId& sensor, const Se3& T_ref_sensor, const Matrix6d& C) {
  const Vector6d error = (T_ref_sensor.Inverse() * session.experiment.T_ref_sensor(sensor)).Log();
  return error.dot(C.ldlt().solve(error));
}

// Of the sensor whose pose is told worst: squared error in sigmas; 6 are expected.
inline double WorstT2(const FeatureSession& session, const SessionEstimate& estimate) {
  double worst = 0;
  for (std::size_t i = 0; i < estimate.poses.size(); ++i)
    if (const int row = RowOf(estimate, i); row >= 0)
      worst = std::max(worst, T2(session, estimate.poses[i].sensor, estimate.poses[i].T_ref_sensor,
                                 estimate.covariance.block<6, 6>(row, row)));
  return worst;
}

}  // namespace rigcal::calib::joint
