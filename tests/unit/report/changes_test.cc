// What changed between two revisions, which robots a page of the fleet shows, and what the scripts are given.
#include "server/report/text/changes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/report/edges/edge_fit.h"
#include "server/report/edges/page_data.h"
#include "server/report/robot_pages.h"
#include "server/report/text/edge_moves.h"
#include "server/report/text/influence.h"
#include "server/report/text/moved_text.h"
#include "server/report/text/sigmas.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(ReportChanges, MoveIsMeasuredAlongTheSensorsOwnAxes) {
  for (int axis = 0; axis < 6; ++axis) {
    const formats::RevisionInput before = SampleReport().revision;
    formats::RevisionInput now = before;
    Vector6d step = Vector6d::Zero();
    step(axis) = 0.004;
    now.solution.poses[3].T_ref_sensor = before.solution.poses[3].T_ref_sensor * Se3::Exp(step);  // rear: turned by 3.1
    const Changes changes = Compare(before, now);
    ASSERT_FALSE(changes.moves.empty());
    EXPECT_EQ(changes.moves[0].sensor, SensorId("rear"));
    EXPECT_LT((changes.moves[0].d - step).norm(), 1e-12) << axis;
    EXPECT_NEAR(changes.moves[0].in_sigmas, 0.004 / changes.moves[0].sigma(axis), 1e-9);
    EXPECT_NEAR(changes.moves[0].distance_m, axis < 3 ? 0.004 : 0.0, 1e-12);
  }
}

TEST(ReportChanges, NamesWhatCameAndWhatWent) {
  const formats::RevisionInput before = SampleReport().revision;
  formats::RevisionInput now = before;
  now.solution.poses[4].known = false;
  now.solution.poses[5].known = true;
  now.edges[1].id = EdgeId(Sha256Of("new").str());
  const Changes changes = Compare(before, now);
  EXPECT_THAT(changes.sensors_lost, ElementsAre(SensorId("top")));
  EXPECT_THAT(changes.sensors_gained, ElementsAre(SensorId("tracker")));
  ASSERT_EQ(changes.edges_gained.size(), 1U);
  EXPECT_EQ(changes.edges_gained[0], &now.edges[1]);
  ASSERT_EQ(changes.edges_lost.size(), 1U);
  EXPECT_EQ(changes.edges_lost[0], &before.edges[1]);
}

TEST(ReportChanges, PosesInDifferentFramesAreNotCompared) {
  formats::RevisionInput now = SampleReport().revision;
  now.reference = SensorId("lidar");
  const Changes changes = Compare(SampleReport().revision, now);
  EXPECT_FALSE(changes.same_reference);
  EXPECT_TRUE(changes.moves.empty());
}

TEST(ReportChanges, PageSaysWhatMoved) {
  ReportInput input = SampleReport();
  input.previous = PastRevision{6, input.revision};
  input.previous->revision.verdict.level = VerdictLevel::kPass;
  input.revision.solution.poses[2].T_ref_sensor.p_m.x() += 0.05;  // lidar: 45 sigma
  const std::string page = RenderRevision(input, "{}").value().at("index.html");
  EXPECT_THAT(page, HasSubstr("The verdict went from pass to warn."));
  EXPECT_THAT(page, HasSubstr("1 pose changed by more than 3 \xCF\x83."));
  EXPECT_THAT(page, HasSubstr("<bdi>lidar</bdi></th><td>50.0</td>"));
}

TEST(ReportChanges, ASensorThatSatElsewhereIsNotContradictedByTheMeanOfVisits) {
  ReportInput input = SampleReport();
  input.previous = PastRevision{6, input.revision};
  input.as_found = AsFound{};
  input.as_found->sensors.push_back({SensorId("lidar"), FoundState::kDrifted});
  const std::string page = RenderRevision(input, "{}").value().at("index.html");
  EXPECT_THAT(page, HasSubstr("No pose changed by more than 3 \xCF\x83."));
  EXPECT_THAT(page, HasSubstr("lidar sat elsewhere in the newest session"));
  input.as_found->sensors[0].state = FoundState::kUnchanged;
  EXPECT_THAT(RenderRevision(input, "{}").value().at("index.html"), Not(HasSubstr("elsewhere in the newest")));
}

TEST(ReportSigmas, OneScaleForAllPages) {
  const std::pair<double, const char*> cases[] = {
      {0.99, "fit0"}, {1.0, "fit1"}, {2.0, "fit2"}, {2.99, "fit2"}, {3.0, "fit3"}};
  for (const auto& [in_sigmas, name] : cases) EXPECT_STREQ(SigmasClass(in_sigmas), name);
  EXPECT_EQ(SigmasText(2.99), "2.9");  // "3.0" would look like the limit
  EXPECT_EQ(SigmasText(2.66), "2.7");
  EXPECT_EQ(SigmasText(118.68), "118.7");
}

