#include <gmock/gmock.h>

#include "tests/unit/graph/fixture.h"

namespace rigcal::formats {
namespace {

const RobotId kRobot("robot");

std::string EdgeLine(const std::string& ids, const std::string& quaternion = "0 0 0 1",
                     const std::string& information = "1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 4 0 0 4 0 4") {
  return "EDGE_SE3:QUAT " + ids + " 1 2 3 " + quaternion + " " + information + "\n";
}

std::string Refusal(const std::string& text) {
  const Result<G2oFile> file = ReadG2o(text, kRobot);
  return file ? "accepted" : file.error().what;
}

TEST(G2o, ReadsEdgesVerticesAndFix) {
  const Result<G2oFile> file =
      ReadG2o("# made by hand\nVERTEX_SE3:QUAT 3 1 0 0 0 0 0 1\r\n\nFIX 3\n" + EdgeLine("3 12", "0.6 0 0 0.8"), kRobot);
  ASSERT_TRUE(file.has_value()) << Sentence(file.error());
  ASSERT_EQ(file->edges.size(), 1U);
  const Edge& edge = file->edges[0];
  EXPECT_EQ(edge.frame_a.str(), "3");
  EXPECT_EQ(edge.frame_b.str(), "12");
  EXPECT_EQ(edge.T_a_b.p_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(edge.T_a_b.q.x(), 0.6, 1e-15);
  EXPECT_NEAR(edge.T_a_b.q.w(), 0.8, 1e-15);
  EXPECT_EQ(edge.method, "g2o");
  EXPECT_EQ(edge.uncertainty.source, UncertaintySource::kGiven);
  EXPECT_EQ(edge.uncertainty.dof, 0);
  EXPECT_EQ(edge.state, EdgeState::kGood);
  EXPECT_TRUE(Validate(edge).has_value());
  EXPECT_EQ(file->fixed.str(), "3");
  EXPECT_EQ(file->T_world_vertex.at(SensorId("3")).p_m.x(), 1.0);
}

// Rotational information is quartered, cross terms are halved; position of every entry in the upper triangle.
TEST(G2o, ConvertsInformationEntryByEntry) {
  const std::string information = "101 2 3 4 5 6 102 8 9 10 11 103 13 14 15 104 17 18 105 20 106";
  const Result<G2oFile> file = ReadG2o(EdgeLine("0 1", "0 0 0 1", information), kRobot);
  ASSERT_TRUE(file.has_value()) << Sentence(file.error());
  const Matrix6d& Omega = file->edges[0].uncertainty.Omega;
  EXPECT_EQ(Omega(0, 0), 101.0);
  EXPECT_EQ(Omega(0, 1), 2.0);
  EXPECT_EQ(Omega(0, 3), 4.0 / 2);
  EXPECT_EQ(Omega(2, 5), 15.0 / 2);
  EXPECT_EQ(Omega(3, 3), 104.0 / 4);
  EXPECT_EQ(Omega(5, 4), 20.0 / 4);
  EXPECT_EQ(Omega, Omega.transpose());
  EXPECT_LT((InformationFromG2o(InformationToG2o(Omega)) - Omega).norm(), 1e-12);
}

// g2o's vector part of q is half the rotation vector: a small rotation costs the same in both.
TEST(G2o, ASmallErrorCostsTheSameInBothConventions) {
  std::mt19937 random(70);
  const Matrix6d Omega = graph::RandomInformation(random, 0.01, 0.01);
  const Se3 error = Se3::Exp(graph::RandomVector(random, 1e-7, 1e-7));
  Vector6d e_g2o;
  e_g2o << error.p_m, error.q.vec();
  const double ours = error.Log().dot(Omega * error.Log());
  EXPECT_NEAR(e_g2o.dot(InformationToG2o(Omega) * e_g2o), ours, 1e-6 * ours);
}

TEST(G2o, TheSamePairTwiceGivesTwoEdgesWhateverTheOrder) {
  const std::string a = EdgeLine("0 1"), b = EdgeLine("1 2");
  const Result<G2oFile> first = ReadG2o(a + a + b, kRobot), second = ReadG2o(b + a + a, kRobot);
  ASSERT_TRUE(first && second);
  std::vector<EdgeId> ids_first, ids_second;
  for (const Edge& edge : first->edges) ids_first.push_back(edge.id);
  for (const Edge& edge : second->edges) ids_second.push_back(edge.id);
  EXPECT_NE(ids_first[0], ids_first[1]);
  EXPECT_THAT(ids_first, testing::UnorderedElementsAreArray(ids_second));
}

TEST(G2o, RefusesByLineAndEdge) {
  const std::string good = EdgeLine("0 1");
  EXPECT_EQ(Refusal(""), "the file has no EDGE_SE3:QUAT line");
  EXPECT_EQ(Refusal(good + "EDGE_SE2 0 1 0 0 0\n"), "line 2: \"EDGE_SE2\" is not supported");
  EXPECT_EQ(Refusal(good + good + "EDGE_SE3:QUAT 0 1 1 2\n"), "line 3: edge 0 - 1: ends after 2 of 28 numbers");
  EXPECT_EQ(Refusal("EDGE_SE3:QUAT x 1\n"), "line 1: \"x\" is not a vertex number");
  EXPECT_EQ(Refusal("EDGE_SE3:QUAT 0 -1\n"), "line 1: \"-1\" is not a vertex number");
  EXPECT_THAT(Refusal(EdgeLine("4 5", "0 0 0 1.1")),
              testing::StartsWith("line 1: edge 4 - 5: the quaternion has length 1.1"));
  EXPECT_EQ(Refusal(EdgeLine("4 4")), "line 1: edge 4 - 4: joins a vertex with itself");
  EXPECT_EQ(Refusal(EdgeLine("4 5", "0 0 nan 1")), "line 1: edge 4 - 5: \"nan\" is not a finite number");
  EXPECT_EQ(Refusal(EdgeLine("4 5", "0 0 0 1", "1 0 0 0 0 0 1 0 0 0 0 -1 0 0 0 4 0 0 4 0 4")),
            "line 1: edge 4 - 5: the information matrix is indefinite");
  EXPECT_EQ(Refusal(EdgeLine("4 5", "0 0 0 1", "1 0 0 1 1 0 0 0 5 1 0 0 0 0 1 0 0 1 0 0 8.9e27")),
            "line 1: edge 4 - 5: information holds 2.22e+27, more than the limit of 1e+18");
  EXPECT_EQ(Refusal(EdgeLine("4 5", "0 0 0 1", "0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0")),
            "line 1: edge 4 - 5: the information matrix is zero");
  EXPECT_THAT(Refusal(EdgeLine("4 5", "0 0 0 1", "1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 4 0 0 4 0 4 9")),
              testing::HasSubstr("more fields than expected, from \"9\""));
  EXPECT_EQ(Refusal("VERTEX_SE3:QUAT 1 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 0 0 0 0 0 0 1\n"),
            "line 2: vertex 1: occurs twice");
}

TEST(G2o, CountsIndefiniteMatricesAndNamesTheFirstThree) {
  const std::string bad = "1 0 0 0 0 0 1 0 0 0 0 -1 0 0 0 4 0 0 4 0 4", unit = "0 0 0 1", good = EdgeLine("0 1");
  EXPECT_EQ(Refusal(good + EdgeLine("1 2", unit, bad) + good + EdgeLine("2 3", unit, bad)),
            "2 of 4 edges have an indefinite information matrix: line 2 (edge 1 - 2), line 4 (edge 2 - 3)");
  std::string many = good;
  for (int k = 1; k <= 5021; ++k)
    many += EdgeLine(std::to_string(k) + " " + std::to_string(k + 1), unit, k == 2 ? bad : "-" + bad);
  EXPECT_EQ(Refusal(many),
            "5021 of 5022 edges have an indefinite information matrix: line 2 (edge 1 - 2), line 3 (edge 2 - 3), "
            "line 4 (edge 3 - 4) and 5018 more");
  EXPECT_THAT(Refusal(EdgeLine("1 2", unit, bad) + "EDGE_SE2 0 1\n"), testing::StartsWith("line 2:"))
      << "what cannot be read comes first";
}

// What one file says, after being read, written and read again.
void ExpectRoundTrip(const G2oFile& file) {
  std::vector<SensorPose> poses;
  for (const auto& [sensor, T] : file.T_world_vertex) poses.push_back({sensor, true, T});
  const Result<std::string> text = WriteG2o(file.edges, poses, file.fixed);
  ASSERT_TRUE(text.has_value()) << Sentence(text.error());
  const Result<G2oFile> again = ReadG2o(*text, kRobot);
  ASSERT_TRUE(again.has_value()) << Sentence(again.error());
  ASSERT_EQ(again->edges.size(), file.edges.size());
  EXPECT_EQ(again->fixed, file.fixed);
  EXPECT_EQ(again->T_world_vertex.size(), file.T_world_vertex.size());
  for (std::size_t k = 0; k < file.edges.size(); ++k) {
    const Edge &a = file.edges[k], &b = again->edges[k];
    ASSERT_EQ(a.frame_a, b.frame_a);
    ASSERT_EQ(a.frame_b, b.frame_b);
    ASSERT_EQ(a.T_a_b.p_m, b.T_a_b.p_m) << k;
    ASSERT_LE((a.T_a_b.q.coeffs() - b.T_a_b.q.coeffs()).cwiseAbs().maxCoeff(), 1e-15) << k;
    ASSERT_EQ(a.uncertainty.Omega, b.uncertainty.Omega) << k;
    ASSERT_EQ(a.uncertainty.rank, b.uncertainty.rank) << k;
  }
}

TEST(G2oWriter, WhatIsWrittenIsReadBackExactly) {
  const graph::RandomRig rig = graph::MakeRig(30, 200, 71);
  G2oFile file;
  std::mt19937 random(72);
  for (const GraphEdge& edge : rig.graph.edges) {
    Edge full;
    full.frame_a = edge.frame_a, full.frame_b = edge.frame_b;
    full.T_a_b = edge.T_a_b;
    Matrix6d Omega = std::pow(10.0, static_cast<double>(random() % 12) - 8.0) * edge.Omega;
    if (random() % 4 == 0) Omega.row(1).setZero(), Omega.col(1).setZero();
    full.uncertainty = FromInformation(Omega, UncertaintySource::kGiven, 0);
    full.state = EdgeState::kGood;
    file.edges.push_back(full);
  }
  for (std::size_t v = 0; v < rig.truth.size(); ++v)
    file.T_world_vertex.emplace(rig.graph.sensors[v], rig.truth[v].Normalized());
  file.fixed = SensorId("7");
  ExpectRoundTrip(file);
}

TEST(G2oWriter, FilesOfOthersComeBack) {
  for (const char* name : {"posegraph_sesync/tinyGrid3D.g2o", "posegraph_sesync/smallGrid3D.g2o",
                           "posegraph_sesync/parking-garage.g2o", "posegraph_synthetic/rand_100_600.g2o"}) {
    RIGCAL_SKIP_WITHOUT_RECORDING(name);
    const Result<G2oFile> file = graph::ReadData(name);
    ASSERT_TRUE(file.has_value()) << Sentence(file.error());
    ExpectRoundTrip(*file);
  }
}

TEST(G2oWriter, NamesBecomeNumbersAndFailedEdgesStayOut) {
  Edge edge, failed;
  edge.frame_a = SensorId("left"), edge.frame_b = SensorId("7");
  edge.T_a_b.p_m = {1.0, 2.0, 0.1};
  edge.uncertainty = FromInformation(4.0 * Matrix6d::Identity(), UncertaintySource::kGiven, 0);
  edge.state = EdgeState::kGood;
  failed.frame_a = SensorId("left"), failed.frame_b = SensorId("rear");
  const SensorPose pose{SensorId("left"), true, Se3()}, unknown{SensorId("top"), false, Se3()};
  EXPECT_EQ(WriteG2o({edge, failed}, {pose, unknown}, SensorId("left")).value(),
            "# vertex 0 is left\n# vertex 1 is top\n# vertex 2 is 7\nVERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nFIX 0\n"
            "EDGE_SE3:QUAT 0 2 1 2 0.1 0 0 0 1 4 0 0 0 0 0 4 0 0 0 0 4 0 0 0 16 0 0 16 0 16\n");
  EXPECT_EQ(WriteG2o({failed}, {}, SensorId()).error().code, ErrorCode::kNotFound);
}

TEST(G2oWriter, NamesComeBackAsTheyWereAlsoOfASensorThatIsANumber) {
  Edge edge;
  edge.frame_a = SensorId("7"), edge.frame_b = SensorId("left");
  edge.uncertainty = FromInformation(4.0 * Matrix6d::Identity(), UncertaintySource::kGiven, 0);
  edge.state = EdgeState::kGood;
  std::vector<SensorPose> poses;
  for (const char* name : {"root", "7", "a", "b", "c", "d", "e", "left"})
    poses.push_back({SensorId(name), true, Se3()});
  const auto file = ReadG2o(WriteG2o({edge}, poses, SensorId("root")).value(), RobotId("r"));
  ASSERT_TRUE(file) << Sentence(file.error());
  EXPECT_EQ(file->edges[0].frame_a, SensorId("7"));
  EXPECT_EQ(file->edges[0].frame_b, SensorId("left"));
  EXPECT_EQ(file->fixed, SensorId("root"));
  EXPECT_TRUE(file->T_world_vertex.contains(SensorId("e")));
}

TEST(G2o, CommentsThatNameVerticesDoNotContradict) {
  EXPECT_EQ(Refusal("# vertex 0 is left\n# vertex 0 is right\n" + EdgeLine("0 1")),
            "line 2: vertex 0: is named \"right\", and before it was \"left\"");
  EXPECT_EQ(Refusal("# vertex 0 is 1\n" + EdgeLine("0 1")), "line 2: vertices 0 and 1 are both \"1\"");
  EXPECT_EQ(Refusal(EdgeLine("0 1") + "# vertex 0 is left\n"),
            "line 2: vertex 0: is named \"left\", and before it was \"0\"");
  const auto other = ReadG2o(
      "# vertex 0 is wherever it was\n# vertices are cameras\n#vertex 0 is x\n" + EdgeLine("0 1"), RobotId("r"));
  ASSERT_TRUE(other);
  EXPECT_EQ(other->edges[0].frame_a, SensorId("0"));
}

TEST(G2oWriter, APoseInPartSaysWhatOfItWasNotMeasured) {
  Edge edge;
  edge.frame_a = SensorId("0"), edge.frame_b = SensorId("1");
  edge.uncertainty = FromInformation(4.0 * Matrix6d::Identity(), UncertaintySource::kGiven, 0);
  edge.state = EdgeState::kGood;
  SensorPose part;
  part.sensor = SensorId("1");
  part.measured_part = MeasuredPart{};
  part.measured_part->T_ref_sensor.p_m = {1.0, 2.0, 0.7};
  part.unobservable_basis = {Vector6d::Unit(tangent::kZ)};
  const std::string text = WriteG2o({edge}, {{SensorId("0"), true, Se3()}, part}, SensorId("0")).value();
  EXPECT_EQ(text.substr(0, text.find("FIX")),
            "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n"
            "# vertex 1 holds, not measured (its own x y z in m, rx ry rz in rad): 0 0 1 0 0 0\n"
            "VERTEX_SE3:QUAT 1 1 2 0.7 0 0 0 1\n");
  EXPECT_EQ(ReadG2o(text, RobotId("r"))->T_world_vertex.at(SensorId("1")).p_m.z(), 0.7);
}

TEST(G2o, NearlyUnitQuaternionsAreNormalisedAndRankDeficientInformationIsKept) {
  const Result<G2oFile> file =
      ReadG2o(EdgeLine("0 1", "0 0 0 1.0005", "1 0 0 0 0 0 0 0 0 0 0 1 0 0 0 4 0 0 4 0 4"), kRobot);
  ASSERT_TRUE(file.has_value()) << Sentence(file.error());
  EXPECT_EQ(file->edges[0].T_a_b.q.w(), 1.0);
  EXPECT_EQ(file->edges[0].uncertainty.rank, 5);
}

}  // namespace
}  // namespace rigcal::formats
