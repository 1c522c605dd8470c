#include <algorithm>
#include <chrono>
#include <ctime>
#include <nlohmann/json.hpp>

#include "tests/unit/formats/samples.h"

namespace rigcal::formats {
namespace {

using nlohmann::json;
using samples::SampleRevision;

TEST(RevisionDocument, HasTheGoldenBytes) {
  samples::ExpectGolden("revision.json", WriteRevisionDocument(SampleRevision()));
  samples::ExpectGolden("revision-whole.json", WriteWholeRevisionDocument(SampleRevision()));
}

TEST(RevisionDocument, DoesNotDependOnTheOrderOfEdges) {
  const RevisionInput sorted = SampleRevision();
  RevisionInput shuffled = sorted;
  std::rotate(shuffled.edges.begin(), shuffled.edges.begin() + 1, shuffled.edges.end());
  std::reverse(shuffled.solution.residuals.begin(), shuffled.solution.residuals.end());
  EXPECT_EQ(WriteRevisionDocument(shuffled), WriteRevisionDocument(sorted));
  EXPECT_EQ(WriteWholeRevisionDocument(shuffled), WriteWholeRevisionDocument(sorted));
}

class RevisionDocumentOfFormat : public testing::TestWithParam<int> {
 protected:
  static std::string Written(const RevisionInput& input) {
    return GetParam() == 1 ? WriteWholeRevisionDocument(input) : WriteRevisionDocument(input);
  }
};
INSTANTIATE_TEST_SUITE_P(Both, RevisionDocumentOfFormat, testing::Values(1, 2));

TEST_P(RevisionDocumentOfFormat, ComesBack) {
  const RevisionInput input = SampleRevision();
  const Result<RevisionInput> read = ReadRevisionDocument(Written(input));
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->robot, input.robot);
  EXPECT_EQ(read->reference, input.reference);
  EXPECT_EQ(read->verdict.level, VerdictLevel::kWarn);
  EXPECT_EQ(read->verdict.what_to_do, input.verdict.what_to_do);
  EXPECT_EQ(read->solution.before.translation_m2, 0.2);
  EXPECT_EQ(read->solution.after.rotation_rad2, 0.01);
  EXPECT_EQ(read->solution.dof, 6);
  EXPECT_EQ(read->solution.iterations, 4);
  EXPECT_EQ(read->solution.diagnoses, input.solution.diagnoses);
  ASSERT_EQ(read->solution.poses.size(), 3u);
  EXPECT_EQ(read->solution.poses[1].covariance, samples::SampleCovariance());
  EXPECT_FALSE(read->solution.poses[2].known);
  ASSERT_EQ(read->solution.residuals.size(), 2u);
  EXPECT_EQ(read->solution.residuals[0].e, input.solution.residuals[0].e);
  EXPECT_FALSE(read->solution.residuals[1].in_solution);
  EXPECT_EQ(Written(*read), Written(input));
  EXPECT_EQ(WriteRevisionDocument(*read), WriteRevisionDocument(input));
}

// By what it was fused, so that the same can be made of it once more; of before there was any, by the number of visits.
TEST_P(RevisionDocumentOfFormat, KeepsByWhichScatterItWasFused) {
  RevisionInput input = SampleRevision();
  SensorPose& pose = input.solution.poses[1];
  pose.fused = FusedPose{{}, samples::SampleCovariance(), 3, 0.0004, 0.0003};
  EXPECT_EQ(Written(input).find("scatter"), std::string::npos);
  EXPECT_EQ(ReadRevisionDocument(Written(input))->solution.poses[1].fused->scatter_dof, (ScatterDof{6.0, 6.0}));
  pose.fused->scatter = {{-1e-8, 2e-8, 6.0}, {3e-8, 4e-8, 6.0}};
  pose.fused->pooled_scatter = VisitScatter{{5e-8, 6e-8, 20.0}, {7e-8, 8e-8, 21.0}, 19};
  pose.fused->scatter_dof = {26.0, 27.0};
  EXPECT_EQ(Written(input).find("\"ratio\":["), std::string::npos);
  pose.fused->scatter.rotation.ratio = {2.25, 0.5, 0.25};
  pose.fused->pooled_scatter->translation.ratio = {1.5, 0.75, 0.75};
  const Result<RevisionInput> read = ReadRevisionDocument(Written(input));
  ASSERT_TRUE(read) << Sentence(read.error());
  const FusedPose& fused = *read->solution.poses[1].fused;
  EXPECT_EQ(fused.scatter, pose.fused->scatter);
  EXPECT_EQ(fused.pooled_scatter, pose.fused->pooled_scatter);
  EXPECT_EQ(fused.scatter_dof, pose.fused->scatter_dof);
  EXPECT_EQ(fused.visit_variance, std::nullopt);
  EXPECT_EQ(Written(*read), Written(input));
}

TEST_P(RevisionDocumentOfFormat, KeepsAlongWhichAxesARobotAloneScatters) {
  RevisionInput input = SampleRevision();
  SensorPose& pose = input.solution.poses[1];
  pose.fused = FusedPose{{}, samples::SampleCovariance(), 3, 0.0004, 0.0003};
  pose.fused->scatter_dof = {3.75, 3.5};
  pose.fused->visit_variance = (Vector6d() << 4e-7, 2e-8, 0.0, 1e-7, 2e-7, 3e-7).finished();
  const Result<RevisionInput> read = ReadRevisionDocument(Written(input));
  ASSERT_TRUE(read) << Sentence(read.error());
  const FusedPose& fused = *read->solution.poses[1].fused;
  EXPECT_EQ(fused.scatter_dof, pose.fused->scatter_dof);
  EXPECT_EQ(fused.visit_variance, pose.fused->visit_variance);
  EXPECT_FALSE(fused.pooled_scatter);
  EXPECT_EQ(Written(*read), Written(input));
}

TEST(RevisionDocument, OfFormat1HasItsEdgesWhole) {
  const RevisionInput input = SampleRevision();
  const Result<RevisionInput> read = ReadRevisionDocument(WriteWholeRevisionDocument(input));
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_TRUE(read->whole);
  const Edge &edge = read->edges[1], &given = input.edges[1];
  EXPECT_EQ(edge.evidence[0].digest, given.evidence[0].digest);
  EXPECT_EQ(edge.captures.size(), given.captures.size());
  EXPECT_EQ(edge.figures, given.figures);
  EXPECT_EQ(edge.uncertainty.Omega, given.uncertainty.Omega);
  EXPECT_EQ(edge.uncertainty.contributions.size(), given.uncertainty.contributions.size());
}

TEST(RevisionDocument, RefersToItsEdges) {
  const json document = json::parse(WriteRevisionDocument(SampleRevision()));
  EXPECT_EQ(document["format"], 2);
  for (const json& edge : document["edges"]) {
    for (const char* key : {"robot", "jackknife_ratio", "information", "covariance", "unobservable_basis",
                            "contributions", "captures", "evidence"})
      EXPECT_FALSE(edge.contains(key)) << key;
    for (const char* key : {"id", "frame_a", "frame_b", "state", "method", "session", "epoch", "T_a_b", "sigma_m",
                            "sigma_rad", "rank", "dof", "source", "diagnoses", "figures", "residual", "influence"})
      EXPECT_TRUE(edge.contains(key)) << key;
  }
}

// What tables and pages tell of an edge.
TEST(RevisionDocument, TellsOfAnEdgeWhatItWas) {
  RevisionInput input = SampleRevision();
  input.edges[1].figures = {{"polished_ratio", 1.0}, {"merged_sessions", 22.0}, {"rms_px", 0.19}};
  const Result<RevisionInput> read = ReadRevisionDocument(WriteRevisionDocument(input));
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_FALSE(read->whole);
  ASSERT_EQ(read->edges.size(), input.edges.size());
  for (std::size_t i = 0; i < input.edges.size(); ++i) {
    const Edge &edge = read->edges[i], &given = input.edges[i];
    EXPECT_EQ(edge.id, given.id);
    EXPECT_EQ(edge.robot, given.robot);
    EXPECT_EQ(edge.frame_a, given.frame_a);
    EXPECT_EQ(edge.frame_b, given.frame_b);
    EXPECT_EQ(edge.state, given.state);
    EXPECT_EQ(edge.method, given.method);
    EXPECT_EQ(edge.session, given.session);
    EXPECT_EQ(edge.epoch, given.epoch);
    EXPECT_EQ(edge.diagnoses, given.diagnoses);
    if (given.state == EdgeState::kFailed) continue;
    EXPECT_EQ(edge.T_a_b, given.T_a_b);
    EXPECT_EQ(edge.uncertainty.rank, given.uncertainty.rank);
    EXPECT_EQ(edge.uncertainty.dof, given.uncertainty.dof);
    EXPECT_EQ(edge.uncertainty.source, given.uncertainty.source);
    for (int axis = 0; axis < 6; ++axis) {
      EXPECT_EQ(SigmaOf(edge.uncertainty, axis).known, SigmaOf(given.uncertainty, axis).known) << axis;
      EXPECT_EQ(SigmaOf(edge.uncertainty, axis).value, SigmaOf(given.uncertainty, axis).value) << axis;
    }
  }
  EXPECT_EQ(read->edges[1].figures,
            (std::map<std::string, double>{{"polished_ratio", 1.0}, {"merged_sessions", 22.0}}));
}

TEST(RevisionDocument, NamesLensesThatBendWithWhatWasTriedOnThem) {
  RevisionInput input = SampleRevision();
  input.solution.fused.sessions = {SessionId(std::string(64, 'a'))};
  EXPECT_FALSE(json::parse(WriteRevisionDocument(input))["fused"].contains("lenses"));
  LensMisfit lens;
  lens.camera = SensorId("left");
  lens.rms_px = 0.05;
  lens.trial = {0.43, false, 24, {{CameraModel::kPinholeRational, 0.21}}, CameraModel::kPinholeRational};
  input.solution.fused.lenses = {lens};
  const json document = json::parse(WriteRevisionDocument(input));
  const json& written = document["fused"]["lenses"][0];
  EXPECT_EQ(written["model"], "pinhole_radtan");
  EXPECT_EQ(written["trial"]["proposed"], "pinhole_rational");
  EXPECT_EQ(written["trial"]["candidates"][0]["left_out_rms_px"], 0.21);
  const Result<RevisionInput> read = ReadRevisionDocument(document.dump());
  ASSERT_TRUE(read) << Sentence(read.error());
  ASSERT_EQ(read->solution.fused.lenses.size(), 1U);
  EXPECT_EQ(read->solution.fused.lenses[0].trial.own_left_out_rms_px, 0.43);
}

TEST(RevisionDocument, OfAnUnknownFormatIsRefused) {
  json document = json::parse(WriteRevisionDocument(SampleRevision()));
  document["format"] = 3;
  EXPECT_EQ(ReadRevisionDocument(document.dump()).error().what, "revision: format: must be an integer from 1 to 2");
}

TEST(RevisionDocument, ASigmaIsNotNegative) {
  json document = json::parse(WriteRevisionDocument(SampleRevision()));
  document["edges"][1]["sigma_rad"][2] = -1e-3;
  EXPECT_EQ(ReadRevisionDocument(document.dump()).error().what,
            "revision: edges[1].sigma_rad[2]: must not be negative");
  document["edges"][1]["sigma_rad"] = {1e-3, 1e-3};
  EXPECT_EQ(ReadRevisionDocument(document.dump()).error().what, "revision: edges[1].sigma_rad: must be 3 numbers");
}

TEST(RevisionDocument, SaysWhatTheSolutionRestsOn) {
  const RevisionInput input = SampleRevision();
  const json document = json::parse(WriteRevisionDocument(input));
  EXPECT_EQ(document["influence"], json({{"judged", true}, {"why_not", nullptr}}));
  EXPECT_TRUE(document["edges"][0]["influence"].is_null());
  EXPECT_EQ(document["edges"][1]["influence"]["sensor"], "lidar");
  EXPECT_EQ(document["edges"][1]["influence"]["move"][5], 0.002);
  EXPECT_TRUE(document["edges"][2]["influence"]["move"].is_null());
  EXPECT_EQ(document["cycles"]["failing"], 1);
  EXPECT_EQ(document["cycles"]["worst"][0]["fails"], true);
  EXPECT_TRUE(document["cycles"]["worst"][1]["limit"].is_null());
  const auto read = ReadRevisionDocument(document.dump());
  ASSERT_TRUE(read) << Sentence(read.error());
  const GraphSolution& solution = read->solution;
  EXPECT_TRUE(solution.influences.judged);
  ASSERT_EQ(solution.influences.edges.size(), 2u);
  EXPECT_EQ(solution.influences.edges[0].move_sigmas, 2.25);
  EXPECT_TRUE(solution.influences.edges[1].most_moved.empty());
  EXPECT_EQ(solution.cycles.why_not, "Longer loops were left out.");
  ASSERT_EQ(solution.cycles.worst.size(), 2u);
  EXPECT_EQ(solution.cycles.worst[0].edges, input.solution.cycles.worst[0].edges);
  EXPECT_EQ(solution.cycles.worst[0].e, input.solution.cycles.worst[0].e);
  EXPECT_EQ(solution.cycles.worst[0].limit, 45.0);
  EXPECT_FALSE(solution.cycles.worst[1].fails());
}

// Documents of earlier versions are kept for ever.
TEST(RevisionDocument, ReadsOneWithoutInfluenceAndCycles) {
  const std::string old =
      samples::FileText(std::string(RIGCAL_SOURCE_DIR) + "/tests/golden/revision-without-insight.json");
  const auto read = ReadRevisionDocument(old);
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->edges.size(), 3u);
  EXPECT_FALSE(read->solution.influences.judged);
  EXPECT_TRUE(read->solution.influences.edges.empty());
  EXPECT_FALSE(read->solution.cycles.judged);
  EXPECT_TRUE(read->solution.cycles.worst.empty());
}

