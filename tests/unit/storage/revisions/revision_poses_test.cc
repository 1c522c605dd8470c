// The poses of a revision and their joint covariance come back as they were given.
#include "storage/revisions/revision_poses.h"

#include <gmock/gmock.h>

#include "storage/revisions/revision_made.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using RevisionPosesTest = StoreTest;

JointPoses SomePoses() {
  JointPoses poses;
  poses.reference = SensorId("left");
  Vector6d xi;
  xi << 1, 2, 3, 0.1, -0.2, 0.3;
  poses.T_ref_sensor = {
      {SensorId("left"), {}}, {SensorId("right"), Se3::Exp(xi)}, {SensorId("top"), Se3::Exp(0.5 * xi)}};
  Eigen::MatrixXd F = Eigen::MatrixXd::Random(12, 20);
  const Eigen::MatrixXd whole = F * F.transpose();
  poses.covariances = {{{SensorId("top")}, 1e-6 * Eigen::MatrixXd::Identity(6, 6)},
                       {{SensorId("right"), SensorId("top")}, (whole + whole.transpose()) / 2}};
  return poses;
}

TEST_F(RevisionPosesTest, ComeBackToTheBit) {
  const JointPoses poses = SomePoses();
  int number = 0;
  ASSERT_TRUE(store_.Write([&]() -> Status {
    RIGCAL_ASSIGN(number, AppendRevision(store_, MakeRevision(1)));
    return AppendRevisionPoses(store_, {kRobot, number}, poses);
  }));
  const auto loaded = LoadRevisionPoses(store_, {kRobot, number});
  ASSERT_TRUE(loaded && *loaded) << WordsOf(loaded);
  EXPECT_EQ((*loaded)->reference, poses.reference);
  EXPECT_EQ((*loaded)->T_ref_sensor, poses.T_ref_sensor);
  ASSERT_EQ((*loaded)->covariances.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ((*loaded)->covariances[i].sensors, poses.covariances[i].sensors);
    EXPECT_EQ((*loaded)->covariances[i].matrix, poses.covariances[i].matrix);
  }
}

TEST_F(RevisionPosesTest, OfARevisionFromBeforeThereAreNone) {
  int number = 0;
  ASSERT_TRUE(store_.Write([&]() -> Status {
    RIGCAL_ASSIGN(number, AppendRevision(store_, MakeRevision(1)));
    return {};
  }));
  const auto loaded = LoadRevisionPoses(store_, {kRobot, number});
  ASSERT_TRUE(loaded) << WordsOf(loaded);
  EXPECT_FALSE(*loaded);
}

PlacedPoses SomePlaces() {
  PlacedPoses placed;
  const JointPoses known = SomePoses();
  placed.reference = known.reference;
  placed.sensors = known.covariances[1].sensors;
  for (const SensorId& sensor : placed.sensors) placed.T_ref_sensor.push_back(known.T_ref_sensor.at(sensor));
  placed.covariance = known.covariances[1].matrix;
  placed.motions = Eigen::MatrixXd::Random(12, 2);
  placed.scale << 0.3, 0.3, 0.3, 1, 1, 1;
  placed.visible = 1.0 / 3.0;
  return placed;
}

TEST_F(RevisionPosesTest, OfPartsComeBackToTheBit) {
  const PlacedPoses placed = SomePlaces();
  ASSERT_TRUE(store_.Write([&]() -> Status {
    RIGCAL_ASSIGN(const int number, AppendRevision(store_, MakeRevision(1)));
    return AppendPlacedPoses(store_, {kRobot, number}, placed);
  }));
  const auto loaded = LoadPlacedPoses(store_, {kRobot, 1});
  ASSERT_TRUE(loaded && *loaded) << WordsOf(loaded);
  EXPECT_EQ((*loaded)->reference, placed.reference);
  EXPECT_EQ((*loaded)->sensors, placed.sensors);
  EXPECT_EQ((*loaded)->T_ref_sensor, placed.T_ref_sensor);
  EXPECT_EQ((*loaded)->covariance, placed.covariance);
  EXPECT_EQ((*loaded)->motions, placed.motions);
  EXPECT_EQ((*loaded)->scale, placed.scale);
  EXPECT_EQ((*loaded)->visible, placed.visible);
  const auto none = LoadPlacedPoses(store_, {kRobot, 2});
  EXPECT_TRUE(none && !*none);
}

TEST_F(RevisionPosesTest, PlacesOfAnotherSizeAreRefused) {
  PlacedPoses damaged = SomePlaces();
  damaged.T_ref_sensor.pop_back();
  ASSERT_TRUE(store_.Write([&]() -> Status {
    RIGCAL_ASSIGN(const int number, AppendRevision(store_, MakeRevision(1)));
    return AppendPlacedPoses(store_, {kRobot, number}, damaged);
  }));
  const auto loaded = LoadPlacedPoses(store_, {kRobot, 1});
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ErrorCode::kStorage);
}

TEST_F(RevisionPosesTest, HowARevisionWasMadeStaysWithIt) {
  ASSERT_TRUE(store_.Write([&]() -> Status {
    for (const std::optional<int> in_use : {std::optional<int>(), std::optional<int>(1)}) {
      RIGCAL_ASSIGN(const int number, AppendRevision(store_, MakeRevision(1)));
      RIGCAL_TRY(AppendRevisionMade(store_, {kRobot, number}, {"1.2.3", in_use}));
    }
    return {};
  }));
  const auto first = LoadRevisionMade(store_, {kRobot, 1}), second = LoadRevisionMade(store_, {kRobot, 2});
  ASSERT_TRUE(first && *first && second && *second) << WordsOf(first);
  EXPECT_EQ((*first)->software, "1.2.3");
  EXPECT_FALSE((*first)->in_use);
  EXPECT_EQ((*second)->in_use, 1);
  const auto none = LoadRevisionMade(store_, {kRobot, 3});
  EXPECT_TRUE(none && !*none);
}

// A damaged file is told, not read as numbers.
TEST_F(RevisionPosesTest, AMatrixOfAnotherSizeIsRefused) {
  int number = 0;
  ASSERT_TRUE(store_.Write([&]() -> Status {
    RIGCAL_ASSIGN(number, AppendRevision(store_, MakeRevision(1)));
    JointPoses poses = SomePoses();
    poses.covariances[1].sensors.pop_back();
    return AppendRevisionPoses(store_, {kRobot, number}, poses);
  }));
  const auto loaded = LoadRevisionPoses(store_, {kRobot, number});
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ErrorCode::kStorage);
}

}  // namespace
}  // namespace rigcal::storage
