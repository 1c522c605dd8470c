// How sensors sit on the robots of a rig model: numbers with answers known in closed form, false alarms by drawing.
#include "server/fleet/population/population.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "server/fleet/population/outliers.h"
#include "server/fleet/population/spread.h"

namespace rigcal::fleet {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

using Draw = std::mt19937_64;

Vector6d Normal(Draw& draw) {
  std::normal_distribution<double> normal;
  Vector6d values;
  for (double& value : values) value = normal(draw);
  return values;
}

// Axes of very different size that hang together: a bracket that bends turns and moves its sensor at once.
Matrix6d Mixing(Draw& draw) {
  Matrix6d mixing;
  for (Eigen::Index column = 0; column < 6; ++column) mixing.col(column) = Normal(draw);
  return Vector6d(1e-3, 2e-3, 5e-4, 1e-3, 3e-4, 1e-3).asDiagonal() * mixing;
}

std::vector<Vector6d> Alike(std::size_t robots, Draw& draw) {
  const Matrix6d mixing = Mixing(draw);
  std::vector<Vector6d> offsets;
  for (std::size_t i = 0; i < robots; ++i) offsets.push_back(mixing * Normal(draw));
  return offsets;
}

std::vector<Matrix6d> KnownExactly(std::size_t robots) { return std::vector<Matrix6d>(robots, Matrix6d::Zero()); }

// A robot per offset of `left` and of `top` from where they are drawn.
struct Fleet {
  RigModel model;
  std::vector<RobotPlaces> robots;

  Fleet() {
    model.name = "mars";
    model.reference = SensorId("base");
    model.sensors = {{SensorId("base"), SensorKind::kCamera, Se3(), {}},
                     {SensorId("left"), SensorKind::kCamera,
                      Se3{{0.2, -0.1, 0.3}, Eigen::Quaterniond(0.8, 0.0, 0.6, 0.0)}, PoseLimit{0.005, 0.01}}};
  }
  void Add(const Vector6d& left) {
    RobotPlaces robot;
    robot.robot = RobotId("r" + std::to_string(100 + robots.size()));
    robot.places[SensorId("left")].T_ref_sensor = *model.sensors[1].T_ref_sensor * Se3::Exp(left);
    robots.push_back(robot);
  }
  [[nodiscard]] Population Describe() const { return DescribePopulation(model, model.reference, robots); }
};

TEST(Spread, IsThatOfTheMiddleHalf) {
  const AxisSpread axis = SpreadOf({5.0, 1.0, 2.0, 3.0, 1000.0});
  EXPECT_EQ(axis.min, 1.0);
  EXPECT_EQ(axis.lower, 2.0);
  EXPECT_EQ(axis.median, 3.0);
  EXPECT_EQ(axis.upper, 5.0);
  EXPECT_EQ(axis.max, 1000.0);
  EXPECT_NEAR(axis.spread, 2 * 1.4826, 1e-4);  // 2, 2, 1, 0, 997 away
  EXPECT_DOUBLE_EQ(QuantileOf({0.0, 10.0}, 0.25), 2.5);
}

TEST(Spread, OfNormalValuesIsTheirSigma) {
  Draw draw(7);
  std::normal_distribution<double> normal(3.0, 0.25);
  std::vector<double> values;
  for (int i = 0; i < 100'000; ++i) values.push_back(normal(draw));
  const AxisSpread axis = SpreadOf(values);
  EXPECT_NEAR(axis.median, 3.0, 0.01);
  EXPECT_NEAR(axis.spread, 0.25, 0.01);
}

// Turned and shifted poses: the answer moves along, though none of them is near the identity.
TEST(Spread, TheMedianPoseMovesWithThePoses) {
  Draw draw(3);
  const Se3 T = Se3{{4.0, -2.0, 1.0}, Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5)};
  std::vector<Se3> poses;
  for (int i = 0; i < 31; ++i) poses.push_back(T * Se3::Exp(0.02 * Normal(draw)));
  const Se3 center = MedianPose(poses);
  std::array<std::vector<double>, 6> axes;
  for (const Se3& pose : poses)
    for (std::size_t k = 0; k < 6; ++k)
      axes[k].push_back((center.Inverse() * pose).Log()[static_cast<Eigen::Index>(k)]);
  for (const auto& axis : axes) EXPECT_NEAR(QuantileOf(axis, 0.5), 0.0, 1e-9);
}

// The first by name are upside down: logarithms about them are half turns of either sign.
TEST(Spread, PosesThatAreUpsideDownAreNotTheMedian) {
  Draw draw(41);
  const Se3 T = Se3{{4.0, -2.0, 1.0}, Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5)};
  for (int fleet = 0; fleet < 50; ++fleet) {
    std::vector<Se3> poses(2, T * Se3{{0, 0, 0}, Eigen::Quaterniond(0, 0, 0, 1)});
    while (poses.size() < 5) poses.push_back(T * Se3::Exp(0.005 * Normal(draw)));
    EXPECT_LT((T.Inverse() * MedianPose(poses)).Log().norm(), 0.03) << fleet;
  }
}