TEST(RevisionDocument, KeepsWhatItsVerdictRestsOn) {
  RevisionInput input = samples::SampleRevision();
  EXPECT_EQ(WriteRevisionDocument(input).find("verdict_basis"), std::string::npos) << "bytes of before stay";
  input.basis = {{SensorId("left")},
                 {SensorId("right")},
                 {"Loop open by", "20 mm", "limit 1 mm"},
                 {{"A.", "B."}, {"C.", ""}},
                 {{input.edges.front().id, "the height is not checked by anything else"}}};
  const auto read = ReadRevisionDocument(WriteRevisionDocument(input));
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->basis, input.basis);
}

TEST(RevisionDocument, ALoopHasASensorPerEdge) {
  json document = json::parse(WriteRevisionDocument(SampleRevision()));
  document["cycles"]["worst"][0]["sensors"].push_back("up");
  const auto read = ReadRevisionDocument(document.dump());
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().what, "revision: cycles.worst[0]: must have as many sensors as edges");
}

TEST(RevisionDocument, HoldsNoBlockVectors) {
  RevisionInput input = SampleRevision();
  input.edges[1].uncertainty.blocks = {{"01", Vector6d::Ones()}, {"02", Vector6d::Ones()}};
  EXPECT_EQ(WriteRevisionDocument(input), WriteRevisionDocument(SampleRevision()));
  EXPECT_EQ(WriteWholeRevisionDocument(input), WriteWholeRevisionDocument(SampleRevision()));
}

