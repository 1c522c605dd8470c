// What visits scatter by, from the sessions of some robots to the revision and the as-found test of another.
#include <gmock/gmock.h>

#include "server/math/log_variance.h"
#include "server/pipeline/revisions/revise.h"
#include "server/pipeline/rig_models/population.h"
#include "server/pipeline/sessions/session_refinement.h"
#include "storage/fleet/visit_scatter.h"
#include "storage/revisions/as_found.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/session_estimates.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kStep_m = 3e-4, kStep_rad = 2e-4, kSigma = 1e-4;
constexpr int kOthers = 5, kVisits = 4;
const SensorId kLeft("left"), kRight("right");
const Word kWord{{1'800'000'000'000'000'000}, "Ada", "looked at"};

class PooledScatterTest : public PipelineTest {
 protected:
  // Four visits whose shifts and turns along the three axes are independent of each other, and in the mean zero.
  static Se3 PlaceOn(int visit) {
    const double x = visit < 2 ? 1 : -1, y = visit % 2 == 0 ? 1 : -1, z = x * y;
    const Se3 home{{0.3, 0.0, 0.1}, Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()))};
    return home *
           Se3::Exp((Vector6d() << kStep_m * x, kStep_m * y, kStep_m * z, kStep_rad * x, kStep_rad * y, kStep_rad * z)
                        .finished());
  }
  Manifest ManifestOf(const std::string& robot, int day, const std::string& model) {
    Manifest manifest;
    manifest.header.robot = RobotId(robot);
    manifest.header.rig_model = model;
    manifest.header.reference = kLeft;
    manifest.header.captured_at = {1'700'000'000'000'000'000 + day * kDay_ns};
    Target board;
    board.id = TargetId("board");
    board.cols = 9, board.rows = 6, board.square_m = 0.025;
    manifest.header.targets = {board};
    for (const SensorId& camera : {kLeft, kRight}) {
      Sensor sensor;
      sensor.id = camera;
      sensor.sees = board.id;
      manifest.header.sensors.push_back(sensor);
      AddFile(camera.str() + "/01.png", robot + camera.str() + " on day " + std::to_string(day), manifest);
    }
    return manifest;
  }
  SessionId Store(const Manifest& manifest, const Se3& place) {
    const SessionId session = Close(manifest);
    Edge edge = GivenEdge(manifest.header.robot.str(), kLeft.str(), kRight.str(), 0.0);
    edge.method = "stereo", edge.session = session, edge.T_a_b = place;
    edge.id = EstimatedEdgeId(edge.robot, session, edge.method, kLeft, kRight);
    StoreEdges({edge});
    SessionEstimate estimate;
    estimate.session = session, estimate.reference = kLeft;
    estimate.poses = {{kLeft, {}, 0.0}, {kRight, place, 50.0}};
    estimate.covariance = kSigma * kSigma * Eigen::MatrixXd::Identity(6, 6);
    EXPECT_TRUE(storage::AppendSessionEstimate(*store_, estimate, kSessionEstimator, clock_.now));
    return session;
  }
  SessionId Visit(const std::string& robot, int day, const std::string& model = "mars") {
    SessionId session = Store(ManifestOf(robot, day, model), PlaceOn(day % kVisits));
    Again(robot);
    return session;
  }
  Revision Again(const std::string& robot) {
    const auto revision = Revise(*store_, RobotId(robot), clock_);
    EXPECT_TRUE(revision) << Sentence(revision.error());
    return revision.value_or(Revision{});
  }
  void VisitOthers() {
    for (int robot = 0; robot < kOthers; ++robot)
      for (int day = 0; day < kVisits; ++day) others_.push_back(Visit("r" + std::to_string(robot), day));
  }
  // Degrees of freedom of the right camera's shifts, of each robot but `robot`.
  std::vector<double> DofOfOthers(const std::string& robot, const std::string& model = "mars") {
    std::vector<double> dof;
    const auto others = storage::LoadScatterOfOthers(*store_, RobotId(robot), model, kLeft, 100);
    EXPECT_TRUE(others);
    for (const auto& one : others.value()) dof.push_back(one.at(kRight).translation.dof);
    return dof;
  }
  PooledScatter PoolFor(const std::string& robot) {
    return LoadPooledScatter(*store_, RobotId(robot), "mars", kLeft).value();
  }
  FusedPose FusedOf(const std::string& robot) {
    const auto revision = storage::LoadRevision(*store_, RobotId(robot), 0).value().value();
    return formats::ReadRevisionDocument(revision.document).value().solution.poses[1].fused.value();
  }

  std::vector<SessionId> others_;
};

TEST_F(PooledScatterTest, ANewRobotIsFusedByWhatTheOthersShow) {
  VisitOthers();
  Visit("new", 0);
  const FusedPose fused = FusedOf("new");
  ASSERT_TRUE(fused.pooled_scatter);
  EXPECT_EQ(fused.pooled_scatter->robots, kOthers);
  const double shown_m2 = 4.0 / 3 * kStep_m * kStep_m;  // four visits about their mean
  EXPECT_NEAR(fused.visit_sigma_m, std::sqrt(shown_m2 - kSigma * kSigma), 0.1 * kStep_m);
  // Of each robot nine numbers tell the scale, and three of each axis its share.
  const double of_scale = LogVarianceSpread(9.0 * kOthers), of_shares = LogVarianceSpread(3.0) / kOthers;
  EXPECT_NEAR(fused.scatter_dof.translation, DofOfLogVarianceSpread(of_scale + of_shares), 0.5);
  EXPECT_EQ(fused.scatter.translation.dof, 0.0);
}

