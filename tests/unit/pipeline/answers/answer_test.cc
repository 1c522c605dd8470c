#include "server/pipeline/answers/answer.h"

#include <SQLiteCpp/SQLiteCpp.h>

#include <cmath>

#include "server/base/digests/base64.h"
#include "server/formats/documents.h"
#include "server/report/frame/assets.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

class AnswerTest : public PipelineTest {
 protected:
  RevisionCache revisions_cache_;
  Result<std::string> Ask(const std::string& verb, const std::string& json) {
    return Answer({*store_, clock_, revisions_cache_, clock_.now, "http://127.0.0.1:1"}, verb, json);
  }
};

TEST_F(AnswerTest, EveryVerbAnswersForARobotWithARevision) {
  StoreEdges(Triangle("r"));
  StepAll();
  for (const std::string verb : {"robots", "sessions", "edges", "show", "revisions", "status", "due", "health"}) {
    const auto answer = Ask(verb, verb == "edges" || verb == "show" || verb == "revisions" ? R"({"robot":"r"})" : "{}");
    ASSERT_TRUE(answer) << verb << ": " << Sentence(answer.error());
    EXPECT_EQ(answer->front(), '{') << verb;
  }
}

TEST_F(AnswerTest, ABatchThatIsNotWholeIsNamedWhereTheResultIsMissed) {
  const std::vector<Edge> edges = Triangle("r");
  ASSERT_TRUE(store_->Write([&]() -> Status {
    RIGCAL_TRY(storage::AppendBatch(*store_, RobotId("r"), BatchIdOf(RobotId("r"), edges), 3, clock_.now));
    return storage::AppendBatchItems(*store_, BatchIdOf(RobotId("r"), edges), {{0, edges[0]}}, clock_.now);
  }));
  EXPECT_EQ(StepAll(), 0);
  const auto shown = Ask("show", R"({"robot":"r"})");
  ASSERT_FALSE(shown);
  EXPECT_EQ(Sentence(shown.error()),
            "robot 'r' has no revision yet: a batch of 3 edges is incomplete: 1 of 3 since 2027-01-15T08:00:00Z. Push "
            "the same edges again: that completes it, and nothing is stored twice.");
  const std::string status = Ask("status", "{}").value();
  EXPECT_NE(status.find(R"("edges":3,"held":1)"), std::string::npos) << status;
  EXPECT_NE(status.find("There is no revision yet: a batch of 3 edges is incomplete"), std::string::npos) << status;
}

TEST_F(AnswerTest, LookupComposesThroughTheReference) {
  StoreEdges(Triangle("r"));
  StepAll();
  const auto answer = Ask("lookup", R"({"robot":"r","a":"b","b":"c"})");
  ASSERT_TRUE(answer) << Sentence(answer.error());
  EXPECT_NE(answer->find("\"frame_a\":\"b\""), std::string::npos);
  // Pose of c in b: 2.002 - 1.001, up to the last bits.
  EXPECT_NE(answer->find("\"p_m\":[1.00"), std::string::npos) << *answer;
}

TEST_F(AnswerTest, EdgesThatNoLongerCountArePastWithTheirReason) {
  const SessionId first = StoreSession("r", {{"left/01.png", "1"}, {"right/01.png", "2"}});
  Edge edge = GivenEdge("r", "left", "right", 0.1);
  edge.session = first;
  edge.id = EstimatedEdgeId(edge.robot, edge.session, edge.method, edge.frame_a, edge.frame_b);
  StoreEdges({edge});
  clock_.now.ns += 1'000'000'000;
  StoreSession("r", {{"left/01.png", "3"}, {"right/01.png", "4"}}, {SensorId("right")});
  StepAll();
  const auto edges = Ask("edges", R"({"robot":"r"})");
  ASSERT_TRUE(edges) << Sentence(edges.error());
  EXPECT_EQ(edges->find("\"state\":\"good\""), std::string::npos) << *edges;
  EXPECT_NE(edges->find("\"code\":\"remounted\""), std::string::npos) << *edges;
  const auto page = AnswerPage({*store_, clock_, revisions_cache_, clock_.now, "http://127.0.0.1:1"},
                               "/robots/r/sessions/" + first.str() + "/", "");
  ASSERT_TRUE(page) << Sentence(page.error());
  EXPECT_NE(page->body.find(">past</span> <span class=\"why\" dir=\"auto\">sensor right was remounted"),
            std::string::npos)
      << page->body;
  const auto robot_page =
      AnswerPage({*store_, clock_, revisions_cache_, clock_.now, "http://127.0.0.1:1"}, "/robots/r/", "");
  ASSERT_TRUE(robot_page) << Sentence(robot_page.error());
  EXPECT_NE(robot_page->body.find("1 pair good <span class=\"badge unknown\">1 past</span>"), std::string::npos)
      << robot_page->body;
}