TEST(RevisionDocument, AnUnknownSensorHasNoNumbers) {
  const json sensors = json::parse(WriteRevisionDocument(SampleRevision()))["sensors"];
  for (const char* key : {"T_ref_sensor", "covariance", "sigma_m", "sigma_rad"})
    EXPECT_TRUE(sensors[2].at(key).is_null()) << key;
  EXPECT_NEAR(sensors[1]["sigma_rad"][1].get<double>(), 5e-3, 1e-15);
  EXPECT_NEAR(sensors[1]["covariance"][3][3].get<double>(), 16e-6, 1e-18);
  EXPECT_NEAR(sensors[1]["covariance"][1][3].get<double>(), -2e-7, 1e-20);
}

// Behind covariances that are estimated; an analytic one has none.
TEST(RevisionDocument, DegreesOfFreedomComeBack) {
  RevisionInput input = SampleRevision();
  SensorPose& lidar = input.solution.poses[1];
  lidar.dof = 14.25;
  EXPECT_FALSE(json::parse(WriteRevisionDocument(input))["sensors"][1].contains("dof"));
  lidar.by_jackknife = true, lidar.covariance_analytic = lidar.covariance;
  const std::string text = WriteRevisionDocument(input);
  EXPECT_EQ(json::parse(text)["sensors"][1]["dof"], 14.25);
  EXPECT_EQ(ReadRevisionDocument(text)->solution.poses[1].dof, 14.25);
  EXPECT_EQ(ReadRevisionDocument(text)->solution.poses[0].dof, 0.0);
}

