#include <nlohmann/json.hpp>

#include "tests/unit/formats/samples.h"

namespace rigcal::formats {
namespace {

using nlohmann::json;

void ExpectSameUncertainty(const Uncertainty& a, const Uncertainty& b) {
  EXPECT_EQ(a.Omega, b.Omega);
  EXPECT_EQ(a.rank, b.rank);
  EXPECT_EQ(a.dof, b.dof);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.unobservable_basis, b.unobservable_basis);
  EXPECT_EQ(a.jackknife_ratio, b.jackknife_ratio);
  ASSERT_EQ(a.blocks.size(), b.blocks.size());
  for (std::size_t i = 0; i < a.blocks.size(); ++i) {
    EXPECT_EQ(a.blocks[i].block_id, b.blocks[i].block_id);
    EXPECT_EQ(a.blocks[i].d, b.blocks[i].d);
  }
  ASSERT_EQ(a.contributions.size(), b.contributions.size());
  for (std::size_t i = 0; i < a.contributions.size(); ++i)
    EXPECT_EQ(a.contributions[i].covariance, b.contributions[i].covariance);
}

TEST(EdgeDocument, HasTheGoldenBytes) { samples::ExpectGolden("edge.json", WriteEdge(samples::SampleEdge())); }

TEST(EdgeDocument, ComesBackBitForBit) {
  samples::RandomValues random;
  for (int i = 0; i < 100; ++i) {
    Edge edge = samples::SampleEdge();
    edge.T_a_b = random.Pose();
    const std::vector<BlockVector> blocks = {{"01", random.Vector()}, {"02", random.Vector()}};
    edge.uncertainty = FromInformation(random.PositiveDefinite(), UncertaintySource::kJackknife, 1);
    edge.uncertainty.blocks = blocks;
    edge.uncertainty.contributions = {{"flatness", random.PositiveDefinite()}};
    edge.figures["rms_px"] = random.Number();
    const Result<Edge> read = ReadEdge(WriteEdge(edge));
    ASSERT_TRUE(read) << Sentence(read.error());
    EXPECT_EQ(read->T_a_b.p_m, edge.T_a_b.p_m);
    EXPECT_EQ(read->T_a_b.q.coeffs(), edge.T_a_b.q.coeffs());
    ExpectSameUncertainty(read->uncertainty, edge.uncertainty);
    EXPECT_EQ(read->figures, edge.figures);
    EXPECT_EQ(WriteEdge(*read), WriteEdge(edge));
  }
}

TEST(EdgeDocument, KeepsWhatAPersonReads) {
  const Edge edge = samples::SampleEdge();
  const Result<Edge> read = ReadEdge(WriteEdge(edge));
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->diagnoses, edge.diagnoses);
  EXPECT_EQ(read->session, edge.session);
  EXPECT_EQ(read->captures[1].note, "board not found in right/02.png");
  EXPECT_FALSE(read->captures[1].used);
  EXPECT_EQ(read->evidence[0].digest, edge.evidence[0].digest);
  EXPECT_EQ(read->evidence[0].title, edge.evidence[0].title);
}

TEST(EdgeDocument, AnUnobservedAxisHasNoSigma) {
  const Edge edge = samples::SamplePlanarEdge();
  const json document = json::parse(WriteEdge(edge));
  EXPECT_EQ(document["rank"], 5);
  EXPECT_TRUE(document["sigma_rad"][2].is_null());
  EXPECT_NEAR(document["sigma_rad"][1].get<double>(), 0.01, 1e-12);
  ASSERT_EQ(document["unobservable_basis"].size(), 1u);
  EXPECT_NEAR(std::abs(document["unobservable_basis"][0][5].get<double>()), 1.0, 1e-12);
  const Result<Edge> read = ReadEdge(WriteEdge(edge));
  ASSERT_TRUE(read) << Sentence(read.error());
  ExpectSameUncertainty(read->uncertainty, edge.uncertainty);
}

TEST(EdgeDocument, AFailedEdgeHasNoNumbers) {
  const std::string text = WriteEdge(samples::SampleFailedEdge());
  const json document = json::parse(text);
  for (const char* key : {"T_a_b", "information", "covariance", "sigma_m", "sigma_rad", "rank", "dof", "source"})
    EXPECT_TRUE(document.at(key).is_null()) << key;
  const Result<Edge> read = ReadEdge(text);
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->state, EdgeState::kFailed);
  EXPECT_EQ(read->diagnoses[0].code, "too_few_captures");
}

// The variance on one axis is found at that axis: the paths that docs/api.md promises.
class OneAxis : public testing::TestWithParam<int> {};

TEST_P(OneAxis, IsFoundAtItsIndex) {
  const auto axis = static_cast<std::size_t>(GetParam());
  Matrix6d covariance = 1e-10 * Matrix6d::Identity();
  covariance(GetParam(), GetParam()) = 4e-4;
  Edge edge = samples::SampleEdge();
  edge.uncertainty = *FromCovariance(covariance, UncertaintySource::kGiven, 0);
  const json document = json::parse(WriteEdge(edge));
  for (std::size_t i = 0; i < 6; ++i) {
    const json& sigma = document[i < 3 ? "sigma_m" : "sigma_rad"][i % 3];
    EXPECT_DOUBLE_EQ(document["covariance"][i][i].get<double>(), i == axis ? 4e-4 : 1e-10);
    EXPECT_NEAR(document["information"][i][i].get<double>() * (i == axis ? 4e-4 : 1e-10), 1.0, 1e-9);
    EXPECT_DOUBLE_EQ(sigma.get<double>(), i == axis ? 0.02 : 1e-5);
  }
}

INSTANTIATE_TEST_SUITE_P(AllSix, OneAxis, testing::Range(0, 6));

TEST(EdgeDocument, QuaternionIsWrittenXyzw) {
  Edge edge = samples::SampleEdge();
  edge.T_a_b.q = Eigen::Quaterniond(std::cos(0.1), std::sin(0.1), 0, 0);  // 0.2 rad about x
  const json q_xyzw = json::parse(WriteEdge(edge))["T_a_b"]["q_xyzw"];
  EXPECT_NEAR(q_xyzw[0].get<double>(), 0.1, 2e-4);
  EXPECT_NEAR(q_xyzw[3].get<double>(), 0.995, 2e-4);
}

TEST(EdgeDocument, ALieInTheDerivedValuesIsRefused) {
  std::string text = WriteEdge(samples::SampleEdge());
  text.replace(text.find("\"rank\":6"), 8, "\"rank\":5");
  const Result<Edge> read = ReadEdge(text);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().what, "edge left - right: rank: 5 is given, the information matrix has rank 6 of 6");
}

}  // namespace
}  // namespace rigcal::formats
