#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "storage/database/query.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class EdgesTest : public StoreTest {
 protected:
  Edge RoundTrip(const Edge& edge) {
    EXPECT_TRUE(AppendEdge(store_, edge, {1}));
    Result<std::optional<Edge>> loaded = LoadEdge(store_, edge.id);
    EXPECT_TRUE(loaded) << WordsOf(loaded);
    return loaded->value();
  }
  double Number(const std::string& sql) { return RealIn(store_, sql); }
};

// Bit by bit.
template <typename Matrix>
bool Same(const Matrix& a, const Matrix& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

TEST_F(EdgesTest, PoseAndUncertaintyComeBackBitForBit) {
  const Edge edge = MakeEdge(3);
  ASSERT_EQ(edge.uncertainty.rank, 5);
  const Edge loaded = RoundTrip(edge);
  EXPECT_EQ(loaded.id, edge.id);
  EXPECT_EQ(loaded.robot, edge.robot);
  EXPECT_EQ(loaded.frame_a, edge.frame_a);
  EXPECT_EQ(loaded.frame_b, edge.frame_b);
  EXPECT_EQ(loaded.method, edge.method);
  EXPECT_TRUE(loaded.session.empty());
  EXPECT_EQ(loaded.epoch, 2);
  EXPECT_EQ(loaded.state, EdgeState::kGood);
  EXPECT_TRUE(Same(loaded.T_a_b.p_m, edge.T_a_b.p_m));
  EXPECT_TRUE(Same(loaded.T_a_b.q.coeffs(), edge.T_a_b.q.coeffs()));
  EXPECT_TRUE(Same(loaded.uncertainty.Omega, edge.uncertainty.Omega));
  EXPECT_EQ(loaded.uncertainty.rank, 5);
  EXPECT_EQ(loaded.uncertainty.dof, 12);
  EXPECT_EQ(loaded.uncertainty.source, UncertaintySource::kJackknife);
  EXPECT_TRUE(Same(loaded.uncertainty.covariance, edge.uncertainty.covariance));
  EXPECT_TRUE(Same(loaded.uncertainty.unobservable_basis, edge.uncertainty.unobservable_basis));
}

TEST_F(EdgesTest, BlocksAndContributionsComeBackInOrder) {
  const Edge edge = MakeEdge(3);
  const Uncertainty loaded = RoundTrip(edge).uncertainty;
  ASSERT_EQ(loaded.blocks.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(loaded.blocks[i].block_id, edge.uncertainty.blocks[i].block_id);
    EXPECT_TRUE(Same(loaded.blocks[i].d, edge.uncertainty.blocks[i].d));
  }
  EXPECT_EQ(loaded.jackknife_ratio, 0.1 + 0.2);
  ASSERT_EQ(loaded.contributions.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(loaded.contributions[i].name, edge.uncertainty.contributions[i].name);
    EXPECT_TRUE(Same(loaded.contributions[i].covariance, edge.uncertainty.contributions[i].covariance));
  }
}

TEST_F(EdgesTest, WordsFiguresCapturesAndEvidenceComeBack) {
  const Edge edge = MakeEdge(3);
  const Edge loaded = RoundTrip(edge);
  EXPECT_EQ(loaded.diagnoses, edge.diagnoses);
  EXPECT_EQ(loaded.figures, edge.figures);
  ASSERT_EQ(loaded.captures.size(), 2u);
  EXPECT_EQ(loaded.captures[1].capture, CaptureId("c1"));
  EXPECT_EQ(loaded.captures[1].rms, 4.5);
  EXPECT_FALSE(loaded.captures[1].used);
  EXPECT_TRUE(loaded.captures[0].used);
  EXPECT_EQ(loaded.captures[1].note, "an outlier");
  ASSERT_EQ(loaded.evidence.size(), 1u);
  EXPECT_EQ(loaded.evidence[0].title, "left / c0: 54 corners");
  EXPECT_EQ(loaded.evidence[0].sensor, SensorId("left"));
  EXPECT_EQ(loaded.evidence[0].capture, CaptureId("c0"));
  EXPECT_EQ(loaded.evidence[0].digest, DigestOf("picture"));
  EXPECT_EQ(loaded.evidence[0].suffix, "jpg");
}

// What SQL readers see, each axis by its own name.
TEST_F(EdgesTest, EachAxisOfThePoseHasItsColumn) {
  const char* const columns[6] = {"T_a_b_x_m", "T_a_b_y_m", "T_a_b_z_m", "T_a_b_qx", "T_a_b_qy", "T_a_b_qz"};
  for (int axis = 0; axis < 6; ++axis) {
    Edge edge = MakeEdge(axis);
    edge.T_a_b = Se3{};
    if (axis < 3) edge.T_a_b.p_m = 0.25 * Eigen::Vector3d::Unit(axis);
    if (axis >= 3) edge.T_a_b.q = Eigen::Quaterniond(Eigen::AngleAxisd(1.0, Eigen::Vector3d::Unit(axis - 3)));
    ASSERT_TRUE(AppendEdge(store_, edge, {1}));
    const std::string row = " FROM edge WHERE edge_id = '" + edge.id.str() + "'";
    for (int other = 0; other < 6; ++other)
      EXPECT_DOUBLE_EQ(Number(std::string("SELECT ") + columns[other] + row), other != axis ? 0.0
                                                                              : axis < 3    ? 0.25
                                                                                            : std::sin(0.5));
  }
}

// Likewise: six doubles a block, one id a line; zero has no sign.
TEST_F(EdgesTest, BlockVectorsLieOneBehindTheOther) {
  Edge edge = MakeEdge(1);
  edge.uncertainty.blocks = {{"c0", Vector6d::Zero()}, {"c1", Vector6d::Zero()}};
  edge.uncertainty.blocks[0].d(1) = -0.0;
  edge.uncertainty.blocks[1].d(tangent::kRy) = 0.5;
  ASSERT_TRUE(AppendEdge(store_, edge, {1}));
  Query query(store_, "SELECT block_ids, d FROM edge_blocks");
  ASSERT_TRUE(query.Step());
  EXPECT_EQ(query.Text(0), "c0\nc1\n");
  const std::vector<double> values = query.Doubles(1);
  ASSERT_EQ(values.size(), 12u);
  EXPECT_FALSE(std::signbit(values[1]));
  EXPECT_EQ(values[6 + tangent::kRy], 0.5);
}

// Stores from before version 39 have a row a block, and keep them.
TEST_F(EdgesTest, BlocksOfARowEachAreReadToo) {
  Edge edge = MakeEdge(1);
  edge.uncertainty.blocks.clear();
  ASSERT_TRUE(AppendEdge(store_, edge, {1}));
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(2), {1}));
  for (int idx = 1; idx >= 0; --idx)
    Query(store_,
          "INSERT INTO edge_block SELECT number, ?1, 'c' || CAST(?1 AS TEXT), 1, 2, 3, 4, 5, 6 FROM edge "
          "WHERE edge_id = ?2")
        .Bind(idx, edge.id)
        .Run();
  const auto blocks = LoadEdge(store_, edge.id).value()->uncertainty.blocks;
  ASSERT_EQ(blocks.size(), 2u);
  EXPECT_EQ(blocks[1].block_id, "c1");
  EXPECT_EQ(blocks[1].d, (Vector6d() << 1, 2, 3, 4, 5, 6).finished());
  EXPECT_EQ(LoadEdge(store_, MakeEdge(2).id).value()->uncertainty.blocks.size(), 3u);
}