TEST(RevisionDocument, WhatIsFreeComesBack) {
  RevisionInput input = SampleRevision();
  EXPECT_FALSE(json::parse(WriteRevisionDocument(input))["sensors"][2].contains("unobservable_basis"));
  Vector6d turn = 2.0 * Vector6d::Unit(tangent::kY);
  turn(tangent::kRz) = 1.0;
  input.solution.poses[2].unobservable_basis = {turn, Vector6d::Unit(tangent::kX)};
  const std::string text = WriteRevisionDocument(input);
  EXPECT_EQ(json::parse(text)["sensors"][2]["unobservable_basis"][0], json::parse("[0, 2, 0, 0, 0, 1]"));
  const auto read = ReadRevisionDocument(text);
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->solution.poses[2].unobservable_basis, input.solution.poses[2].unobservable_basis);
  EXPECT_TRUE(read->solution.poses[1].unobservable_basis.empty());
}

TEST(RevisionDocument, ErrorsNameThePath) {
  std::string text = WriteRevisionDocument(SampleRevision());
  const std::string from = "\"q_xyzw\":[0.36,0.0,0.48,0.8]";
  text.replace(text.find(from), from.size(), "\"q_xyzw\":[0.36,0.0,0.48,0.0]");
  const auto read = ReadRevisionDocument(text);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().what, "revision: edges[1].T_a_b.q_xyzw: must have unit length (it is 0.600000)");
}