Changes Moved(std::initializer_list<double> in_sigmas) {
  Changes changes;
  for (const double sigmas : in_sigmas) {
    SensorMove move;
    move.sensor = SensorId("s" + std::to_string(changes.moves.size()));
    move.distance_m = 0.0019, move.angle_rad = 0.003, move.in_sigmas = sigmas;
    changes.moves.push_back(move);
  }
  return changes;
}

TEST(ReportMoved, OneSentence) {
  const auto said = [](const Changes& changes) { return WhatMoved(changes, SensorId("base")).sentence; };
  EXPECT_EQ(said(Moved({2.7, 1.0})),
            "Nothing moved: every sensor is where it was, to within 1.9 mm and 0.17 deg (2.7 \xCF\x83).");
  EXPECT_EQ(
      said(Moved({67.7, 2.9, 1.0})),
      "s0 moved by 1.9 mm and 0.17 deg (67.7 \xCF\x83). The other 2 are where they were, to within 2.9 \xCF\x83.");
  EXPECT_THAT(said(Moved({9.0, 1.0})), HasSubstr("The other one is where it was, to within 1.0"));
  EXPECT_THAT(said(Moved({9.0, 5.0, 1.0})), HasSubstr("2 of 3 sensors moved, most of all s0, by 1.9 mm"));
  EXPECT_THAT(said(Moved({9.0, 5.0})), HasSubstr("look first whether base itself moved"));
  EXPECT_THAT(said({}), HasSubstr("No sensor but the reference"));
  EXPECT_TRUE(WhatMoved(Moved({3.0}), SensorId("base")).moved);
  EXPECT_FALSE(WhatMoved(Moved({2.9}), SensorId("base")).moved);
}

// Where nobody looked, nothing is known to have stayed.
TEST(ReportMoved, WhatWasNotMeasuredAnewIsNamed) {
  const Edge ab = SampleEdge("s0", "s1", Se3()), ac = SampleEdge("s0", "s2", Se3());
  EdgeMove again{&ab, &ab, true}, not_again{&ac, &ac, false}, fresh{nullptr, &ac, false};
  EXPECT_EQ(WhatWasNotMeasured(Moved({1.0, 0.5, 0.2}), {again, not_again}),
            "s2 was not measured anew: whether it moved is not known.");
  EXPECT_EQ(WhatWasNotMeasured(Moved({1.0, 0.5, 0.2}), {again, fresh}), "");
  EXPECT_EQ(WhatWasNotMeasured(Moved({1.0, 0.5}), {again}), "");
  EXPECT_EQ(WhatWasNotMeasured(Moved({9.0, 9.0, 9.0}), {again, not_again}), "") << "that is known to have moved";
  EXPECT_EQ(WhatWasNotMeasured(Moved({1.0}), {not_again}),
            "No pair was measured anew: what moved meanwhile is not known.");
  EXPECT_EQ(WhatWasNotMeasured(Moved({1, 1, 1, 1, 1, 1, 1, 1}), {again}),
            "s2, s3, s4, s5 and 2 more were not measured anew: whether they moved is not known.");
}

Edge MeasuredAt(const std::string& session, double x_m, double sigma_m) {
  Edge edge = SampleEdge("a", "b", SamplePose(x_m, 0, 0, 0));
  edge.session = SessionId(Sha256Of(session).str());
  edge.id = EdgeId(Sha256Of("edge of " + session).str());
  edge.uncertainty = SampleUncertainty(sigma_m, 0.001, 8);
  return edge;
}

// The graph fuses old and new measurements; here the newest of each revision stand against each other.
TEST(ReportEdgeMoves, NewestMeasurementsInTheirSigmas) {
  formats::RevisionInput before, now;
  before.edges = {MeasuredAt("may", 1.0, 0.003), MeasuredAt("june", 1.001, 0.003)};
  now.edges = before.edges;
  now.edges.push_back(MeasuredAt("july", 1.026, 0.004));
  now.edges.push_back(SampleEdge("a", "c", Se3()));
  std::map<SessionId, Stamp> captured_at;
  for (const auto& [session, ns] : {std::pair{"may", 5}, {"june", 6}, {"july", 7}})
    captured_at[SessionId(Sha256Of(session).str())] = Stamp{ns};
  const auto moves = EdgeMoves(before, now, captured_at);
  ASSERT_EQ(moves.size(), 2U);
  EXPECT_TRUE(moves[0].measured_again);
  EXPECT_NEAR(moves[0].d(tangent::kX), 0.025, 1e-12);
  EXPECT_NEAR(moves[0].in_sigmas, 5.0, 1e-9);  // of 3 mm and 4 mm
  EXPECT_EQ(moves[1].before, nullptr);
  EXPECT_EQ(WhatMeasured(moves), "Measured anew, a \xE2\x86\x92 b is off by 25 mm and 0 deg (5.0 \xCF\x83).");
  const auto same = EdgeMoves(before, before, captured_at);
  EXPECT_EQ(WhatMeasured(same), "");
  ASSERT_EQ(same.size(), 1U);
  EXPECT_FALSE(same[0].measured_again);
  EXPECT_EQ(same[0].now->id, before.edges[1].id);
}

