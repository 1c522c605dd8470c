// A revision refers to its edges; with the store beside it, it is whole again: what reports show and `show` tells when
// it is asked to.
#include "server/pipeline/revisions/whole_revision.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "server/pipeline/answers/answer.h"
#include "server/pipeline/revisions/revise.h"
#include "storage/revisions/merged_edges.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/retired.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class WholeRevisionTest : public PipelineTest {
 protected:
  // An edge of each kind of detail.
  static Edge DetailedEdge(const std::string& a, const std::string& b, double x_m) {
    Edge edge = GivenEdge("r", a, b, x_m);
    edge.uncertainty.source = UncertaintySource::kJackknife;
    edge.uncertainty.dof = 11;
    for (int axis = 0; axis < 6; ++axis)
      for (const double sign : {1.0, -1.0})
        edge.uncertainty.blocks.push_back(
            {std::to_string(axis) + (sign > 0.0 ? "+" : "-"), sign * 1e-3 * Vector6d::Unit(axis)});
    edge.uncertainty.contributions = {{"square_size_m", 1e-8 * Matrix6d::Identity(), {1e-4 * Vector6d::Ones()}}};
    edge.figures = {{"rms_px", 0.19}, {"fx_px", 1500.0}};
    edge.captures = {{CaptureId("01"), 0.21, true, ""}, {CaptureId("02"), 0.0, false, "no board"}};
    edge.evidence = {{"a / 01: 54 corners", SensorId(a), CaptureId("01"), Sha256Of("picture"), "jpg"}};
    edge.diagnoses = {{"few", "only 2 captures", "Take more."}};
    return edge;
  }
  static std::vector<Edge> DetailedTriangle(double off_m = 0.0) {
    std::vector<Edge> edges = {DetailedEdge("a", "b", 1.0 + off_m), DetailedEdge("b", "c", 1.0 - off_m),
                               DetailedEdge("a", "c", 2.003 + off_m)};
    AssignPushedIds(edges);
    return edges;
  }
  Revision Revised() { return Revise(*store_, kRig, clock_).value(); }
  Revision Stored(int number) { return storage::LoadRevision(*store_, kRig, number).value().value(); }
  void Weeks(int count) {
    for (int week = 0; week < count; ++week) {
      clock_.now.ns += 7LL * 86'400 * 1'000'000'000;
      StoreEdges(DetailedTriangle(1e-6 * week));
      (void)Revised();
    }
  }
  Result<std::string> Ask(const std::string& verb, const std::string& parameters) {
    return Answer({*store_, clock_, cache_, clock_.now, ""}, verb, parameters);
  }

  RevisionCache cache_;
};

// Every member that the verb `edge` tells, but block vectors.
TEST_F(WholeRevisionTest, HasEveryDetailOfItsEdges) {
  StoreEdges(DetailedTriangle());
  const Revision revision = Revised();
  EXPECT_FALSE(formats::ReadRevisionDocument(revision.document)->whole);
  EXPECT_EQ(revision.document.find("54 corners"), std::string::npos);
  const auto whole = LoadWholeRevision(*store_, revision, Blocks::kLoaded);
  ASSERT_TRUE(whole) << Sentence(whole.error());
  EXPECT_TRUE(whole->whole);
  const json document = json::parse(formats::WriteWholeRevisionDocument(*whole));
  ASSERT_EQ(document["edges"].size(), 3U);
  for (json told : document["edges"]) {
    EXPECT_TRUE(told.contains("residual") && told.contains("influence"));
    told.erase("residual"), told.erase("influence");
    json stored = json::parse(Ask("edge", R"({"id":")" + told["id"].get<std::string>() + R"("})").value());
    EXPECT_EQ(stored["blocks"].size(), 12U);
    stored.erase("blocks");
    EXPECT_EQ(told, stored);
  }
  for (const Edge& edge : whole->edges) EXPECT_EQ(edge.uncertainty.blocks.size(), 12U);
  EXPECT_TRUE(LoadWholeRevision(*store_, revision, Blocks::kLeftOut)->edges.front().uncertainty.blocks.empty());
  EXPECT_EQ(formats::WriteRevisionDocument(*whole), revision.document);
}

TEST_F(WholeRevisionTest, APastEdgeIsWhatTheRevisionSays) {
  const std::vector<Edge> edges = DetailedTriangle();
  StoreEdges(edges);
  const Revision before = Revised();
  ASSERT_TRUE(storage::RetireEdge(*store_, edges[1].id, {clock_.now, "Ada", "typed wrong"}));
  const Revision after = Revised();
  const auto find = [&](const Revision& revision) {
    const auto whole = LoadWholeRevision(*store_, revision, Blocks::kLoaded).value();
    return *std::find_if(whole.edges.begin(), whole.edges.end(),
                         [&](const Edge& edge) { return edge.id == edges[1].id; });
  };
  EXPECT_EQ(find(before).state, EdgeState::kGood);  // as it was then
  EXPECT_EQ(find(before).diagnoses, edges[1].diagnoses);
  const Edge past = find(after);
  EXPECT_EQ(past.state, EdgeState::kFailed);
  ASSERT_EQ(past.diagnoses.size(), 1U);
  EXPECT_EQ(past.diagnoses[0].code, "retired");
  EXPECT_EQ(past.captures.size(), 2U);
  EXPECT_EQ(past.figures, edges[1].figures);
  EXPECT_EQ(past.uncertainty.rank, 0);
  EXPECT_TRUE(past.uncertainty.blocks.empty() && past.uncertainty.contributions.empty());
  EXPECT_EQ(past.T_a_b, Se3());
}