RevisionInput LargeRevision(int sensors, int edges) {
  samples::RandomValues random;
  RevisionInput input = SampleRevision();
  input.edges.clear();
  input.solution.poses.clear();
  input.solution.residuals.clear();
  const auto name = [](int i) { return SensorId(std::to_string(i)); };
  for (int i = 0; i < sensors; ++i)
    input.solution.poses.push_back({name(i), true, random.Pose(), random.PositiveDefinite()});
  for (int i = 0; i < edges; ++i) {
    Edge edge;
    edge.robot = input.robot;
    edge.frame_a = name(i % sensors);
    edge.frame_b = name((i * 7 + 1) % sensors);
    edge.T_a_b = random.Pose();
    edge.uncertainty = FromInformation(random.PositiveDefinite(), UncertaintySource::kGiven, 0);
    edge.method = "g2o";
    edge.state = EdgeState::kGood;
    edge.id = PushedEdgeId(edge.robot, ContentDigest(edge), 0);
    input.solution.residuals.push_back({edge.id, true, random.Vector(), random.Number()});
    input.edges.push_back(std::move(edge));
  }
  std::sort(input.edges.begin(), input.edges.end(), [](const Edge& a, const Edge& b) { return a.id < b.id; });
  std::sort(input.solution.residuals.begin(), input.solution.residuals.end(),
            [](const EdgeResidual& a, const EdgeResidual& b) { return a.edge < b.edge; });
  return input;
}

double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// 0.2 s and 0.3 s in a release build; the limit is for work that grows with the square of the edges.
TEST_P(RevisionDocumentOfFormat, ALargeGraphComesBackBitForBitInTime) {
  const RevisionInput input = LargeRevision(2500, 5000);
  const double start = CpuSeconds();
  const std::string text = Written(input);
  const double written = CpuSeconds();
  const Result<RevisionInput> read = ReadRevisionDocument(text);
  const double done = CpuSeconds();
  ASSERT_TRUE(read) << Sentence(read.error());
  RecordProperty("write_ms", std::to_string(1e3 * (written - start)));
  RecordProperty("read_ms", std::to_string(1e3 * (done - written)));
  std::printf("[ bytes %zu, write %.0f ms, read %.0f ms ]\n", text.size(), 1e3 * (written - start),
              1e3 * (done - written));
  EXPECT_LT(done - start, 20.0);
  ASSERT_EQ(read->edges.size(), input.edges.size());
  for (std::size_t i = 0; i < input.edges.size(); ++i) {
    const Uncertainty &told = read->edges[i].uncertainty, &given = input.edges[i].uncertainty;
    for (int axis = 0; axis < 6; ++axis) ASSERT_EQ(SigmaOf(told, axis).value, SigmaOf(given, axis).value);
    if (read->whole) {
      ASSERT_EQ(told.Omega, given.Omega);
      ASSERT_EQ(told.covariance, given.covariance);
    }
    ASSERT_EQ(read->edges[i].T_a_b.q.coeffs(), input.edges[i].T_a_b.q.coeffs());
    ASSERT_EQ(read->edges[i].T_a_b.p_m, input.edges[i].T_a_b.p_m);
    ASSERT_EQ(read->solution.residuals[i].e, input.solution.residuals[i].e);
    ASSERT_EQ(read->solution.residuals[i].weighted, input.solution.residuals[i].weighted);
  }
  for (std::size_t i = 0; i < input.solution.poses.size(); ++i)
    ASSERT_EQ(read->solution.poses[i].covariance, input.solution.poses[i].covariance);
}

}  // namespace
}  // namespace rigcal::formats
