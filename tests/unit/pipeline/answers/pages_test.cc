// Lists by pages, as verbs answer them and as the robot's page links them; and the report of a revision that refers to
// its edges.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "server/pipeline/answers/answer.h"
#include "storage/revisions/revisions.h"
#include "storage/work/jobs.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

class ListPagesTest : public PipelineTest {
 protected:
  AnswerContext Context() { return {*store_, clock_, cache_, clock_.now, ""}; }
  Result<std::string> Ask(const std::string& verb, const json& parameters) {
    return Answer(Context(), verb, parameters.dump());
  }
  // The rows of all pages, one after the other.
  json ByPages(const std::string& verb, int limit, json parameters = {{"robot", "r"}}) {
    json rows = json::array();
    parameters["limit"] = limit;
    for (int page = 0; page < 100; ++page) {
      const auto answer = Ask(verb, parameters);
      if (!answer) ADD_FAILURE() << Sentence(answer.error());
      json document = json::parse(answer.value_or(R"({"next":null})"));
      EXPECT_LE(document[verb].size(), static_cast<std::size_t>(limit));
      for (const json& row : document[verb]) rows.push_back(row);
      if (document.at("next").is_null()) return rows;
      parameters["before"] = document["next"];
    }
    ADD_FAILURE() << "no page is the last";
    return rows;
  }
  json Whole(const std::string& verb) {
    const json document = json::parse(Ask(verb, {{"robot", "r"}}).value());
    EXPECT_FALSE(document.contains("next"));
    return document[verb];
  }
  // The first one solved, the others alike.
  void Revisions(int count) {
    StoreEdges(Triangle("r"));
    StepAll();
    const Revision first = storage::LoadRevision(*store_, RobotId("r"), 1).value().value();
    ASSERT_TRUE(store_->Write([&]() -> Status {
      for (int i = 1; i < count; ++i) RIGCAL_TRY(storage::AppendRevision(*store_, first));
      return {};
    }));
  }
  SessionId StoreSessionNumber(int number) {
    clock_.now.ns += 1'000'000'000;
    return StoreSession(
        "r", {{"left/1.png", "left " + std::to_string(number)}, {"right/1.png", "right " + std::to_string(number)}});
  }
  std::string Page(const std::string& query) {
    const auto page = AnswerPage(Context(), "/robots/r/", query);
    return page ? page->body : Sentence(page.error());
  }

  RevisionCache cache_;
};

TEST_F(ListPagesTest, RevisionsByPagesAreTheList) {
  Revisions(7);
  const json whole = Whole("revisions");
  ASSERT_EQ(whole.size(), 7U);
  for (const int limit : {1, 3, 7, 1000}) EXPECT_EQ(ByPages("revisions", limit), whole) << limit;
  const json page = json::parse(Ask("revisions", {{"robot", "r"}, {"limit", 2}, {"before", 6}}).value());
  EXPECT_EQ(page["revisions"][0]["revision"], 5);
  EXPECT_EQ(page["next"], 4);
}

TEST_F(ListPagesTest, SessionsByPagesAreTheList) {
  for (int number = 0; number < 5; ++number) StoreSessionNumber(number);
  StoreSession("r", {{"left/1.png", "left 2"}, {"right/1.png", "right 2"}},
               {SensorId("left")});  // supersedes the third
  StoreSession("other", {{"left/1.png", "o"}});
  const json whole = Whole("sessions");
  ASSERT_EQ(whole.size(), 6U);
  for (const int limit : {1, 2, 6}) EXPECT_EQ(ByPages("sessions", limit), whole) << limit;
  const json all = json::parse(Ask("sessions", json::object()).value())["sessions"];
  EXPECT_EQ(ByPages("sessions", 2, json::object()), all);
  EXPECT_TRUE(std::any_of(all.begin(), all.end(), [](const json& row) { return !row["superseded_by"].is_null(); }));
}

TEST_F(ListPagesTest, EdgesByPagesAreTheListTheNewestFirst) {
  std::vector<Edge> edges = Triangle("r");
  edges.push_back(GivenEdge("r", "a", "d", 3.0));
  AssignPushedIds(edges);
  for (const Edge& edge : edges) StoreEdges({edge});
  StepAll();
  const json whole = Whole("edges");
  for (const int limit : {1, 3, 4}) {
    const json rows = ByPages("edges", limit);
    ASSERT_EQ(rows.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
      const std::string id = edges[3 - i].id.str();
      EXPECT_EQ(rows[i]["id"], id) << limit;
      EXPECT_NE(std::find(whole.begin(), whole.end(), rows[i]), whole.end()) << id;  // with its residual
    }
  }
}