// Block vectors that scatter twice as far as the edges' own information says.
std::vector<Edge> TriangleWithBlocks(const std::string& robot) {
  std::vector<Edge> edges = Triangle(robot);
  for (Edge& edge : edges) {
    edge.uncertainty.source = UncertaintySource::kJackknife;
    edge.uncertainty.dof = 11;
    for (int axis = 0; axis < 6; ++axis)
      for (const double sign : {1.0, -1.0})
        edge.uncertainty.blocks.push_back({std::to_string(axis) + (sign > 0.0 ? "+" : "-"),
                                           sign * 2e-3 * std::sqrt(12.0 / 22.0) * Vector6d::Unit(axis)});
  }
  AssignPushedIds(edges);
  return edges;
}

TEST_F(AnswerTest, SigmasAreTheJackknifesWhereBlocksAreThere) {
  StoreEdges(TriangleWithBlocks("r"));
  StepAll();
  ASSERT_EQ(revisions_.size(), 1u);
  const auto document = formats::ReadRevisionDocument(revisions_[0].document);
  ASSERT_TRUE(document) << Sentence(document.error());
  EXPECT_NE(revisions_[0].document.find("\"sigma_source\":\"jackknife\""), std::string::npos);
  const auto& poses = document->solution.poses;
  EXPECT_FALSE(poses[0].by_jackknife);
  for (const int v : {1, 2}) {
    ASSERT_TRUE(poses[static_cast<std::size_t>(v)].by_jackknife);
    const SensorPose& pose = poses[static_cast<std::size_t>(v)];
    EXPECT_NEAR(pose.covariance(0, 0), 4.0 * pose.covariance_analytic(0, 0), 1e-12);
  }
  EXPECT_TRUE(document->solution.residuals[0].by_jackknife);
  EXPECT_NEAR(poses[1].covariance_analytic(0, 0), 2.0 / 3.0 * 1e-6, 1e-12);
  const auto answer = Ask("lookup", R"({"robot":"r","a":"b","b":"c"})");
  ASSERT_TRUE(answer) << Sentence(answer.error());
  // Along x nothing turns: by symmetry every pair of the triangle is known equally well.
  const std::string key = "\"covariance\":[[";
  const double variance = std::stod(answer->substr(answer->find(key) + key.size()));
  EXPECT_NEAR(variance, 4.0 * 2.0 / 3.0 * 1e-6, 1e-11);
}

// A revision from before its poses were kept: the same answer, derived from its document and the block vectors.
TEST_F(AnswerTest, LookupOfARevisionFromBeforeIsDerived) {
  StoreEdges(Triangle("r"));
  StepAll();
  const auto numbers = [](const std::string& answer) {
    std::vector<double> values;
    const std::size_t from = answer.find("\"T_a_b\""), covariance = answer.find("\"covariance\"");
    for (const std::size_t first : {from, covariance})
      for (std::size_t at = answer.find('[', first); at < answer.size() && values.size() < 43;
           at = answer.find_first_of("[,", at + 1))
        if (const char next = answer[at + 1]; next == '-' || (next >= '0' && next <= '9'))
          values.push_back(std::stod(answer.substr(at + 1)));
    return values;
  };
  const auto kept = Ask("lookup", R"({"robot":"r","a":"b","b":"c"})");
  ASSERT_TRUE(kept) << Sentence(kept.error());
  store_->database().exec(
      "DROP TRIGGER revision_pose_no_delete; DROP TRIGGER revision_covariance_no_delete; "
      "DELETE FROM revision_pose; DELETE FROM revision_covariance");
  const auto derived = Ask("lookup", R"({"robot":"r","a":"b","b":"c"})");
  ASSERT_TRUE(derived) << Sentence(derived.error());
  const std::vector<double> x = numbers(*kept), y = numbers(*derived);
  ASSERT_EQ(x.size(), y.size());
  ASSERT_GE(x.size(), 43u);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i], y[i], 1e-12 + 1e-9 * std::abs(x[i])) << i;
}