TEST_F(PooledScatterTest, TheDocumentIsTheSameAgain) {
  VisitOthers();
  Visit("new", 0);
  const Revision once = Again("new"), twice = Again("new");
  EXPECT_THAT(once.document, HasSubstr("\"pooled\":{\"robots\":5"));
  EXPECT_EQ(once.document, twice.document);
  const auto read = formats::ReadRevisionDocument(once.document);
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(formats::WriteRevisionDocument(*read), once.document);
}

TEST_F(PooledScatterTest, AsFoundOfASecondVisitSeesLess) {
  VisitOthers();
  for (const std::string robot : {"new", "lone"})
    for (int day = 0; day < 2; ++day) Visit(robot, day, robot == "new" ? "mars" : "pluto");
  const AsFound found = storage::LoadAsFound(*store_, {RobotId("new"), 2}).value().value();
  const AsFound alone = storage::LoadAsFound(*store_, {RobotId("lone"), 2}).value().value();
  EXPECT_EQ(found.visits, 1);
  EXPECT_EQ(found.scatter_robots, kOthers);
  EXPECT_EQ(alone.scatter_robots, 0);
  EXPECT_LT(SmallestSeen_m(found), 0.7 * SmallestSeen_m(alone));
}

// What was in use knew of no other robot: the revision with the session does by now.
TEST_F(PooledScatterTest, WhatIsKnownByNowIsTakenWhereTheCalibrationInUseKnewNone) {
  Visit("new", 0);
  EXPECT_FALSE(FusedOf("new").pooled_scatter);
  VisitOthers();
  Visit("new", 1);
  EXPECT_EQ(storage::LoadAsFound(*store_, {RobotId("new"), 2}).value().value().scatter_robots, kOthers);
}

TEST_F(PooledScatterTest, ARobotIsNotHeldAgainstItself) {
  VisitOthers();
  EXPECT_EQ(PoolFor("new").at(kRight).robots, kOthers);
  EXPECT_TRUE(PoolFor("r0").empty()) << "four others are too few";
  EXPECT_EQ(DofOfOthers("r0").size(), kOthers - 1u);
}

TEST_F(PooledScatterTest, WithoutARigModelNothingIsPooled) {
  VisitOthers();
  Visit("new", 0, "");
  EXPECT_FALSE(FusedOf("new").pooled_scatter);
  EXPECT_THAT(storage::LoadRevision(*store_, RobotId("new"), 0).value().value().document, Not(HasSubstr("pooled")));
}

TEST_F(PooledScatterTest, ARetiredSessionTellsNothing) {
  VisitOthers();
  EXPECT_THAT(DofOfOthers("new"), testing::Each(9.0));
  ASSERT_TRUE(storage::RetireSession(*store_, others_.front(), kWord));
  Again("r0");
  EXPECT_THAT(DofOfOthers("new"), testing::ElementsAre(6.0, 9.0, 9.0, 9.0, 9.0));
}

TEST_F(PooledScatterTest, ARetiredSensorTellsNothing) {
  VisitOthers();
  ASSERT_TRUE(storage::RetireSensor(*store_, RobotId("r0"), kRight, kWord));
  Again("r0");
  EXPECT_EQ(DofOfOthers("new").size(), kOthers - 1u);
}

// Pushed again with a corrected header: one visit, not two.
TEST_F(PooledScatterTest, ASupersededSessionCountsOnce) {
  VisitOthers();
  Manifest corrected = ManifestOf("r0", 0, "mars");
  corrected.header.operator_name = "Eve";
  Store(corrected, PlaceOn(0));
  Again("r0");
  EXPECT_THAT(DofOfOthers("new"), testing::Each(9.0));
}

TEST_F(PooledScatterTest, ARobotOfAnotherModelLeaves) {
  VisitOthers();
  Visit("r0", 4, "venus");
  EXPECT_EQ(DofOfOthers("new").size(), kOthers - 1u);
  EXPECT_THAT(DofOfOthers("new", "venus"), testing::ElementsAre(12.0));
}

// Its visits tell of the move, until an epoch of it begins.
TEST_F(PooledScatterTest, ASensorThatMovedBetweenVisitsTellsNothing) {
  VisitOthers();
  const Se3 moved = PlaceOn(0) * Se3::Exp((Vector6d() << 0.05, 0, 0, 0, 0, 0).finished());
  for (int day = 4; day < 7; ++day)
    Store(ManifestOf("r0", day, "mars"), moved * PlaceOn(0).Inverse() * PlaceOn(day % kVisits));
  Again("r0");
  EXPECT_EQ(DofOfOthers("new").size(), kOthers - 1u);
}

}  // namespace
}  // namespace rigcal::pipeline