TEST_F(WholeRevisionTest, AMergedEdgeIsThatOfTheRevision) {
  Weeks(12);
  const auto older = LoadWholeRevision(*store_, Stored(10), Blocks::kLeftOut),
             newest = LoadWholeRevision(*store_, Stored(0), Blocks::kLeftOut);
  ASSERT_TRUE(older) << Sentence(older.error());
  ASSERT_TRUE(newest) << Sentence(newest.error());
  for (const auto& [whole, merged] : {std::pair(&*older, 2.0), std::pair(&*newest, 4.0)}) {
    int seen = 0;
    for (const Edge& edge : whole->edges) {
      if (!IsMerged(edge)) continue;
      ++seen;
      EXPECT_EQ(edge.figures.at(kMergedEdges), merged);
      EXPECT_NEAR(edge.uncertainty.Omega(0, 0), merged * 1e6, 1.0);
      EXPECT_FALSE(edge.uncertainty.contributions.empty());
      EXPECT_TRUE(edge.uncertainty.blocks.empty());
    }
    EXPECT_EQ(seen, 3);
  }
}

TEST_F(WholeRevisionTest, TheVerbEdgeKnowsMergedOnesOfTheNewestRevision) {
  Weeks(10);
  const auto merged_ids = [&](int number) {
    std::vector<std::string> ids;
    const auto document = formats::ReadRevisionDocument(Stored(number).document).value();
    for (const Edge& edge : document.edges)
      if (IsMerged(edge)) ids.push_back(edge.id.str());
    return ids;
  };
  const auto ids = merged_ids(0);
  ASSERT_EQ(ids.size(), 3U);
  for (const std::string& id : ids) {
    const auto answer = Ask("edge", R"({"id":")" + id + R"("})");
    ASSERT_TRUE(answer) << Sentence(answer.error());
    const json edge = json::parse(*answer);
    EXPECT_EQ(edge["id"], id);
    EXPECT_EQ(edge["robot"], "r");
    EXPECT_EQ(edge["figures"]["merged_edges"], 2.0);
    EXPECT_FALSE(edge["blocks"].empty());
  }
  EXPECT_EQ(Ask("edge", R"({"id":")" + merged_ids(9).front() + R"("})").error().code, ErrorCode::kNotFound);
  store_->database().exec(
      "DELETE FROM merge_state_edge");  // a store whose newest revision is from before ids were kept
  EXPECT_EQ(Ask("edge", R"({"id":")" + ids[0] + R"("})").error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(Ask("edge", R"({"robot":"r","id":")" + ids[0] + R"("})"));
}

TEST_F(WholeRevisionTest, AnEdgeThatTheStoreDoesNotHaveIsNamed) {
  StoreEdges(DetailedTriangle());
  Revision revision = Revised();
  auto document = formats::ReadRevisionDocument(revision.document).value();
  document.edges[1].id = EdgeId(std::string(64, 'e'));
  revision.document = formats::WriteRevisionDocument(document);
  const auto whole = LoadWholeRevision(*store_, revision, Blocks::kLeftOut);
  ASSERT_FALSE(whole);
  EXPECT_EQ(whole.error().code, ErrorCode::kStorage);
  EXPECT_EQ(whole.error().what,
            "revision 1 of robot r refers to edge " + std::string(64, 'e') + ", which is not in the store");
}

// As versions before wrote it: what it says stays, block vectors come beside it.
TEST_F(WholeRevisionTest, ADocumentOfFormat1IsWholeByItself) {
  StoreEdges(DetailedTriangle());
  Revision revision = Revised();
  auto input = LoadWholeRevision(*store_, revision, Blocks::kLeftOut).value();
  for (Edge& edge : input.edges) edge.captures[1].note = "as it was said then";
  revision.document = formats::WriteWholeRevisionDocument(input);
  revision.digest = Sha256Of(revision.document);
  ASSERT_EQ(storage::AppendRevision(*store_, revision).value(), 2);
  const auto whole = LoadWholeRevision(*store_, Stored(2), Blocks::kLoaded);
  ASSERT_TRUE(whole) << Sentence(whole.error());
  for (const Edge& edge : whole->edges) {
    EXPECT_EQ(edge.captures[1].note, "as it was said then");
    EXPECT_EQ(edge.uncertainty.blocks.size(), 12U);
  }
  for (const char* parameters : {R"({"robot":"r"})", R"({"robot":"r","whole":true})"})
    EXPECT_THAT(Ask("show", parameters).value(), HasSubstr(revision.document));
}

TEST_F(WholeRevisionTest, ShowTellsAllWhenItIsAskedTo) {
  StoreEdges(DetailedTriangle());
  const Revision revision = Revised();
  const json told = json::parse(Ask("show", R"({"robot":"r"})").value()),
             whole = json::parse(Ask("show", R"({"robot":"r","whole":true})").value());
  EXPECT_EQ(told["document"]["format"], 2);
  EXPECT_EQ(whole["document"]["format"], 1);
  EXPECT_EQ(whole["digest"], told["digest"]);
  EXPECT_EQ(whole["document"]["sensors"], told["document"]["sensors"]);
  EXPECT_EQ(whole["document"]["edges"][0]["evidence"].size(), 1U);
  EXPECT_FALSE(told["document"]["edges"][0].contains("evidence"));
  EXPECT_TRUE(formats::ReadRevisionDocument(whole["document"].dump())->whole);
  EXPECT_EQ(Ask("show", R"({"robot":"r","whole":"maybe"})").error().code, ErrorCode::kInvalidInput);
}

}  // namespace
}  // namespace rigcal::pipeline