// The edge that took the place of one whose file was lost is on another page.
TEST_F(ListPagesTest, AnEdgeIsPastOnWhateverPageTheOtherIs) {
  const SessionId session = StoreSessionNumber(1);
  Edge lost = GivenEdge("r", "left", "right", 1.0);
  lost.session = session, lost.method = "stereo", lost.state = EdgeState::kFailed;
  lost.id = EstimatedEdgeId(lost.robot, session, lost.method, lost.frame_a, lost.frame_b);
  lost.diagnoses = {{"file_lost", "a file was lost", "Push the session again."}};
  Edge again = GivenEdge("r", "left", "right", 1.0);
  again.session = session, again.method = "stereo", again.id = RepeatedEdgeId(lost.id);
  StoreEdges({lost, again});
  const json rows = ByPages("edges", 1);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0]["state"], "good");
  EXPECT_EQ(rows[1]["diagnoses"][0]["code"], "superseded");
}

TEST_F(ListPagesTest, WhatIsNoPageIsRefused) {
  Revisions(2);
  for (const int limit : {0, -1, 1001})
    for (const char* verb : {"revisions", "sessions", "edges"}) {
      const auto answer = Ask(verb, {{"robot", "r"}, {"limit", limit}});
      ASSERT_FALSE(answer) << verb;
      EXPECT_EQ(answer.error().what, "the parameter 'limit' is " + std::to_string(limit));
    }
  EXPECT_EQ(Ask("revisions", {{"robot", "r"}, {"before", 0}}).error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(Ask("revisions", {{"robot", "r"}, {"before", "x"}}).error().code, ErrorCode::kInvalidInput);
  const std::string none(64, '0');
  EXPECT_EQ(Ask("sessions", {{"robot", "r"}, {"before", none}}).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(Ask("edges", {{"robot", "r"}, {"before", none}}).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(Ask("edges", {{"robot", "r"}, {"before", "x"}}).error().code, ErrorCode::kInvalidInput);
  const json rest =
      json::parse(Ask("revisions", {{"robot", "r"}, {"before", 2}}).value());  // as many as a page may have
  EXPECT_EQ(rest["revisions"].size(), 1U);
  EXPECT_TRUE(rest.at("next").is_null());
}

TEST_F(ListPagesTest, TheRobotsPageListsTheNewestAndLinksTheOthers) {
  Revisions(60);
  std::vector<SessionId> sessions;
  for (int number = 0; number < 53; ++number) sessions.push_back(StoreSessionNumber(number));
  const std::string first = Page("");
  for (const char* text : {">revision 60</a>", ">revision 11</a>", "href=\"?before=11#revisions\"",
                           "revisions/60/\">Report of revision 60"})
    EXPECT_THAT(first, HasSubstr(text));
  EXPECT_THAT(first, Not(HasSubstr(">revision 10</a>")));
  EXPECT_THAT(first, HasSubstr("sessions/" + sessions[3].str() + "/"));
  EXPECT_THAT(first, HasSubstr("href=\"?sessions_before=" + sessions[3].str() + "#sessions\""));
  const std::string older = Page("before=11");
  EXPECT_THAT(older, HasSubstr(">revision 10</a>"));
  EXPECT_THAT(older, HasSubstr("the first"));
  EXPECT_THAT(older, Not(HasSubstr("Older revisions")));
  EXPECT_THAT(older, HasSubstr("href=\"./#revisions\""));
  const std::string oldest = Page("sessions_before=" + sessions[3].str());
  EXPECT_THAT(oldest, HasSubstr("sessions/" + sessions[0].str() + "/\"><code>"));
  EXPECT_THAT(oldest, Not(HasSubstr("Older sessions")));
  EXPECT_EQ(AnswerPage(Context(), "/robots/r/", "before=x").error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(AnswerPage(Context(), "/robots/r/", "sessions_before=x").error().code, ErrorCode::kInvalidInput);
}

TEST_F(ListPagesTest, AnOpenSessionIsOnThePageHoweverManyCameSince) {
  Manifest manifest;
  manifest.header.robot = RobotId("r");
  manifest.header.captured_at = clock_.now;
  AddFile("left/1.png", "never came", manifest);
  const std::string text = formats::WriteManifest(manifest);
  const SessionId open(Sha256Of(text).str());
  ASSERT_TRUE(storage::AppendSession(*store_, open, text, manifest, clock_.now));
  for (int number = 0; number < 52; ++number) StoreSessionNumber(number);
  for (auto job = storage::LoadNextJob(*store_, {}); job && *job; job = storage::LoadNextJob(*store_, {}))
    ASSERT_TRUE(storage::FinishJob(*store_, (*job)->number, clock_.now));
  const std::string page = Page("");
  EXPECT_THAT(page, HasSubstr("<a href=\"sessions/" + open.str() + "/\">Session " + open.str().substr(0, 12) +
                              "</a> is arriving"));
  EXPECT_THAT(page, Not(HasSubstr("sessions/" + open.str() + "/\"><code>")));
  EXPECT_THAT(page, HasSubstr("Older sessions"));
}

}  // namespace
}  // namespace rigcal::pipeline