// The layout that the schema's comments promise to other readers: doubles, little-endian, row by row.
TEST_F(EdgesTest, InformationIsRowByRow) {
  Edge edge = MakeEdge(1);
  for (int row = 0; row < 6; ++row)
    for (int col = 0; col < 6; ++col) edge.uncertainty.Omega(row, col) = 10 * row + col;
  ASSERT_TRUE(AppendEdge(store_, edge, {1}));
  Query query(store_, "SELECT information, unobservable_basis FROM edge");
  ASSERT_TRUE(query.Step());
  const std::string bytes = query.Text(0);
  ASSERT_EQ(bytes.size(), 288u);
  double row_2_col_5 = 0.0;
  std::memcpy(&row_2_col_5, bytes.data() + 8 * (6 * 2 + 5), 8);
  EXPECT_EQ(row_2_col_5, 25.0);
  EXPECT_EQ(query.Text(1).size(), 48u);
}

TEST_F(EdgesTest, AFullRankEdgeHasAnEmptyBasis) {
  Edge edge = MakeEdge(1);
  edge.uncertainty = FromInformation(Matrix6d::Identity(), UncertaintySource::kGiven, 0);
  const Edge loaded = RoundTrip(edge);
  EXPECT_EQ(loaded.uncertainty.rank, 6);
  EXPECT_EQ(loaded.uncertainty.unobservable_basis.cols(), 0);
  EXPECT_EQ(loaded.uncertainty.source, UncertaintySource::kGiven);
}