// Likewise where sessions were fused: by their covariance, which the document has, and by no edge.
TEST_F(AnswerTest, LookupOfAFusedRevisionFromBeforeIsReadFromItsDocument) {
  StoreEdges(Triangle("r"));
  StepAll();
  Revision revision = storage::LoadRevision(*store_, RobotId("r"), 0).value().value();
  auto input = formats::ReadRevisionDocument(revision.document).value();
  input.solution.fused.sessions = {SessionId(std::string(64, '1'))};
  input.solution.fused.sensors = {SensorId("b"), SensorId("c")};
  input.solution.fused.covariance = 4e-8 * Eigen::MatrixXd::Identity(12, 12);
  revision.document = formats::WriteRevisionDocument(input);
  revision.digest = Sha256Of(revision.document);
  ASSERT_TRUE(store_->Write([&]() -> Status {
    RIGCAL_ASSIGN(revision.number, storage::AppendRevision(*store_, revision));
    return {};
  }));
  const auto answer = Ask("lookup", R"({"robot":"r","a":"a","b":"b","revision":2})");
  ASSERT_TRUE(answer) << Sentence(answer.error());
  const std::string key = "\"covariance\":[[";
  EXPECT_NEAR(std::stod(answer->substr(answer->find(key) + key.size())), 4e-8, 1e-15) << *answer;
}

