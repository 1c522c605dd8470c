#include <gmock/gmock.h>

#include <algorithm>

#include "tests/unit/formats/samples.h"

namespace rigcal::formats {
namespace {

const RobotId kRobot("mapper-01");

constexpr const char* kDiagonal =
    "[[1,0,0,0,0,0],[0,2,0,0,0,0],[0,0,3,0,0,0],[0,0,0,4,0,0],[0,0,0,0,5,0],[0,0,0,0,0,6]]";

std::string EdgeText(const std::string& a, const std::string& b, const std::string& rest) {
  return R"({"frame_a":")" + a + R"(","frame_b":")" + b + R"(","T_a_b":{"p_m":[1,2,3],"q_xyzw":[0,0,0.6,0.8]},)" +
         rest + "}";
}
std::string Informed(const std::string& more = "") { return R"("information":)" + std::string(kDiagonal) + more; }
std::string FileText(const std::string& edges) { return R"({"format":1,"edges":[)" + edges + "]}"; }

TEST(EdgeFile, ReadsWhatIsThereAndFillsTheRest) {
  const auto edges = ReadEdgeFile(FileText(EdgeText("a", "b", Informed())), kRobot);
  ASSERT_TRUE(edges) << Sentence(edges.error());
  const Edge& edge = edges->at(0);
  EXPECT_EQ(edge.robot, kRobot);
  EXPECT_EQ(edge.frame_a, SensorId("a"));
  EXPECT_EQ(edge.T_a_b.p_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(edge.T_a_b.q.z(), 0.6);
  EXPECT_EQ(edge.uncertainty.Omega(3, 3), 4.0);
  EXPECT_EQ(edge.uncertainty.rank, 6);
  EXPECT_EQ(edge.uncertainty.dof, 0);
  EXPECT_EQ(edge.uncertainty.source, UncertaintySource::kGiven);
  EXPECT_EQ(edge.method, "given");
  EXPECT_EQ(edge.state, EdgeState::kGood);
  EXPECT_FALSE(edge.id.empty());
}

TEST(EdgeFile, CovarianceOnOneAxisIsInformationThere) {
  const auto edges = ReadEdgeFile(FileText(EdgeText("a", "b", R"("covariance":)" + std::string(kDiagonal))), kRobot);
  ASSERT_TRUE(edges) << Sentence(edges.error());
  for (int axis = 0; axis < 6; ++axis) {
    EXPECT_NEAR(edges->at(0).uncertainty.Omega(axis, axis), 1.0 / (axis + 1), 1e-12);
    EXPECT_EQ(edges->at(0).uncertainty.covariance(axis, axis), axis + 1.0);
  }
}

TEST(EdgeFile, TakesOptionalFields) {
  const std::string blocks = R"([{"block_id":"01","d":[1,2,3,4,5,6]},{"block_id":"02","d":[0,0,0,7,0,0]}])";
  const std::string more = R"(,"method":"icp","source":"jackknife","blocks":)" + blocks +
                           R"(,"jackknife_ratio":0.75,"contributions":[{"name":"flatness","covariance":)" + kDiagonal +
                           "}]";
  const auto edges = ReadEdgeFile(FileText(EdgeText("a", "b", Informed(more))), kRobot);
  ASSERT_TRUE(edges) << Sentence(edges.error());
  EXPECT_EQ(edges->at(0).method, "icp");
  EXPECT_EQ(edges->at(0).uncertainty.source, UncertaintySource::kJackknife);
  EXPECT_EQ(edges->at(0).uncertainty.dof, 1);  // two blocks
  EXPECT_EQ(edges->at(0).uncertainty.jackknife_ratio, 0.75);
  const auto beyond = ReadEdgeFile(FileText(EdgeText("a", "b", Informed(R"(,"jackknife_ratio":1.1)"))), kRobot);
  ASSERT_FALSE(beyond);
  EXPECT_THAT(beyond.error().what, testing::HasSubstr("jackknife_ratio: must be between 0 and 1"));
  EXPECT_EQ(edges->at(0).uncertainty.blocks.at(1).d(3), 7.0);
  EXPECT_EQ(edges->at(0).uncertainty.contributions.at(0).covariance(4, 4), 5.0);
}

TEST(EdgeFile, AnEdgeOrTheFileSaysWhenItWasMeasured) {
  const std::string dated = EdgeText("a", "b", Informed(R"(,"measured_at":"2026-01-31T12:00:00Z")"));
  const std::string undated = EdgeText("b", "c", Informed());
  auto edges = ReadEdgeFile(FileText(dated + "," + undated), kRobot);
  ASSERT_TRUE(edges) << Sentence(edges.error());
  EXPECT_EQ(edges->at(0).measured_at, *ParseIso("2026-01-31T12:00:00Z"));
  EXPECT_FALSE(edges->at(1).measured_at);
  const EdgeId without = edges->at(1).id;
  edges = ReadEdgeFile(R"({"format":1,"measured_at":"2026-02-01","edges":[)" + dated + "," + undated + "]}", kRobot);
  ASSERT_TRUE(edges) << Sentence(edges.error());
  EXPECT_EQ(edges->at(0).measured_at, *ParseIso("2026-01-31T12:00:00Z"));  // its own
  EXPECT_EQ(edges->at(1).measured_at, *ParseIso("2026-02-01"));
  EXPECT_NE(edges->at(1).id, without);
  EXPECT_EQ(*ReadEdge(WriteEdge(edges->at(1)))->measured_at, *edges->at(1).measured_at);
  edges = ReadEdgeFile(FileText(EdgeText("a", "b", Informed(R"(,"measured_at":"yesterday")"))), kRobot);
  ASSERT_FALSE(edges);
  EXPECT_THAT(edges.error().what, testing::HasSubstr("edges[0].measured_at: "));
  edges = ReadEdgeFile(FileText(EdgeText("a", "b", Informed(R"(,"measured_at":"1970-01-01")"))), kRobot);
  ASSERT_FALSE(edges);
  EXPECT_THAT(edges.error().what, testing::HasSubstr("measured_at is not after 1970"));
}

TEST(EdgeFile, NormalisesAQuaternionWithFewDigits) {
  std::string text = FileText(EdgeText("a", "b", Informed()));
  text.replace(text.find("0,0,0.6,0.8"), 11, "0,0,-0.7071,-0.7071");
  const auto edges = ReadEdgeFile(text, kRobot);
  ASSERT_TRUE(edges) << Sentence(edges.error());
  EXPECT_NEAR(edges->at(0).T_a_b.q.norm(), 1.0, 1e-15);
  EXPECT_NEAR(edges->at(0).T_a_b.q.w(), std::sqrt(0.5), 1e-12);
}

TEST(EdgeFile, OrderDoesNotMatterAndEqualEdgesCount) {
  const std::string x = EdgeText("a", "b", Informed()), y = EdgeText("b", "c", Informed());
  const auto ids = [](const std::string& text) {
    std::vector<EdgeId> sorted;
    const auto edges = ReadEdgeFile(FileText(text), kRobot);
    for (const Edge& edge : *edges) sorted.push_back(edge.id);
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  };
  EXPECT_EQ(ids(x + "," + y + "," + x), ids(x + "," + x + "," + y));
  EXPECT_NE(ids(x + "," + x).at(0), ids(x + "," + x).at(1));
}

struct BadFile {
  std::string text, what;
};

class RefusedEdgeFile : public testing::TestWithParam<BadFile> {};

TEST_P(RefusedEdgeFile, NamesPositionAndField) {
  const auto edges = ReadEdgeFile(GetParam().text, kRobot);
  ASSERT_FALSE(edges);
  EXPECT_EQ(edges.error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(edges.error().what, "edge file: " + GetParam().what);
  EXPECT_EQ(edges.error().cure, "Mend the file as docs/edges-format.md describes it.");
}

// A good edge, then one with a fault.
std::string Second(const std::string& from, const std::string& to) {
  std::string edge = EdgeText("b", "c", Informed());
  const std::size_t at = edge.find(from);
  edge.replace(at, from.size(), to);
  return FileText(EdgeText("a", "b", Informed()) + "," + edge);
}

// From sensor `a` to b.
std::string Indefinite(const std::string& a) {
  std::string edge = EdgeText(a, "b", Informed());
  return edge.replace(edge.find("5,0]"), 1, "-5");
}

INSTANTIATE_TEST_SUITE_P(
    Cases, RefusedEdgeFile,
    testing::Values(
        BadFile{R"({"edges":[]})", "\"format\" is missing"},
        BadFile{R"({"format":2,"edges":[]})", "format: must be an integer from 1 to 1"},
        BadFile{R"({"format":1})", "\"edges\" is missing"},
        BadFile{R"({"format":1,"edges":[]})", "\"edges\" is empty: there is nothing to push"},
        BadFile{R"({"format":1,"edges":[],"robot":"x"})",
                "unknown field \"robot\"; known here: format, edges and measured_at"},
        BadFile{Second("\"frame_a\"", "\"frame_x\""), "edges[1]: unknown field \"frame_x\"; did you mean \"frame_a\"?"},
        BadFile{Second("\"frame_a\":\"b\",", ""), "edges[1]: \"frame_a\" is missing"},
        BadFile{Second("\"b\"", "\"-b\""), "edges[1].frame_a: sensor id \"-b\" is not a valid name"},
        BadFile{Second("\"c\"", "\"b\""), "edges[1]: edge b - b: frame_a and frame_b are the same"},
        BadFile{Second("0.6,0.8", "0.6,0.9"), "edges[1].T_a_b.q_xyzw: must have unit length (it is 1.081665)"},
        BadFile{Second("[0,0,0.6,0.8]", "[0.6,0.8]"), "edges[1].T_a_b.q_xyzw: must be a list of 4 numbers"},
        BadFile{Second("[1,2,3]", "[1,2,\"3\"]"), "edges[1].T_a_b.p_m[2]: must be a number"},
        BadFile{Second("[0,2,0", "[0.5,2,0"), "edges[1].information: is not symmetric: [0][1] is 0, [1][0] is 0.5"},
        BadFile{Second("5,0]", "-5,0]"), "edges[1].information: has a negative eigenvalue"},
        BadFile{FileText(Indefinite("a") + "," + EdgeText("a", "b", Informed()) + "," + Indefinite("c")),
                "edges: 2 of 3 information matrices have a negative eigenvalue: [0], [2]"},
        BadFile{FileText(Indefinite("a") + "," + Indefinite("c") + "," + Indefinite("d") + "," + Indefinite("e")),
                "edges: 4 of 4 information matrices have a negative eigenvalue: [0], [1], [2] and 1 more"},
        BadFile{Second(",[0,0,0,0,0,6]", ""), "edges[1].information: must be 6 rows of 6 numbers"},
        BadFile{Second("[0,0,0,0,0,6]", "[0,0,0,0,0]"), "edges[1].information[5]: must be a list of 6 numbers"},
        BadFile{FileText(EdgeText("a", "b",
                                  R"("information":[[0,0,0,0,0,0],[0,0,0,0,0,0],[0,0,0,0,0,0],)"
                                  R"([0,0,0,0,0,0],[0,0,0,0,0,0],[0,0,0,0,0,0]])")),
                "edges[0].information: is zero: it says nothing"},
        BadFile{FileText(EdgeText("a", "b", R"("method":"x")")),
                "edges[0]: \"information\" or \"covariance\" is missing"},
        BadFile{FileText(EdgeText("a", "b", Informed(R"(,"covariance":)" + std::string(kDiagonal)))),
                "edges[0]: has both \"information\" and \"covariance\": give one"},
        BadFile{FileText(EdgeText("a", "b",
                                  R"("covariance":[[1,0,0,0,0,0],[0,2,0,0,0,0],[0,0,3,0,0,0],)"
                                  R"([0,0,0,4,0,0],[0,0,0,0,5,0],[0,0,0,0,0,0]])")),
                "edges[0].covariance: is not positive definite; give `information` if a direction is not observed"},
        BadFile{FileText(EdgeText("a", "b", Informed(R"(,"dof":-1)"))),
                "edges[0].dof: must be an integer from 0 to 2147483647"},
        BadFile{FileText(EdgeText("a", "b", Informed(R"(,"source":"guess")"))),
                "edges[0].source: source \"guess\" of an uncertainty is not known"},
        BadFile{FileText(EdgeText("a", "b", Informed(R"(,"method":"a b")"))),
                "edges[0].method: method \"a b\" is not a valid name"},
        BadFile{FileText(EdgeText("a", "b", Informed(R"(,"blocks":[{"block_id":"01"}])"))),
                "edges[0].blocks[0]: \"d\" is missing"},
        BadFile{FileText(EdgeText("a", "b", Informed(R"(,"source":"jackknife")"))),
                "edges[0]: edge a - b: blocks: a jackknife uncertainty has 0 block vectors"}));

// The document's own example is one that works.
TEST(EdgeFile, TheDocumentedExampleIsGood) {
  const std::string page = samples::FileText(std::string(RIGCAL_SOURCE_DIR) + "/docs/edges-format.md");
  const std::size_t begin = page.find("```json\n") + 8;
  const auto edges = ReadEdgeFile(page.substr(begin, page.find("```", begin) - begin), kRobot);
  ASSERT_TRUE(edges) << Sentence(edges.error());
  EXPECT_EQ(edges->at(0).uncertainty.dof, 12);
}

}  // namespace
}  // namespace rigcal::formats