// What a planar motion leaves open is not compared: there any number may stand.
TEST(ReportEdgeMoves, AFreeAxisIsNoMovement) {
  const auto input = [](const std::string& session, const Se3& T) {
    formats::RevisionInput revision;
    revision.reference = SensorId("a");
    revision.edges = {MeasuredAt(session, 1.0, 0.003)};
    revision.edges[0].T_a_b = revision.edges[0].T_a_b * T;
    Matrix6d Omega = revision.edges[0].uncertainty.Omega;
    Omega.row(tangent::kZ).setZero();
    Omega.col(tangent::kZ).setZero();
    revision.edges[0].uncertainty = FromInformation(Omega, UncertaintySource::kJackknife, 8);
    return std::make_shared<const formats::RevisionInput>(std::move(revision));
  };
  const auto before = input("may", Se3()), now = input("june", SamplePose(0.006, 0, 0.9, 0));
  const EdgeMove move = EdgeMoves(*before, *now, {}).at(0);
  EXPECT_NEAR(move.d(tangent::kX), 0.006, 1e-9);
  EXPECT_EQ(move.d(tangent::kZ), 0.0);
  EXPECT_FALSE(move.known[tangent::kZ]);
  const std::string page = RenderCompare({RobotId("r"), {1, before}, {2, now}, 2}).value();
  EXPECT_THAT(page, HasSubstr("<td>6.00</td><td class=\"sigma\" data-v=\"5.3\">5.3, free: z</td>"));
}

// A pose that was polished since is another answer to the same question: what changed is not all movement.
TEST(ReportCompare, SaysWhereAPairWasFoundOtherwise) {
  const auto found = [](char number, double x_m, double polished) {
    formats::RevisionInput revision;
    revision.reference = SensorId("a");
    revision.edges = {SampleEdge("a", "b", SamplePose(x_m, 0, 0, 0))};
    revision.edges[0].session = SessionId(std::string(64, number));
    revision.edges[0].id = EdgeId(std::string(64, number));
    revision.edges[0].method = "lidar_lidar";
    revision.edges[0].figures = {{"polished_ratio", polished}};
    return std::make_shared<const formats::RevisionInput>(std::move(revision));
  };
  const auto page = [&](double polished) {
    return RenderCompare({RobotId("r"), {1, found('1', 0.0, 0.0)}, {2, found('2', 0.9, polished)}, 2}).value();
  };
  EXPECT_THAT(page(1.0), HasSubstr("lidar-lidar \xE2\x86\x92 lidar-lidar, polished by GICP"));
  EXPECT_THAT(page(1.0),
              HasSubstr("It was found otherwise than before (lidar-lidar \xE2\x86\x92 lidar-lidar, polished"));
  EXPECT_THAT(page(0.0), AllOf(HasSubstr("Measured anew, a"), Not(HasSubstr("otherwise"))));
}

// One page stays of one size, however long the history: but for what is compared.
TEST(ReportCompare, OffersTheNewestRevisionsAndTheChosen) {
  const auto empty = std::make_shared<const formats::RevisionInput>();
  const std::string page = RenderCompare({RobotId("r"), {3, empty}, {2000, empty}, 2000}).value();
  EXPECT_THAT(page, HasSubstr("<option selected>3</option>"));
  EXPECT_THAT(page, HasSubstr("<option>1501</option>"));
  EXPECT_THAT(page, Not(HasSubstr("<option>1500</option>")));
}

// Of an edge with one camera the figures do not say which: the pictures' residuals do.
TEST(ReportCompare, PixelsByTheFocalLengthOfAnyEdge) {
  const auto turned = [](double yaw_rad) {
    formats::RevisionInput revision;
    revision.reference = SensorId("base");
    Se3 T_base_cam;
    T_base_cam.q = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY());
    AddPose(revision, "cam", true, T_base_cam, 0.001);
    revision.edges = {SampleEdge("cam", "base", Se3())};
    revision.edges[0].figures = {{"fx_px", 1500.0}};
    revision.edges[0].evidence = {{"", SensorId("cam"), CaptureId("01"), Digest(), "fit"}};
    return std::make_shared<const formats::RevisionInput>(std::move(revision));
  };
  const std::string page = RenderCompare({RobotId("r"), {1, turned(0.0)}, {2, turned(0.002)}, 2}).value();
  EXPECT_THAT(page, HasSubstr("<td>3.0</td></tr>"));
}