TEST_F(AnswerTest, WhatCannotBeAnsweredIsSaidByName) {
  StoreEdges(Triangle("r"));
  StepAll();
  const auto unknown_robot = Ask("show", R"({"robot":"nobody"})");
  ASSERT_FALSE(unknown_robot);
  EXPECT_EQ(unknown_robot.error().code, ErrorCode::kNotFound);
  EXPECT_NE(unknown_robot.error().what.find("nobody"), std::string::npos);
  const auto unknown_sensor = Ask("lookup", R"({"robot":"r","a":"a","b":"zz"})");
  ASSERT_FALSE(unknown_sensor);
  EXPECT_EQ(unknown_sensor.error().code, ErrorCode::kNotFound);
  EXPECT_EQ(Ask("show", "[1]").error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(Ask("show", R"({"robot":"r","revision":99})").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(Ask("show", R"({"robot":"r","revision":"x"})").error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(Ask("format_disk", "{}").error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(Ask("lookup", R"({"robot":"r","a":"a"})").error().code, ErrorCode::kInvalidInput);
}

TEST_F(AnswerTest, PagesOfFleetAndRobotAreHtmlAndTheApiIsJson) {
  StoreEdges(Triangle("r"));
  StepAll();
  const AnswerContext context{*store_, clock_, revisions_cache_, clock_.now, ""};
  for (const std::string path : {"/", "/robots/r/"}) {
    const auto page = AnswerPage(context, path, "");
    ASSERT_TRUE(page) << path << Sentence(page.error());
    EXPECT_EQ(page->content_type.rfind("text/html", 0), 0u);
  }
  const auto api = AnswerPage(context, "/api/v1/show", "robot=r&revision=1");
  ASSERT_TRUE(api) << Sentence(api.error());
  EXPECT_EQ(api->body, *Ask("show", R"({"robot":"r","revision":1})"));
  EXPECT_EQ(AnswerPage(context, "/robots/nobody/", "").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(AnswerPage(context, "/robots//", "").error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(AnswerPage(context, "/nowhere", "").error().code, ErrorCode::kNotFound);
}

TEST_F(AnswerTest, PagesOfOneRobot) {
  StoreEdges(Triangle("r"));
  StepAll();
  const AnswerContext context{*store_, clock_, revisions_cache_, clock_.now, ""};
  const auto compare = AnswerPage(context, "/robots/r/compare", "a=1&b=1");
  ASSERT_TRUE(compare) << Sentence(compare.error());
  EXPECT_NE(compare->body.find("revision 1 and 1"), std::string::npos);
  const auto trend = AnswerPage(context, "/robots/r/trend.js", "");
  ASSERT_TRUE(trend) << Sentence(trend.error());
  EXPECT_EQ(trend->body.rfind("window.rigcal = {\"trends\":[{", 0), 0u);
  const auto filtered = AnswerPage(context, "/", "q=nobody&page=7");
  ASSERT_TRUE(filtered) << Sentence(filtered.error());
  EXPECT_NE(filtered->body.find("0 of 1 robot"), std::string::npos);
  EXPECT_EQ(AnswerPage(context, "/robots/r/compare", "a=1&b=9").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(AnswerPage(context, "/", "page=x").error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(AnswerPage(context, "/robots/r/sessions/x/", "").error().code, ErrorCode::kInvalidInput);
  const std::string unknown = Sha256Of("no session").str();
  EXPECT_EQ(AnswerPage(context, "/robots/r/sessions/" + unknown + "/", "").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(AnswerPage(context, "/robots/r/nothing", "").error().code, ErrorCode::kNotFound);
}

TEST_F(AnswerTest, ScriptsAreKeptForEverUnderTheNameOfTheirContent) {
  const AnswerContext context{*store_, clock_, revisions_cache_, clock_.now, ""};
  for (const report::Asset& asset : report::Assets()) {
    const auto script = AnswerPage(context, "/assets/" + asset.name, "");
    ASSERT_TRUE(script) << asset.name;
    EXPECT_TRUE(script->immutable);
    EXPECT_EQ(script->body, asset.bytes);
    EXPECT_NE(asset.name.find(Sha256Of(asset.bytes).str().substr(0, 12)), std::string::npos);
  }
  EXPECT_EQ(AnswerPage(context, "/assets/rig.js", "").error().code, ErrorCode::kNotFound);
}

TEST_F(AnswerTest, LiveChangesOnlyWithTheState) {
  StoreEdges(Triangle("r"));
  StepAll();
  const std::string first = *Ask("live", R"({"robot":"r"})");
  clock_.now.ns += 1'000'000'000;
  EXPECT_EQ(*Ask("live", R"({"robot":"r"})"), first);
  EXPECT_NE(first.find("\"revision\":1"), std::string::npos);
  StoreEdges(Triangle("other"));
  EXPECT_EQ(*Ask("live", R"({"robot":"r"})"), first);
  EXPECT_NE(Ask("live", "{}")->find("\"unfinished\":1"), std::string::npos);
}

// What the pieces make is the published file; nothing outside the folder is handed out.
TEST_F(AnswerTest, FilesOfAReport) {
  StoreEdges(Triangle("r"));
  StepAll();
  const std::string list = *Ask("report_files", R"({"robot":"r"})");
  for (const char* file : {"\"index.html\"", "\"data.js\"", "\"edges.csv\"", "\"assets/rig-"})
    EXPECT_NE(list.find(file), std::string::npos) << file;
  std::ifstream stored(store_->ReportFolder() / "r" / "1" / "index.html", std::ios::binary);
  const std::string page((std::istreambuf_iterator<char>(stored)), {});
  const std::string piece = *Ask("report_file", R"({"robot":"r","path":"index.html","offset":0})");
  EXPECT_NE(piece.find("\"base64\":\"" + ToBase64(page) + "\""), std::string::npos);
  for (const char* path : {"../../../rigcal.db", "/etc/passwd", "..", "", "assets", "index.html/."})
    EXPECT_EQ(Ask("report_file", R"({"robot":"r","path":")" + std::string(path) + R"(","offset":0})").error().code,
              ErrorCode::kNotFound)
        << path;
  EXPECT_FALSE(Ask("report_file", R"({"robot":"r","path":"index.html","offset":-1})"));
  EXPECT_FALSE(Ask("report_file", R"({"robot":"r","path":"index.html","offset":99999999})"));
}

}  // namespace
}  // namespace rigcal::pipeline
