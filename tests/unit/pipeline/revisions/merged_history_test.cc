// A robot whose pairs were pushed week after week: its revisions hold the newest edges and what the older ones say
// together.
#include <nlohmann/json.hpp>
#include <random>

#include "server/graph/fusion/merged_edge.h"
#include "server/graph/solve/solve.h"
#include "server/model/approval/standing.h"
#include "server/pipeline/answers/answer.h"
#include "server/pipeline/orders/orders.h"
#include "server/pipeline/revisions/live_graphs.h"
#include "server/pipeline/revisions/revise.h"
#include "storage/revisions/merged_edges.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/retired.h"
#include "storage/settings/policies.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

const RobotId kOld("r");
const std::vector<std::pair<const char*, const char*>> kMeasured = {{"a", "b"}, {"b", "c"}, {"a", "c"}};

class MergedHistoryTest : public PipelineTest {
 protected:
  // One edge of each pair, 0.1 mm off in turn, and a revision; sensor c has been moved by so much.
  void Week(int week, double c_moved_m = 0.0) {
    std::vector<Edge> edges;
    for (const auto& [a, b] : kMeasured)
      edges.push_back(GivenEdge(
          "r", a, b, (b[0] - a[0]) + 1e-4 * ((week % 3) - 1) + 1e-7 * week + (b[0] == 'c' ? c_moved_m : 0.0)));
    Push(std::move(edges));
  }
  void Push(std::vector<Edge> edges) {
    clock_.now.ns += 7LL * 86'400 * 1'000'000'000;
    AssignPushedIds(edges);
    StoreEdges(edges);
    ids_.push_back(edges.front().id);
    Revised();
    EXPECT_EQ(calibrated_at_.ns, clock_.now.ns);
  }
  void Revised() {
    auto revised = Revise(*store_, kOld, clock_);
    ASSERT_TRUE(revised) << Sentence(revised.error());
    newest_ = *formats::ReadRevisionDocument(revised->document);
    calibrated_at_ = *revised->calibrated_at;
  }
  // Of the newest revision.
  [[nodiscard]] std::vector<const Edge*> Merged() const {
    std::vector<const Edge*> merged;
    for (const Edge& edge : newest_.edges)
      if (IsMerged(edge)) merged.push_back(&edge);
    return merged;
  }
  // Of all edges ever, but for one.
  GraphSolution Whole(const EdgeId& without = {}) {
    auto edges = storage::LoadEdges(*store_, kOld, true).value();
    std::erase_if(edges, [&](const Edge& edge) { return edge.id == without; });
    return graph::Solve(graph::GraphOf(edges, SensorId("a")));
  }
  static void ExpectSamePoses(const GraphSolution& x, const GraphSolution& y) {
    ASSERT_EQ(x.poses.size(), y.poses.size());
    for (std::size_t s = 0; s < x.poses.size(); ++s) {
      EXPECT_LT((x.poses[s].T_ref_sensor.p_m - y.poses[s].T_ref_sensor.p_m).norm(), 1e-9);
      EXPECT_LT((x.poses[s].covariance - y.poses[s].covariance).norm(), 1e-6 * (1e-30 + x.poses[s].covariance.norm()));
    }
  }

  // As many edges as the newest revision holds or has merged.
  [[nodiscard]] int Counted() const {
    int counted = 0;
    for (const Edge& edge : newest_.edges)
      counted += IsMerged(edge) ? static_cast<int>(edge.figures.at(kMergedEdges)) : 1;
    return counted;
  }

  std::vector<EdgeId> ids_;
  formats::RevisionInput newest_;
  Stamp calibrated_at_;
};

TEST_F(MergedHistoryTest, ARevisionHoldsAsManyEdgesHoweverManyCameBefore) {
  for (int week = 0; week < 30; ++week) Week(week);
  EXPECT_EQ(newest_.edges.size(), 9 * kMeasured.size());
  int merged = 0;
  for (const Edge& edge : newest_.edges)
    if (IsMerged(edge)) merged += static_cast<int>(edge.figures.at(kMergedEdges));
  EXPECT_EQ(merged, 22 * static_cast<int>(kMeasured.size()));
  ExpectSamePoses(Whole(), newest_.solution);
}

