#include <gtest/gtest.h>

#include <cmath>

#include "client/sim/rig/random.h"
#include "client/sim/visit/observe.h"
#include "tests/unit/client/sim/sample.h"

namespace rigcal::sim {
namespace {

constexpr double kRadPerDeg = M_PI / 180;

TEST(SimRandom, DependsOnItsKeyOnlyAndHasTheMomentsOfANormal) {
  EXPECT_EQ(Random(KeyOf(1, "a", "b", 2)).Bits(), Random(KeyOf(1, "a", "b", 2)).Bits());
  EXPECT_NE(KeyOf(1, "a", "b", 2), KeyOf(1, "a", "b", 3));
  EXPECT_NE(KeyOf(1, "a", "b", 2), KeyOf(2, "a", "b", 2));
  EXPECT_NE(KeyOf(1, "ab", "", 2), KeyOf(1, "a", "b", 2));
  constexpr int kCount = 100'000;
  double sum = 0, squares = 0, neighbours = 0, before = 0;
  Random random(KeyOf(3, "moments"));
  for (int i = 0; i < kCount; ++i) {
    const double value = random.Normal();
    sum += value, squares += value * value, neighbours += value * before;
    before = value;
  }
  const double allowed = 5.5 / std::sqrt(kCount);  // 4e-8
  EXPECT_LT(std::abs(sum / kCount), allowed);
  EXPECT_LT(std::abs(squares / kCount - 1), allowed * std::sqrt(2));
  EXPECT_LT(std::abs(neighbours / kCount), allowed);
}

TEST(SimRig, RefusesByNameAndLine) {
  const auto refusal = [](const std::string& from, const std::string& with) {
    std::string text = SmallRigYaml();
    text.replace(text.find(from), from.size(), with);
    const auto rig = ReadRig(text, "small.yaml");
    return rig ? std::string() : Sentence(rig.error());
  };
  EXPECT_NE(refusal("sees: side", "sees: roof").find("roof"), std::string::npos);
  EXPECT_NE(refusal("reference: left", "reference: nobody").find("nobody"), std::string::npos);
  EXPECT_NE(refusal("reference: left", "reference: body").find("tracker"), std::string::npos);
  EXPECT_NE(refusal("[top, body]", "[top, tail]").find("tail"), std::string::npos);
  EXPECT_NE(refusal("plate_size_m: [0.8, 0.7]", "plate_size_m: [0.4, 0.7]").find("plate"), std::string::npos);
  EXPECT_NE(refusal("p_m: [2.2, 0, 1]", "p_m: [9, 0, 1]").find("outside the room"), std::string::npos);
  EXPECT_NE(refusal("captures: 6", "captures: none").find("small.yaml line 5"), std::string::npos);
  EXPECT_FALSE(LoadRig("no-such-rig"));
}

TEST(SimRig, MarsMapperIsTheRobotOfThePaper) {
  const Rig rig = MarsMapper();
  std::map<SensorKind, int> kinds;
  for (const RigSensor& sensor : rig.sensors) ++kinds[sensor.kind];
  EXPECT_EQ(kinds[SensorKind::kCamera], 9);
  EXPECT_EQ(kinds[SensorKind::kLidar], 2);
  EXPECT_EQ(kinds[SensorKind::kTracker], 1);
  EXPECT_EQ(rig.boards.size(), 5u);
  for (const RigBoard& board : rig.boards) EXPECT_EQ(SymmetryOf(board.target), 1) << board.target.id.str();
  const RigSensor& lidar = rig.SensorOf(SensorId("lidar_horizontal"));
  ASSERT_EQ(lidar.lidar.elevations_rad.size(), 32u);
  EXPECT_NEAR(lidar.lidar.elevations_rad.front(), -30.67 * kRadPerDeg, 1e-12);
  EXPECT_NEAR(lidar.lidar.elevations_rad.back(), 10.67 * kRadPerDeg, 1e-12);
  // One turns about an upright axis, one about a level one.
  EXPECT_GT(rig.SensorOf(SensorId("lidar_vertical")).T_body_sensor.R()(2, 2), 0.99);
  EXPECT_LT(std::abs(lidar.T_body_sensor.R()(2, 2)), 0.05);
}

TEST(SimRig, BoardsStandFreeBeforeTheWalls) {
  const Rig rig = MarsMapper();
  for (const RigBoard& board : rig.boards)
    for (const double a : {-0.5, 0.5})
      for (const double b : {-0.5, 0.5}) {
        const Eigen::Vector2d size = *board.target.plate_m;
        const Eigen::Vector3d p = board.T_world_plate * Eigen::Vector3d(a * size.x(), b * size.y(), 0);
        const Eigen::Vector3d half = rig.room.size_m / 2;
        EXPECT_GE(half.x() - std::abs(p.x()), 0.3) << board.target.id.str();
        EXPECT_GE(half.y() - std::abs(p.y()), 0.3) << board.target.id.str();
        EXPECT_GE(std::min(p.z(), rig.room.size_m.z() - p.z()), 0.3) << board.target.id.str();
      }
}

TEST(SimRig, EveryMarsMapperPairHasCapturesEnough) {
  Options options;
  options.captures = 16;
  for (const std::uint64_t seed : {1, 2, 3}) {
    options.seed = seed;
    const Experiment experiment = Prepared(MarsMapper(), options);
    const Observations seen = Observe(experiment);
    for (const auto& [camera, views] : seen.views)
      EXPECT_GE(std::count_if(views.begin(), views.end(), [](const auto& view) { return view.second.found; }), 14)
          << camera.str();
    for (const auto& [lidar, captures] : seen.clouds) {
      std::map<TargetId, int> count;
      for (const auto& [capture, boards] : captures)
        for (const auto& [board, view] : boards) count[board] += view.found;
      EXPECT_EQ(count.size(), lidar.str() == "lidar_horizontal" ? 3u : 4u);
      for (const auto& [board, captures_seen] : count)
        EXPECT_GE(captures_seen, 12) << lidar.str() << " " << board.str();
    }
  }
}

TEST(SimExperiment, MotionIsOfTheKindAskedFor) {
  Options options;
  options.captures = 400;
  const Experiment free = Prepared(SmallRig(), options);
  double tilt_squares = 0;
  for (const Se3& T : free.T_world_body) tilt_squares += std::pow(std::acos(std::min(1.0, T.R()(2, 2))), 2);
  EXPECT_NEAR(std::sqrt(tilt_squares / 400) / kRadPerDeg, 6.0, 0.9);
  options.motion = MotionKind::kPlanar;
  for (const Se3& T : Prepared(SmallRig(), options).T_world_body) {
    EXPECT_NEAR(T.R()(2, 2), 1, 1e-12);
    EXPECT_NEAR(T.p_m.z(), 1, 1e-12);
  }
  options.motion = MotionKind::kSpot;
  for (const Se3& T : Prepared(SmallRig(), options).T_world_body)
    EXPECT_LT((T.p_m - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
}

TEST(SimExperiment, BumpMovesOneSensorHalfwayThrough) {
  Options options;
  options.bump = SensorId("side");
  const Experiment experiment = Prepared(SmallRig(), options);
  const Se3 before = experiment.T_body_sensor(*options.bump, 2), after = experiment.T_body_sensor(*options.bump, 3);
  const Vector6d xi = (before.Inverse() * after).Log();
  EXPECT_NEAR(xi.tail<3>().norm(), options.bump_rad, 1e-9);
  EXPECT_NEAR(xi.head<3>().norm(), options.bump_m, 1e-9);
  EXPECT_LT((experiment.T_body_sensor(SensorId("left"), 0).Inverse() * experiment.T_body_sensor(SensorId("left"), 5))
                .Log()
                .norm(),
            1e-15);
  options.bump = SensorId("nobody");
  EXPECT_FALSE(Prepare(SmallRig(), options));
}

TEST(SimExperiment, TooLargeBoardsAreDeclaredWithASigma) {
  Options options;
  options.board_scale_ratio = 1.001;
  const Experiment experiment = Prepared(SmallRig(), options);
  EXPECT_NEAR(experiment.rig.boards[0].target.square_m / experiment.declared.targets[0].square_m, 1.001, 1e-12);
  EXPECT_NEAR(experiment.declared.targets[0].square_sigma_m, 0.00012, 1e-9);
}

}  // namespace
}  // namespace rigcal::sim
