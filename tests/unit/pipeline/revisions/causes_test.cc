// Causes of failed pairs from the edges of a robot to what is told of it.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "server/pipeline/answers/answer.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using nlohmann::json;

// No board in any of the pictures of `blind`.
Edge UnseenBy(const std::string& robot, const std::string& blind, const std::string& other) {
  Edge edge = GivenEdge(robot, other, blind, 0.0);
  edge.state = EdgeState::kFailed;
  edge.T_a_b = Se3();
  edge.uncertainty = Uncertainty();
  edge.method = "stereo";
  edge.diagnoses = {{"too_few_captures", "No capture shows the board to both.", "Take more."}};
  edge.figures = {
      {"captures_total", 12}, {"files_a", 12}, {"files_with_board_a", 12}, {"files_b", 12}, {"files_with_board_b", 0}};
  return edge;
}

// A triangle that is well, and a camera that sees no board beside two of its sensors.
std::vector<Edge> WithBlind(const std::string& robot) {
  std::vector<Edge> edges = Triangle(robot), failed = {UnseenBy(robot, "rear", "a"), UnseenBy(robot, "rear", "b")};
  AssignPushedIds(failed);
  edges.insert(edges.end(), failed.begin(), failed.end());
  return edges;
}

class CausesTest : public PipelineTest {
 protected:
  RevisionCache revisions_cache_;
  AnswerContext Context() { return {*store_, clock_, revisions_cache_, clock_.now, ""}; }
  json Show(const std::string& parameters) {
    const auto answer = Answer(Context(), "show", parameters);
    EXPECT_TRUE(answer) << Sentence(answer.error());
    return json::parse(answer.value_or("{}"))["document"];
  }
};

TEST_F(CausesTest, ARevisionKeepsThem) {
  const std::vector<Edge> edges = WithBlind("r");
  StoreEdges(edges);
  StepAll();
  for (const char* parameters : {R"({"robot":"r"})", R"({"robot":"r","whole":true})"}) {
    const json causes = Show(parameters)["causes"];
    ASSERT_EQ(causes.size(), 1u) << causes;
    EXPECT_EQ(causes[0]["kind"], "board_unseen");
    EXPECT_EQ(causes[0]["key"], "board_unseen rear");
    EXPECT_EQ(causes[0]["sensors"], json::array({"rear"}));
    EXPECT_EQ(causes[0]["why"], "rear sees a board in none of 12 pictures.");
    EXPECT_EQ(causes[0]["command"], "rigcal check FOLDER");
    EXPECT_THAT(causes[0]["edges"].get<std::vector<std::string>>(),
                testing::UnorderedElementsAre(edges[3].id.str(), edges[4].id.str()));
  }
}

TEST_F(CausesTest, WhereAllIsWellThereAreNone) {
  StoreEdges(Triangle("r"));
  StepAll();
  EXPECT_FALSE(Show(R"({"robot":"r"})").contains("causes"));
}

}  // namespace
}  // namespace rigcal::pipeline