TEST_F(EdgesTest, AFailedEdgeKeepsItsReasonAndNoNumbers) {
  Edge failed = MakeFailedEdge(1);
  failed.T_a_b.p_m.x() = kNan;
  const Edge loaded = RoundTrip(failed);
  EXPECT_EQ(loaded.state, EdgeState::kFailed);
  EXPECT_EQ(loaded.diagnoses, failed.diagnoses);
  EXPECT_TRUE(loaded.T_a_b.p_m.isZero());
  EXPECT_EQ(Number("SELECT count(*) FROM edge WHERE T_a_b_x_m IS NULL AND information IS NULL AND rank IS NULL"), 1);
}

TEST_F(EdgesTest, WhatIsNotFiniteIsRefusedByName) {
  const auto refused = [&](const std::function<void(Edge&)>& spoil) {
    Edge edge = MakeEdge(1);
    spoil(edge);
    const Status done = AppendEdge(store_, edge, {1});
    EXPECT_EQ(done ? ErrorCode::kInternal : done.error().code, ErrorCode::kInvalidInput);
    return done ? "accepted" : done.error().what;
  };
  EXPECT_THAT(refused([](Edge& edge) { edge.T_a_b.q.y() = kNan; }), HasSubstr("T_a_b"));
  EXPECT_THAT(refused([](Edge& edge) { edge.uncertainty.Omega(5, 5) = kNan; }), HasSubstr("information"));
  EXPECT_THAT(refused([](Edge& edge) { edge.uncertainty.covariance(0, 1) = kNan; }), HasSubstr("covariance"));
  EXPECT_THAT(refused([](Edge& edge) { edge.uncertainty.blocks[1].d(4) = kNan; }), HasSubstr("block vector c1"));
  EXPECT_THAT(refused([](Edge& edge) { edge.uncertainty.blocks[1].block_id = "a\nb"; }), HasSubstr("one line"));
  EXPECT_THAT(refused([](Edge& edge) { edge.uncertainty.contributions[0].covariance(0, 0) = kNan; }),
              HasSubstr("board size"));
  EXPECT_THAT(refused([](Edge& edge) { edge.uncertainty.rank = 6; }), HasSubstr("rank"));
  EXPECT_THAT(refused([](Edge& edge) { edge.uncertainty.dof = -1; }), HasSubstr("dof"));
  EXPECT_THAT(refused([](Edge& edge) { edge.uncertainty.jackknife_ratio = kNan; }), HasSubstr("jackknife_ratio"));
  EXPECT_THAT(refused([](Edge& edge) { edge.figures["rms_px"] = kNan; }), HasSubstr("figure rms_px"));
  EXPECT_THAT(refused([](Edge& edge) { edge.captures[1].rms = kNan; }), HasSubstr("capture c1"));
  EXPECT_THAT(refused([](Edge& edge) { edge.id = EdgeId("short"); }), HasSubstr("edge id"));
  EXPECT_EQ(LoadEdgeWatermark(store_, kRobot).value(), 0);
}

TEST_F(EdgesTest, AppendingAgainChangesNothing) {
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {1}));
  Edge again = MakeEdge(1);
  again.method = "another";
  ASSERT_TRUE(AppendEdge(store_, again, {2}));
  EXPECT_EQ(LoadEdgeWatermark(store_, kRobot).value(), 1);
  EXPECT_EQ(LoadEdge(store_, again.id).value()->method, "stereo");
  EXPECT_EQ(LoadEdge(store_, again.id).value()->uncertainty.blocks.size(), 3u);
}