TEST_F(MergedHistoryTest, APolicySaysHowManyVisitsStayAsTheyAreAndReachesBack) {
  for (int week = 0; week < 20; ++week) Week(week);
  EXPECT_EQ(newest_.policy->policy.visits_in_full, std::nullopt);
  for (const int visits : {12, 32, 5, 8}) {
    ASSERT_TRUE(store_->Write([&]() -> Status {
      RIGCAL_TRY(storage::AppendPolicy(*store_, {}, "visits_in_full: " + std::to_string(visits) + "\n",
                                       {clock_.now, "Ada", "more of them"}));
      return {};
    }));
    Revised();
    const std::size_t in_full = static_cast<std::size_t>(std::min(visits, 20)), merged = in_full < 20 ? 1 : 0;
    EXPECT_EQ(newest_.edges.size(), (in_full + merged) * kMeasured.size()) << visits;
    EXPECT_EQ(newest_.policy->policy.visits_in_full, visits);
    EXPECT_EQ(Counted(), 20 * static_cast<int>(kMeasured.size()));
    ExpectSamePoses(Whole(), newest_.solution);
  }
}

TEST_F(MergedHistoryTest, ARetiredEdgeOfLongAgoTakesNoPartAnyMore) {
  for (int week = 0; week < 20; ++week) Week(week);
  ASSERT_TRUE(storage::RetireEdge(*store_, ids_[2], {{4}, "Ada", "typed wrong"}));
  const auto loaded = LoadRobotGraph(*store_, kOld);
  ASSERT_TRUE(loaded);
  ExpectSamePoses(Whole(ids_[2]), graph::Solve(loaded->graph));
  Week(20);
  ExpectSamePoses(Whole(ids_[2]), newest_.solution);
  EXPECT_FALSE(*storage::IsMergeOutdated(*store_, kOld, *storage::LoadWhatCounts(*store_, kOld)));
  for (int week = 21; week < 24; ++week) Week(week);
  ExpectSamePoses(Whole(ids_[2]), newest_.solution);
  EXPECT_EQ(newest_.edges.size(), 9 * kMeasured.size() + 1);  // it stays on the page, with its reason
}

TEST_F(MergedHistoryTest, EdgesOfASensorThatIsGoneLeaveTheWindowAndComeBackWithIt) {
  for (int week = 0; week < 20; ++week) Week(week);
  ASSERT_TRUE(storage::RetireSensor(*store_, kOld, SensorId("c"), {clock_.now, "Ada", "taken off"}));
  Week(20);
  EXPECT_EQ(newest_.solution.poses.size(), 2u);
  EXPECT_EQ(newest_.edges.size(), 9 + 2 * 8u);  // of each pair of it the newest stay, as past
  Week(21);
  EXPECT_EQ(newest_.edges.size(), 9 + 2 * 8u);
  EXPECT_FALSE(*storage::IsMergeOutdated(*store_, kOld, *storage::LoadWhatCounts(*store_, kOld)));
  ASSERT_TRUE(storage::RestoreSensor(*store_, kOld, SensorId("c"), {clock_.now, "Ada", "back"}));
  Week(22);
  ExpectSamePoses(Whole(), newest_.solution);
  EXPECT_EQ(newest_.edges.size(), 9 * kMeasured.size());
}

std::string Retires(const std::string& thing) {
  return R"({"thing":")" + thing + R"(","who":"Ada","reason":"typed wrong"})";
}

