// Sensors that do not stay on their mounts and trackers that drift: as large as asked for, when it was asked for.
#include "client/sim/visit/mounts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "client/sim/visit/sway.h"
#include "tests/unit/client/sim/sample.h"

namespace rigcal::sim {
namespace {

Vector6d OffOf(const Experiment& visit, const SensorId& sensor, std::size_t capture_idx) {
  return (visit.rig.SensorOf(sensor).T_body_sensor.Inverse() * visit.T_body_sensor(sensor, capture_idx)).Log();
}

TEST(SimMounts, AnExcursionEndsWhereItIsSaid) {
  Options options;
  options.captures = 20;
  options.disturb.excursion = {{0.02, 0.03}, 0.5, 0.7, SensorId("body")};
  const Experiment visit = Prepared(SmallRig(), options);
  ASSERT_EQ(visit.displaced, SensorId("body"));
  for (std::size_t k = 0; k < 20; ++k) {
    const Vector6d off = OffOf(visit, SensorId("body"), k);
    const bool is_out = k >= 10 && k < 14;
    EXPECT_NEAR(off.tail<3>().norm(), is_out ? 0.03 : 0.0, 1e-9) << k;
    EXPECT_NEAR(off.head<3>().norm(), is_out ? 0.02 : 0.0, 1e-9) << k;
  }
}

TEST(SimMounts, ACreepGoesEvenlyFromTheFirstToTheLast) {
  Options options;
  options.captures = 11;
  options.disturb.creep = Creep{{0.005, 0.01}, SensorId("body")};
  const Experiment visit = Prepared(SmallRig(), options);
  for (std::size_t k = 0; k < 11; ++k)
    EXPECT_NEAR(OffOf(visit, SensorId("body"), k).tail<3>().norm(), 0.001 * static_cast<double>(k), 1e-9);
}

TEST(SimMounts, RattleHasItsSigmaOnEverySensor) {
  Options options;
  options.captures = 400;
  options.disturb.rattle = {1e-3, 2e-3};
  const Experiment visit = Prepared(SmallRig(), options);
  for (const RigSensor& sensor : visit.rig.sensors) {
    double squares_m2 = 0, squares_rad2 = 0;
    for (std::size_t k = 0; k < 400; ++k) {
      const Vector6d off = OffOf(visit, sensor.id, k);
      squares_m2 += off.head<3>().squaredNorm() / 1200;
      squares_rad2 += off.tail<3>().squaredNorm() / 1200;
    }
    EXPECT_NEAR(std::sqrt(squares_m2), 1e-3, 1e-4) << sensor.id.str();
    EXPECT_NEAR(std::sqrt(squares_rad2), 2e-3, 2e-4) << sensor.id.str();
  }
}

TEST(SimMounts, ADriftingTrackerTellsItsOwnWorldAndNobodyMoves) {
  Options options;
  options.captures = 50;
  options.disturb.pose_drift = {1e-3, 1e-3};
  const Experiment visit = Prepared(SmallRig(), options);
  const RigSensor& body = visit.rig.SensorOf(SensorId("body"));
  double squares_m2 = 0;
  Se3 before;
  for (std::size_t k = 0; k < 50; ++k) {
    EXPECT_TRUE(OffOf(visit, body.id, k).isZero(1e-12));
    const Se3 T_told_world = ToldByTracker(visit, body, k, 0.0) * visit.T_world_sensor(body.id, k).Inverse();
    squares_m2 += (before.Inverse() * T_told_world).Log().head<3>().squaredNorm() / (3 * 49);
    before = T_told_world;
  }
  EXPECT_NEAR(std::sqrt(squares_m2), 1e-3, 3e-4);
}

TEST(SimMounts, ASensorThatIsNotThereCannotBeDisplaced) {
  Options options;
  options.disturb.creep = Creep{{0.005, 0.01}, SensorId("nobody")};
  EXPECT_EQ(Prepare(SmallRig(), options).error().what,
            "sensor nobody cannot be displaced: the rig has none of this name");
  options.disturb.creep.reset();
  options.disturb.excursion = {{0.02, 0.03}, 0.7, 0.5, {}};
  EXPECT_EQ(Prepare(SmallRig(), options).error().what, "excursion is out of range");
}

}  // namespace
}  // namespace rigcal::sim
