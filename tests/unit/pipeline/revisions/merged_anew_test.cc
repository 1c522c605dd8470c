// A robot whose merged edges hold information that nobody measured, as an older version added them up.
#include <SQLiteCpp/SQLiteCpp.h>

#include <random>

#include "server/math/tangent.h"
#include "server/model/edges/merged_edge.h"
#include "server/pipeline/revisions/revise.h"
#include "storage/revisions/merged_edges.h"
#include "storage/revisions/revisions.h"
#include "storage/settings/policies.h"
#include "tests/unit/pipeline/fixture.h"
#include "tests/unit/storage/old_store.h"

namespace rigcal::pipeline {
namespace {

const RobotId kOpen("open"), kSound("sound");

class MergedAnewTest : public PipelineTest {
 protected:
  // Of each robot an edge whose turn about its own x nobody measured, the axis off by noise; and revisions.
  void Weeks(int weeks) {
    std::mt19937 random(5);
    std::normal_distribution<double> off_rad(0.0, 1e-3);
    for (int week = 0; week < weeks; ++week) {
      clock_.now.ns += 7 * kDay_ns;
      Edge open = GivenEdge("open", "a", "b", 1.0), sound = GivenEdge("sound", "a", "b", 1.0 + 1e-7 * week);
      Matrix6d Omega = Matrix6d::Identity() * 1e6;
      Omega(tangent::kRotation, tangent::kRotation) = 0.0;
      open.uncertainty = FromInformation(Omega, UncertaintySource::kGiven, 0);
      const Eigen::Vector3d turn(0.0, off_rad(random), off_rad(random));
      open.T_a_b.q = Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
      for (const Edge& edge : {open, sound}) {
        std::vector<Edge> edges{edge};
        AssignPushedIds(edges);
        StoreEdges(edges);
        ASSERT_TRUE(Revise(*store_, edge.robot, clock_));
      }
    }
  }
  [[nodiscard]] MergedEdge MergedOf(const RobotId& robot) {
    return storage::LoadMergedEdges(*store_, robot).value().front();
  }
  [[nodiscard]] int Newest(const RobotId& robot) {
    return storage::LoadRevisionSummary(*store_, robot, 0).value().value().number;
  }
  void Reopen() { store_ = std::make_unique<storage::Store>(storage::Store::Open(folder_).value()); }

  // As the version before left it: the plain sum in the merged edges of the one with an open axis.
  void MakeOld() {
    store_.reset();
    const auto files = storage::SchemaFiles();
    const auto found = std::find_if(files.begin(), files.end(),
                                    [](const auto& path) { return path.filename() == "0057_merge_anew.sql"; });
    const Matrix6d sum = Matrix6d::Identity() * 1e6;
    SQLite::Database old((folder_ / "rigcal.db").string(), SQLite::OPEN_READWRITE, 0, storage::SummingFiles());
    old.exec(
        "DROP TABLE merge_state_window; DROP TABLE waiting_merge_anew; DROP TABLE merged_edge_weak; "
        "DROP TRIGGER merged_edge_no_update;");
    SQLite::Statement update(old, "UPDATE merged_edge SET information = ? WHERE robot_id = 'open'");
    update.bind(1, sum.data(), 288);
    update.exec();
    old.exec(
        "CREATE TRIGGER merged_edge_no_update BEFORE UPDATE ON merged_edge BEGIN SELECT RAISE(ABORT, 'append-only'); "
        "END; PRAGMA user_version = " +
        std::to_string(found - files.begin()));
  }
};

TEST_F(MergedAnewTest, OnceAfterAStartFromAllEdges) {
  Weeks(14);
  StepAll();  // reports, which name merged edges as they are
  const Matrix6d measured = MergedOf(kOpen).Omega;
  ASSERT_EQ(FromInformation(measured, UncertaintySource::kGiven, 0).rank, 5);
  const int before = Newest(kOpen), sound = Newest(kSound);
  MakeOld();
  Reopen();
  ASSERT_EQ(FromInformation(MergedOf(kOpen).Omega, UncertaintySource::kGiven, 0).rank, 6);
  Reopen();  // it was ended before it did anything: the robot waits on
  EXPECT_EQ(*storage::LoadRobotsToJudge(*store_, RobotId(), 9), std::vector<RobotId>{kOpen});
  testing::internal::CaptureStderr();
  StepAll();
  const std::string log = testing::internal::GetCapturedStderr();
  EXPECT_NE(log.find("robot open: 6 of its 14 edges merged anew; robots still to be merged anew: 0"), std::string::npos)
      << log;
  EXPECT_EQ(Newest(kOpen), before + 1);
  EXPECT_EQ(Newest(kSound), sound);
  EXPECT_LT((MergedOf(kOpen).Omega - measured).norm(), 1e-9 * measured.norm());
  EXPECT_EQ(MergedOf(kOpen).count, 6);
  Reopen();
  StepAll();
  EXPECT_EQ(Newest(kOpen), before + 1);
}

TEST_F(MergedAnewTest, WaitsNoMoreWhereItIsGivenUp) {
  Weeks(14);
  StepAll();
  MakeOld();
  Reopen();
  EXPECT_TRUE(*storage::IsUnsolved(*store_, kOpen));
  ASSERT_TRUE(Revise(*store_, kOpen, clock_, 0, false));
  EXPECT_EQ(FromInformation(MergedOf(kOpen).Omega, UncertaintySource::kGiven, 0).rank, 6);  // as they were made
  EXPECT_TRUE(storage::LoadRobotsToJudge(*store_, RobotId(), 9)->empty());
  EXPECT_FALSE(*storage::IsUnsolved(*store_, kOpen));
  const int before = Newest(kOpen);
  StepAll();
  EXPECT_EQ(Newest(kOpen), before);
}

}  // namespace
}  // namespace rigcal::pipeline