TEST(ReportInfluence, NamesTheCaptureThatMovesThePositionMost) {
  const Uncertainty uncertainty = SampleUncertainty(0.001, 0.001, 8);
  std::vector<BlockVector> blocks(3);
  for (int i = 0; i < 3; ++i) blocks[static_cast<std::size_t>(i)].block_id = "0" + std::to_string(i);
  blocks[1].d << 0, 0.0025, 0, 0.0001, 0, 0;
  blocks[2].d << 0.002, 0, 0, 0, 0, 0.9;
  const Influence largest = LargestInfluence(blocks, uncertainty);
  EXPECT_EQ(largest.block_id, "01");
  EXPECT_DOUBLE_EQ(largest.position_m, 0.0025);
  EXPECT_NEAR(largest.in_sigmas, 0.0025 / 0.00125, 1e-9);  // sigma of y is 1.25 times that of x
  EXPECT_EQ(InfluenceText(LargestInfluence({}, uncertainty)), "");
}

TEST(ReportEdgeFit, ColourFollowsTheResidualAndWidthTheInformation) {
  ShownEdge shown;
  Edge edge = SampleEdge("a", "b", Se3());
  EdgeResidual residual;
  shown.edge = &edge;
  EXPECT_STREQ(FitClass(shown, {}), "unchecked");
  shown.residual = &residual;
  EXPECT_STREQ(FitClass(shown, {{edge.id}, {}}), "unchecked");
  for (const auto& [in_sigmas, name] :
       std::vector<std::pair<double, const char*>>{{0.5, "fit0"}, {1.5, "fit1"}, {2.5, "fit2"}, {9.0, "fit3"}}) {
    shown.in_sigmas = in_sigmas;
    EXPECT_STREQ(FitClass(shown, {}), name);
    // What is checked of it may contradict it.
    EXPECT_STREQ(FitClass(shown, {{}, {{edge.id, "the height is not checked"}}}), in_sigmas > 3 ? name : "unchecked");
  }
  Edge sure = edge;
  sure.uncertainty = SampleUncertainty(0.00001, 0.0001, 8);
  ShownEdge other;
  other.edge = &sure;
  const InformationScale scale({shown, other});
  EXPECT_GT(scale.Width_px(sure), 2 * scale.Width_px(edge));
}

TEST(ReportData, HoldsPosesSigmasAndBlocks) {
  ReportInput input = SampleReport();
  const Edge& edge = input.revision.edges[0];
  BlockVector block{"01", Vector6d::Zero()};
  block.d(tangent::kRz) = 0.000123456;
  input.blocks[edge.id] = {block};
  SensorFacts facts;
  facts.T_ref_nominal = SamplePose(0.5, 0, 0, 0);
  input.sensors[SensorId("front_right")] = facts;
  const std::string data = PageData(input, InOrder(input.revision));
  EXPECT_THAT(data, HasSubstr("\"blocks\":[{\"d\":[0.0,0.0,0.0,0.0,0.0,0.0001235],\"id\":\"01\"}]"));
  EXPECT_THAT(data, HasSubstr("\"nominal\":{\"p\":[0.5,0.0,0.0],\"q\":[0.0,0.0,0.0,1.0]}"));
  EXPECT_THAT(data, Not(HasSubstr("nan")));
  const std::string csv = EdgeCsv(input, InOrder(input.revision));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 7);  // a heading and six edges
  EXPECT_THAT(csv, HasSubstr("front_left,rear,failed,stereo,,,,,,,,,,,,,,"));
}

TEST(Trend, CountsFromTheFirstPoseAndBeginsAnewWithANewReference) {
  const auto at = [](double x_m, const char* reference) {
    auto revision = std::make_shared<formats::RevisionInput>();
    revision->reference = SensorId(reference);
    AddPose(*revision, "cam", true, SamplePose(x_m, 0, 0, 0), 0.001);
    return revision;
  };
  const std::string data = TrendData({{1, at(1.0, "a")}, {2, at(1.5, "a")}});
  EXPECT_THAT(data, HasSubstr("\"d\":[0.5,0.0,0.0,0.0,0.0,0.0],\"in_sigmas\":500.0,\"moved_m\":0.5,\"revision\":2"));
  EXPECT_THAT(TrendData({{1, at(1.0, "a"), Stamp{1'800'000'000LL * 1'000'000'000}}}),
              HasSubstr("\"date\":\"2027-01-15\",\"revision\":1"));
  EXPECT_THAT(TrendData({{1, at(1.0, "a")}, {2, at(1.5, "b")}}), Not(HasSubstr("\"revision\":1")));
}

}  // namespace
}  // namespace rigcal::report