// Each axis by itself, so that an axis that is taken for another is seen.
TEST(PopulationTest, OffsetsAreTangentsAtTheDrawnPose) {
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    Fleet fleet;
    for (int i = 0; i < 7; ++i) fleet.Add(Vector6d::Unit(axis) * (0.001 * i));
    const Population population = fleet.Describe();
    ASSERT_THAT(population.sensors, SizeIs(1));
    const SensorPopulation& left = population.sensors.front();
    ASSERT_TRUE(left.T_ref_nominal);
    for (std::size_t k = 0; k < 6; ++k) {
      const bool is_it = static_cast<Eigen::Index>(k) == axis;
      EXPECT_NEAR(left.axes[k].median, is_it ? 0.003 : 0.0, 1e-12);
      EXPECT_NEAR(left.axes[k].max, is_it ? 0.006 : 0.0, 1e-12);
      EXPECT_NEAR(left.axes[k].spread, is_it ? 1.4826 * 0.002 : 0.0, 1e-6);
    }
  }
}

TEST(PopulationTest, FewerThanFiveRobotsTellNothing) {
  Fleet fleet;
  for (int i = 0; i < 4; ++i) fleet.Add(Vector6d::Zero());
  const Population population = fleet.Describe();
  EXPECT_EQ(population.why_not,
            "4 robots of rig model mars have a calibration in use; 5 are needed to tell how they scatter.");
  EXPECT_THAT(population.sensors, IsEmpty());
  EXPECT_THAT(population.too_few, testing::ElementsAre(testing::Pair(SensorId("left"), 4U)));
}

TEST(PopulationTest, WhereNothingIsDrawnOffsetsAreFromTheMedian) {
  Fleet fleet;
  fleet.model.sensors.clear();
  const RigModel drawn = Fleet().model;
  for (int i = 0; i < 5; ++i) {
    fleet.robots.push_back({RobotId("r" + std::to_string(i)), {}});
    fleet.robots.back().places[SensorId("left")].T_ref_sensor =
        *drawn.sensors[1].T_ref_sensor * Se3::Exp(Vector6d::Unit(1) * (0.001 * i));
  }
  const SensorPopulation left = fleet.Describe().sensors.front();
  EXPECT_FALSE(left.T_ref_nominal);
  EXPECT_NEAR(left.axes[1].median, 0.0, 1e-9);
  EXPECT_NEAR(left.axes[1].max, 0.002, 1e-9);
  EXPECT_THAT(OffTheDrawing(fleet.Describe()), IsEmpty());
}