TEST_F(EdgesTest, ListsAreSortedByIdAndEachKeepsItsOwnParts) {
  for (int seed = 0; seed < 20; ++seed) {
    Edge edge = MakeEdge(seed);
    edge.uncertainty.blocks[0].block_id = "of " + std::to_string(seed);
    ASSERT_TRUE(AppendEdge(store_, edge, {1}));
  }
  ASSERT_TRUE(AppendEdge(store_, MakeFailedEdge(1), {1}));
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1, RobotId("mapper-02")), {1}));
  const std::vector<Edge> edges = LoadEdges(store_, kRobot, true).value();
  ASSERT_EQ(edges.size(), 21u);
  for (std::size_t i = 1; i < edges.size(); ++i) EXPECT_LT(edges[i - 1].id, edges[i].id);
  for (const Edge& edge : edges) {
    if (edge.state != EdgeState::kGood) continue;
    EXPECT_EQ(edge.uncertainty.blocks[0].block_id, "of " + edge.frame_b.str().substr(1));
  }
  const std::vector<Edge> without_blocks = LoadEdges(store_, kRobot, false).value();
  EXPECT_EQ(without_blocks.size(), 21u);
  for (const Edge& edge : without_blocks) EXPECT_TRUE(edge.uncertainty.blocks.empty());
}

TEST_F(EdgesTest, ASessionHasItsOwnEdges) {
  const SessionId session = AppendOpenSession(store_, 1);
  Edge edge = MakeEdge(1);
  edge.session = session;
  ASSERT_TRUE(AppendEdge(store_, edge, {1}));
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(2), {1}));
  const std::vector<Edge> edges = LoadEdges(store_, session).value();
  ASSERT_EQ(edges.size(), 1u);
  EXPECT_EQ(edges[0].id, edge.id);
  EXPECT_EQ(edges[0].session, session);
  EXPECT_EQ(edges[0].uncertainty.blocks.size(), 3u);
}

TEST_F(EdgesTest, AnEdgeWasMeasuredWhenItSaysElseWhenItCame) {
  Edge dated = MakeEdge(1);
  dated.measured_at = Stamp{1'234'567'890'123'456'789};
  ASSERT_TRUE(AppendEdge(store_, dated, {50}));
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(2), {60}));
  Edge of_session = MakeEdge(3);
  of_session.session = AppendOpenSession(store_, 1);
  ASSERT_TRUE(AppendEdge(store_, of_session, {70}));
  EXPECT_EQ(LoadEdge(store_, dated.id).value()->measured_at, dated.measured_at);
  EXPECT_FALSE(LoadEdge(store_, MakeEdge(2).id).value()->measured_at);
  const auto at = LoadMeasuredAt(store_, {dated, MakeEdge(2), of_session}).value();
  EXPECT_EQ(at.at(dated.id), *dated.measured_at);
  EXPECT_EQ(at.at(MakeEdge(2).id), Stamp{60});
  EXPECT_EQ(at.at(of_session.id), MakeManifest(1).header.captured_at);
}

TEST_F(EdgesTest, TheWatermarkGrowsWithEachEdgeOfTheRobot) {
  const RobotId other("mapper-02");
  EXPECT_EQ(LoadEdgeWatermark(store_, kRobot).value(), 0);
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {1}));
  const std::int64_t first = LoadEdgeWatermark(store_, kRobot).value();
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(2, other), {1}));
  EXPECT_EQ(LoadEdgeWatermark(store_, kRobot).value(), first);
  EXPECT_GT(LoadEdgeWatermark(store_, other).value(), first);
  ASSERT_TRUE(AppendEdge(store_, MakeFailedEdge(1), {1}));
  EXPECT_GT(LoadEdgeWatermark(store_, kRobot).value(), LoadEdgeWatermark(store_, other).value());
}

}  // namespace
}  // namespace rigcal::storage
