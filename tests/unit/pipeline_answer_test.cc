#include <cmath>

#include "server/formats/documents.h"
#include "server/pipeline/answer.h"
#include "tests/unit/pipeline_fixture.h"

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

TEST_F(AnswerTest, LookupComposesThroughTheReference) {
  StoreEdges(Triangle("r"));
  StepAll();
  const auto answer = Ask("lookup", R"({"robot":"r","a":"b","b":"c"})");
  ASSERT_TRUE(answer) << Sentence(answer.error());
  EXPECT_NE(answer->find("\"frame_a\":\"b\""), std::string::npos);
  // Pose of c in b: 2.002 - 1.001, up to the last bits.
  EXPECT_NE(answer->find("\"p_m\":[1.00"), std::string::npos) << *answer;
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

}  // namespace
}  // namespace rigcal::pipeline