TEST(PopulationTest, ADrawingThatMostRobotsContradictIsTold) {
  Draw draw(11);
  Fleet fleet;
  for (int i = 0; i < 30; ++i) fleet.Add(Vector6d::Unit(2) * 0.012 + 1e-4 * Normal(draw));
  const auto texts = OffTheDrawing(fleet.Describe());
  ASSERT_THAT(texts, SizeIs(1));
  EXPECT_THAT(texts.front(), HasSubstr("left sits 12 mm and 0.0"));
  EXPECT_THAT(texts.front(), HasSubstr("from its nominal (CAD) pose on most robots (5 mm and 0.573 deg allowed)."));
  EXPECT_THAT(OutlierTexts(fleet.Describe()), IsEmpty()) << "all are alike";
}

// Two that are off alike must not hide each other.
TEST(PopulationTest, RobotsThatStandOutAreNamed) {
  Draw draw(5);
  Fleet fleet;
  for (int i = 0; i < 28; ++i) fleet.Add(1e-3 * Normal(draw));
  for (int i = 0; i < 2; ++i) fleet.Add(Vector6d::Unit(0) * 0.03 + 1e-3 * Normal(draw));
  const Population population = fleet.Describe();
  const auto& outliers = population.sensors.front().outliers;
  ASSERT_THAT(outliers, SizeIs(2));
  for (const PopulationOutlier& outlier : outliers) {
    EXPECT_TRUE(outlier.robot == RobotId("r128") || outlier.robot == RobotId("r129")) << outlier.robot.str();
    EXPECT_EQ(outlier.worst_axis, 0U);
    EXPECT_LT(outlier.odds, kPopulationAlpha / 30);
  }
  EXPECT_THAT(OutlierTexts(population).front(), HasSubstr("from where the others have it."));
  EXPECT_TRUE(population.sensors.front().by_distance);
}

TEST(PopulationTest, ADrawingThatIsUpsideDownHidesNoRobot) {
  Draw draw(43);
  Fleet fleet;
  for (int i = 0; i < 29; ++i) fleet.Add(1e-3 * Normal(draw));
  fleet.Add(Vector6d::Unit(4) * 0.02 + 1e-3 * Normal(draw));
  ASSERT_THAT(fleet.Describe().sensors.front().outliers, SizeIs(1));
  Se3& drawn = *fleet.model.sensors[1].T_ref_sensor;
  drawn = drawn * Se3{{0, 0, 0}, Eigen::Quaterniond(0, 0, 0, 1)};
  ASSERT_THAT(fleet.Describe().sensors.front().outliers, SizeIs(1));
  EXPECT_EQ(fleet.Describe().sensors.front().outliers.front().robot, RobotId("r129"));
}

// No axis is far by itself: it is off where the others hang together.
TEST(PopulationTest, ADirectionThatNoOtherRobotHasIsSeen) {
  Draw draw(13);
  Fleet fleet;
  for (int i = 0; i < 60; ++i) {
    Vector6d offset = 1e-4 * Normal(draw);
    offset[4] = 2.0 * offset[0] + 1e-7 * Normal(draw)[0];
    fleet.Add(offset);
  }
  Vector6d odd = Vector6d::Zero();
  odd[0] = 1e-4, odd[4] = -2e-4;
  fleet.Add(odd);
  const Population population = fleet.Describe();
  ASSERT_THAT(population.sensors.front().outliers, SizeIs(1));
  EXPECT_EQ(population.sensors.front().outliers.front().robot, RobotId("r160"));
}

TEST(PopulationTest, APoseThatIsKnownBadlyIsNoOutlier) {
  Draw draw(17);
  Fleet fleet;
  for (int i = 0; i < 30; ++i) fleet.Add(1e-3 * Normal(draw));
  fleet.Add(Vector6d::Unit(1) * 0.05);
  EXPECT_THAT(fleet.Describe().sensors.front().outliers, SizeIs(1));
  fleet.robots.back().places[SensorId("left")].covariance = Matrix6d::Identity() * 0.05 * 0.05;
  EXPECT_THAT(fleet.Describe().sensors.front().outliers, IsEmpty());
}