TEST_F(MergedHistoryTest, WhatAMergedEdgeStandsForComesByPages) {
  for (int week = 0; week < 20; ++week) Week(week);
  const std::string in = R"({"robot":"r","in":")" + Merged().front()->id.str() + "\"";
  RevisionCache cache;
  const auto ask = [&](const std::string& more) {
    const auto answer = Answer({*store_, clock_, cache, clock_.now, ""}, "edges", in + more + "}");
    EXPECT_TRUE(answer) << Sentence(answer.error());
    return nlohmann::json::parse(answer.value_or("{}"));
  };
  auto newest_first = ask("")["edges"];
  ASSERT_EQ(newest_first.size(), 12u);
  std::reverse(newest_first.begin(), newest_first.end());
  auto by_pages = nlohmann::json::array();
  std::string next;
  for (int page = 0; page < 3; ++page) {
    const auto answer = ask(R"(,"limit":5)" + (next.empty() ? "" : R"(,"before":")" + next + "\""));
    for (const auto& edge : answer["edges"]) by_pages.push_back(edge);
    next = answer["next"].is_null() ? "" : answer["next"];
    EXPECT_EQ(next.empty(), page == 2);
  }
  EXPECT_EQ(by_pages, newest_first);
  EXPECT_EQ(Answer({*store_, clock_, cache, clock_.now, ""}, "edges",
                   in + R"(,"before":"0000000000000000000000000000000000000000000000000000000000000000"})")
                .error()
                .code,
            ErrorCode::kNotFound);
}

TEST_F(MergedHistoryTest, AMergedEdgeIsRetiredByWhatItStandsFor) {
  for (int week = 0; week < 20; ++week) Week(week);
  const Edge merged = *Merged().front();
  const auto done = CarryOut(*store_, clock_, "retire", Retires(merged.id.str().substr(0, 16)));
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::kConflict);
  EXPECT_EQ(done.error().what, "edge " + merged.id.str().substr(0, 16) +
                                   " was measured by nobody: it stands for what 12 earlier edges of robot r said of " +
                                   merged.frame_a.str() + " - " + merged.frame_b.str());
  RevisionCache cache;
  const auto listed = Answer({*store_, clock_, cache, clock_.now, ""}, "edges",
                             R"({"robot":"r","in":")" + merged.id.str().substr(0, 16) + R"("})");
  ASSERT_TRUE(listed) << Sentence(listed.error());
  const auto within = nlohmann::json::parse(*listed)["edges"];
  ASSERT_EQ(within.size(), 12u);
  const std::string oldest = within.front()["id"], newest = within.back()["id"];
  EXPECT_EQ(done.error().cure, "Retire what is wrong of these: `rigcal edges r --in " + merged.id.str().substr(0, 16) +
                                   "` lists them, from the oldest, `" + RetireCommand(EdgeId(oldest)) +
                                   "` (2027-01-22), to the newest, `" + RetireCommand(EdgeId(newest)) +
                                   "` (2027-04-09).");
  ASSERT_TRUE(CarryOut(*store_, clock_, "retire", Retires(oldest)));
  Revised();
  ExpectSamePoses(Whole(EdgeId(oldest)), newest_.solution);
  EXPECT_EQ(
      Answer({*store_, clock_, cache, clock_.now, ""}, "edges", R"({"robot":"r","in":")" + merged.id.str() + R"("})")
          .error()
          .code,
      ErrorCode::kNotFound);  // of a revision that is not the newest
}

