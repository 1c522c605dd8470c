// The poses of a revision and their joint covariance come back as they were given.
#include "storage/revisions/revision_poses.h"

#include <gmock/gmock.h>

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