TEST(PopulationTest, TheOrderOfRobotsDoesNotMatter) {
  Draw draw(19);
  Fleet fleet;
  for (int i = 0; i < 25; ++i) fleet.Add(1e-3 * Normal(draw));
  const Population one = fleet.Describe();
  std::shuffle(fleet.robots.begin(), fleet.robots.end(), draw);
  const Population other = fleet.Describe();
  EXPECT_EQ(one.robots, other.robots);
  EXPECT_EQ(one.sensors.front().offsets, other.sensors.front().offsets);
  EXPECT_EQ(one.sensors.front().axes[3].spread, other.sensors.front().axes[3].spread);
}

TEST(Outliers, RobotsThatAreAllTheSameAccuseNobody) {
  const std::vector<Vector6d> same(9, Vector6d::Ones() * 0.01);
  for (const Distance& distance : DistancesFromOthers(same, KnownExactly(9))) EXPECT_GT(distance.odds, 0.9);
}

TEST(Outliers, WhatIsNoNumberAccusesNobody) {
  Draw draw(23);
  std::vector<Vector6d> offsets = Alike(20, draw);
  std::vector<Matrix6d> covariances = KnownExactly(20);
  covariances[3](0, 0) = std::nan("");
  EXPECT_EQ(DistancesFromOthers(offsets, covariances)[3].odds, 1.0);
}

// Of fleets in which all robots are alike: how often any of them is accused at odds of `alpha` for the whole fleet.
int AccusedFleets(std::size_t robots, int fleets, double alpha, Draw& draw) {
  int accused = 0;
  for (int fleet = 0; fleet < fleets; ++fleet) {
    double least = 1.0;
    for (const Distance& distance : DistancesFromOthers(Alike(robots, draw), KnownExactly(robots)))
      least = std::min(least, distance.odds);
    accused += least < alpha / static_cast<double>(robots) ? 1 : 0;
  }
  return accused;
}

// At the odds that are used: of 1500 fleets 1.5 are to be expected at most; 12 or more have odds of 1e-7.
TEST(Outliers, FalseAlarmsKeepTheirOdds) {
  Draw draw(29);
  for (const std::size_t robots : {5U, 8U, 12U, 19U, 30U})
    EXPECT_LT(AccusedFleets(robots, 1500, kPopulationAlpha, draw), 12) << robots << " robots";
}

// At odds at which they can be counted: 5 % of 2000 fleets are 100, with a sigma of 9.7.
TEST(Outliers, FalseAlarmsAreAsManyAsTheirOddsSay) {
  Draw draw(31);
  for (const std::size_t robots : {5U, 10U, 18U})
    EXPECT_LT(AccusedFleets(robots, 2000, 0.05, draw), 152) << robots << " robots";
  for (const std::size_t robots : {22U, 40U}) {
    const int accused = AccusedFleets(robots, 2000, 0.05, draw);
    EXPECT_LT(accused, 152) << robots << " robots";
    EXPECT_GT(accused, 52) << robots << " robots";
  }
}

// What stands out by eight spreads in one axis is found by a fleet of thirty.
TEST(Outliers, LargeOnesAreFound) {
  Draw draw(37);
  int found = 0;
  for (int fleet = 0; fleet < 200; ++fleet) {
    std::vector<Vector6d> offsets;
    for (int i = 0; i < 30; ++i) offsets.push_back(1e-3 * Normal(draw));
    offsets.back() += Vector6d::Unit(fleet % 6) * 1.2e-2;
    found += DistancesFromOthers(offsets, KnownExactly(30)).back().odds < kPopulationAlpha / 30 ? 1 : 0;
  }
  EXPECT_GT(found, 180);
}

}  // namespace
}  // namespace rigcal::fleet