// Which are the newest is told by when they were measured, not by when they came.
TEST_F(MergedHistoryTest, DatedEdgesHaveTheirPlaceInTime) {
  const auto push = [&](const std::vector<int>& weeks) {
    for (const int week : weeks) {
      std::vector<Edge> edges;
      for (const auto& [a, b] : kMeasured) edges.push_back(GivenEdge("r", a, b, (b[0] - a[0]) + 1e-7 * week));
      for (Edge& edge : edges)
        edge.measured_at = Stamp{1'600'000'000'000'000'000 + week * 7LL * 86'400 * 1'000'000'000};
      AssignPushedIds(edges);
      StoreEdges(edges);
    }
    const auto revised = Revise(*store_, kOld, clock_);
    EXPECT_EQ(revised->calibrated_at->ns, 1'600'000'000'000'000'000 + 14 * 7LL * 86'400 * 1'000'000'000);
    return formats::ReadRevisionDocument(revised->document)->edges;
  };
  (void)push({14, 13, 12, 11, 10});
  const std::vector<Edge> edges = push({0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
  EXPECT_EQ(edges.size(), 9 * kMeasured.size());
  for (const Edge& edge : edges)
    if (!IsMerged(edge)) {
      EXPECT_GE(edge.T_a_b.p_m.x() - std::round(edge.T_a_b.p_m.x()), 6.5e-7);
    }
}

TEST_F(MergedHistoryTest, TheLiveStateFollows) {
  LiveGraph live;
  for (int week = 0; week < 14; ++week) {
    Week(week);
    const auto loaded = LoadRobotGraph(*store_, kOld);
    ASSERT_TRUE(loaded);
    TakeNewEdges(*loaded, live);
    EXPECT_EQ(live.solver->graph().edges.size(), loaded->graph.edges.size());
    ExpectSamePoses(newest_.solution, graph::Solve(live.solver->graph()));
  }
}

TEST_F(MergedHistoryTest, OneThatContradictsTheOthersIsToldForGood) {
  for (int week = 0; week < 6; ++week) Week(week);
  Edge wrong = GivenEdge("r", "a", "b", 1.05);
  std::vector<Edge> edges{wrong};
  AssignPushedIds(edges);
  StoreEdges(edges);
  for (int week = 6; week < 24; ++week) Week(week);
  EXPECT_EQ(newest_.verdict.level, VerdictLevel::kFail);
  EXPECT_TRUE(std::any_of(newest_.edges.begin(), newest_.edges.end(),
                          [&](const Edge& edge) { return edge.id == edges.front().id; }));
}

constexpr std::size_t kHeldOfPair = 2 * graph::kEdgesKeptOfPair + graph::kMergedPartsMax;

TEST_F(MergedHistoryTest, AMoveThatNobodyToldIsToldForGoodThoughTheRevisionDoesNotGrow) {
  for (int week = 0; week < 20; ++week) Week(week);
  EXPECT_EQ(newest_.verdict.level, VerdictLevel::kPass);
  for (int week = 20; week < 60; ++week) {
    Week(week, 0.05);
    ASSERT_EQ(newest_.verdict.level, VerdictLevel::kFail) << week;
    ASSERT_LE(newest_.edges.size(), kHeldOfPair * kMeasured.size()) << week;
  }
  EXPECT_EQ(newest_.edges.size(), (8 + 1) + 2 * (8 + 2));  // a - b was not moved
  EXPECT_EQ(Counted(), 60 * static_cast<int>(kMeasured.size()));
  ExpectSamePoses(Whole(), newest_.solution);
}

TEST_F(MergedHistoryTest, EdgesThatScatterByMoreThanTheySayAreToldForGoodThoughTheRevisionDoesNotGrow) {
  std::mt19937 random(3);
  std::normal_distribution<double> off_m(0.0, 3e-3);  // of a sigma of 1 mm
  for (int week = 0; week < 60; ++week) {
    std::vector<Edge> edges;
    for (const auto& [a, b] : kMeasured) {
      edges.push_back(GivenEdge("r", a, b, b[0] - a[0]));
      edges.back().T_a_b = edges.back().T_a_b * Se3::Exp(Vector6d::NullaryExpr([&] { return off_m(random); }));
    }
    Push(std::move(edges));
    ASSERT_LE(newest_.edges.size(), kHeldOfPair * kMeasured.size()) << week;
    ASSERT_TRUE(week < 8 || newest_.verdict.level == VerdictLevel::kFail) << week;
  }
  EXPECT_EQ(Counted(), 60 * static_cast<int>(kMeasured.size()));
}

}  // namespace
}  // namespace rigcal::pipeline
