// A robot whose sessions came week after week: its revisions hold the newest, and what the older ones say together.
#include "server/graph/solve/solve.h"
#include "server/model/edges/past.h"
#include "server/pipeline/reports/report_input.h"
#include "server/pipeline/revisions/revise.h"
#include "server/pipeline/sessions/current_edges.h"
#include "storage/revisions/merged_edges.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/standing.h"
#include "storage/settings/policies.h"
#include "storage/work/jobs.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

const RobotId kWeekly("r");
struct Seen {
  const char *a, *b;
  double x_m;
};
const std::vector<Seen> kSeen = {{"left", "right", 1.0}, {"right", "top", 1.0}, {"left", "top", 2.0}};

class MergedSessionsTest : public PipelineTest {
 protected:
  // A session with an edge of each pair, 0.1 mm off in turn, and one that failed; and a revision. `of` week's pictures.
  void Week(int week, int of, const std::vector<SensorId>& remounted = {}) {
    clock_.now.ns += 7LL * 86'400 * 1'000'000'000;
    const std::string bytes = "pictures of week " + std::to_string(of);
    const SessionId session =
        StoreSession("r", {{"left/1.jpg", bytes + " left"}, {"right/1.jpg", bytes + " right"}}, remounted);
    sessions_.push_back(session);
    std::vector<Edge> edges;
    for (const auto& [a, b, x_m] : std::vector<Seen>(kSeen.begin(), kSeen.begin() + pairs_))
      edges.push_back(GivenEdge("r", a, b, x_m + 1e-4 * ((week % 3) - 1) + 1e-7 * week));
    edges.emplace_back();
    edges.back().robot = kWeekly, edges.back().frame_a = SensorId("left"), edges.back().frame_b = SensorId("back");
    edges.back().diagnoses = {{"no_view", "seen by neither", "Show it."}};
    for (Edge& edge : edges) {
      edge.method = "stereo";
      edge.session = session;
      edge.id = EstimatedEdgeId(kWeekly, session, edge.method, edge.frame_a, edge.frame_b);
    }
    StoreEdges(edges);
    FinishJobs();
    ids_.push_back(edges.front().id);
    Revised();
  }
  void FinishJobs() {
    for (auto job = storage::LoadNextJob(*store_, {}); job && *job; job = storage::LoadNextJob(*store_, {}))
      ASSERT_TRUE(store_->Write([&] { return storage::FinishJob(*store_, (*job)->number, clock_.now); }));
  }
  void Revised() {
    auto revised = Revise(*store_, kWeekly, clock_);
    ASSERT_TRUE(revised) << Sentence(revised.error());
    newest_ = *formats::ReadRevisionDocument(revised->document);
  }
  void Weeks(int from, int to) {
    for (int week = from; week < to; ++week) Week(week, week);
  }
  template <typename Excluded>
  GraphSolution WholeBut(const Excluded& excluded) {
    auto edges = storage::LoadEdges(*store_, kWeekly, true).value();
    std::erase_if(edges, excluded);
    return graph::Solve(graph::GraphOf(edges, SensorId("left")));
  }
  [[nodiscard]] bool IsOutdated() {
    return *storage::IsMergeOutdated(*store_, kWeekly, *storage::LoadWhatCounts(*store_, kWeekly));
  }
  [[nodiscard]] std::size_t Good() const {
    return static_cast<std::size_t>(std::count_if(newest_.edges.begin(), newest_.edges.end(),
                                                  [](const Edge& edge) { return edge.state == EdgeState::kGood; }));
  }
  // As the newest revision has them, and as the live state would begin.
  void ExpectPoses(const GraphSolution& wanted) {
    ExpectSame(wanted, newest_.solution);
    const auto loaded = LoadRobotGraph(*store_, kWeekly);
    ASSERT_TRUE(loaded);
    ExpectSame(wanted, graph::Solve(loaded->graph));
  }
  static void ExpectSame(const GraphSolution& x, const GraphSolution& y) {
    for (const SensorPose& pose : x.poses) {
      const auto other = std::find_if(y.poses.begin(), y.poses.end(),
                                      [&](const SensorPose& one) { return one.sensor == pose.sensor; });
      ASSERT_NE(other, y.poses.end());
      EXPECT_LT((pose.T_ref_sensor.p_m - other->T_ref_sensor.p_m).norm(), 1e-9) << pose.sensor.str();
      EXPECT_LT((pose.covariance - other->covariance).norm(), 1e-6 * (1e-30 + pose.covariance.norm()));
    }
  }

  // Whether the edge's session came before that of the week.
  [[nodiscard]] bool Before(const Edge& edge, std::size_t week) const {
    return std::find(sessions_.begin(), sessions_.begin() + static_cast<std::ptrdiff_t>(week), edge.session) !=
           sessions_.begin() + static_cast<std::ptrdiff_t>(week);
  }

  std::ptrdiff_t pairs_ = 3;
  std::vector<SessionId> sessions_;
  std::vector<EdgeId> ids_;  // of the first pair, by week
  formats::RevisionInput newest_;
};

TEST_F(MergedSessionsTest, ARevisionHoldsAsManyEdgesHoweverManySessionsCameBefore) {
  Weeks(0, 30);
  EXPECT_EQ(newest_.edges.size(), 8 * 4 + kSeen.size());  // what failed in older ones is on their own pages
  EXPECT_EQ(Good(), 9 * kSeen.size());
  for (const Edge& edge : newest_.edges)
    if (IsMerged(edge)) {
      EXPECT_EQ(edge.figures.at(kMergedSessions), 22);
    }
  ExpectPoses(WholeBut([](const Edge&) { return false; }));
  EXPECT_FALSE(IsOutdated());
}

TEST_F(MergedSessionsTest, APolicySaysHowManySessionsStayAsTheyAreAndReachesBack) {
  Weeks(0, 20);
  for (const std::size_t visits : {12U, 5U}) {
    ASSERT_TRUE(store_->Write([&]() -> Status {
      RIGCAL_TRY(storage::AppendPolicy(*store_, {PolicyScope::kRobot, "r"},
                                       "visits_in_full: " + std::to_string(visits) + "\n",
                                       {clock_.now, "Ada", "more of them"}));
      return {};
    }));
    Revised();
    EXPECT_EQ(Good(), (visits + 1) * kSeen.size());
    ExpectPoses(WholeBut([](const Edge&) { return false; }));
    EXPECT_FALSE(IsOutdated());
  }
}

TEST_F(MergedSessionsTest, ARetiredEdgeOfLongAgoTakesNoPartAnyMore) {
  Weeks(0, 20);
  ASSERT_TRUE(storage::RetireEdge(*store_, ids_[2], {{4}, "Ada", "typed wrong"}));
  EXPECT_TRUE(IsOutdated());
  const auto but_one = [&](const Edge& edge) { return edge.id == ids_[2]; };
  Revised();
  ExpectPoses(WholeBut(but_one));
  EXPECT_FALSE(IsOutdated());
  Weeks(20, 23);
  ExpectPoses(WholeBut(but_one));
  EXPECT_EQ(Good(), 9 * kSeen.size());
}

TEST_F(MergedSessionsTest, ARemountReachesBackToMergedSessions) {
  Weeks(0, 20);
  Week(20, 20, {SensorId("right")});
  const auto before = [&](const Edge& edge) {
    return edge.session != sessions_[20] && (edge.frame_a == SensorId("right") || edge.frame_b == SensorId("right"));
  };
  ExpectPoses(WholeBut(before));
  for (const Edge& edge : newest_.edges)
    if (IsMerged(edge)) {
      EXPECT_EQ(edge.frame_b, SensorId("top"));
    }
  EXPECT_FALSE(IsOutdated());
  Week(21, 21);
  ExpectPoses(WholeBut([&](const Edge& edge) { return before(edge) && edge.session != sessions_[21]; }));
}

TEST_F(MergedSessionsTest, ASessionOfLongAgoThatIsPushedAgainAndRestoredCountsOnce) {
  Weeks(0, 20);
  clock_.now.ns -= 18LL * 7 * 86'400 * 1'000'000'000 + 1;  // captured then
  Week(20, 2);
  clock_.now.ns += 18LL * 7 * 86'400 * 1'000'000'000;
  ExpectPoses(WholeBut([&](const Edge& edge) { return edge.session == sessions_[2]; }));
  EXPECT_FALSE(IsOutdated());
  ASSERT_TRUE(
      *storage::MakeCurrent(*store_, sessions_[2], storage::MadeCurrent::kRestored, {clock_.now, "Ada", "was right"}));
  EXPECT_TRUE(IsOutdated());
  Revised();
  ExpectPoses(WholeBut([&](const Edge& edge) { return edge.session == sessions_[20]; }));
}

TEST_F(MergedSessionsTest, ASensorThatIsGoneTakesWhatWasMergedOfItAlongAndBringsItBack) {
  Weeks(0, 20);
  const SensorId top("top");
  const auto of_top = [&](const Edge& edge) { return edge.frame_a == top || edge.frame_b == top; };
  ASSERT_TRUE(storage::RetireSensor(*store_, kWeekly, top, {clock_.now, "Ada", "taken off"}));
  EXPECT_TRUE(IsOutdated());
  Revised();
  ExpectPoses(WholeBut(of_top));
  EXPECT_FALSE(IsOutdated());
  for (const SensorPose& pose : newest_.solution.poses) EXPECT_NE(pose.sensor, top);
  Weeks(20, 23);  // bring it again
  ExpectPoses(WholeBut(of_top));
  EXPECT_FALSE(IsOutdated());
  EXPECT_EQ(Good(), 9u);
  EXPECT_EQ(newest_.edges.size(), 8 * 4 + 1u);
  ASSERT_TRUE(storage::RestoreSensor(*store_, kWeekly, top, {clock_.now, "Ada", "back"}));
  EXPECT_TRUE(IsOutdated());
  Revised();
  ExpectPoses(WholeBut([](const Edge&) { return false; }));
  EXPECT_FALSE(IsOutdated());
  EXPECT_EQ(Good(), 9 * kSeen.size());
}

TEST_F(MergedSessionsTest, ARetiredSessionOfLongAgoTakesNoPartUntilItIsRestored) {
  Weeks(0, 20);
  ASSERT_TRUE(storage::RetireSession(*store_, sessions_[2], {clock_.now, "Ada", "blurred"}));
  EXPECT_TRUE(IsOutdated());
  Revised();
  ExpectPoses(WholeBut([&](const Edge& edge) { return edge.session == sessions_[2]; }));
  EXPECT_FALSE(IsOutdated());
  ASSERT_TRUE(
      *storage::MakeCurrent(*store_, sessions_[2], storage::MadeCurrent::kRestored, {clock_.now, "Ada", "was right"}));
  EXPECT_TRUE(IsOutdated());
  Revised();
  ExpectPoses(WholeBut([](const Edge&) { return false; }));
}

// A session of long ago that is only half calibrated.
TEST_F(MergedSessionsTest, OneOfWhichPairsAreStillToComeStaysAsItIs) {
  Weeks(0, 10);
  const Stamp now = clock_.now;
  clock_.now.ns -= 9LL * 7 * 86'400 * 1'000'000'000 + 1;
  const SessionId session = StoreSession("r", {{"left/1.jpg", "late"}, {"right/1.jpg", "late too"}});
  Edge edge = GivenEdge("r", "left", "right", 1.0);
  edge.session = session, edge.method = "stereo";
  edge.id = EstimatedEdgeId(kWeekly, session, edge.method, edge.frame_a, edge.frame_b);
  StoreEdges({edge});
  clock_.now = now;
  const auto holds = [&] {
    return std::any_of(newest_.edges.begin(), newest_.edges.end(), [&](const Edge& one) { return one.id == edge.id; });
  };
  newest_ = *formats::ReadRevisionDocument(Revise(*store_, kWeekly, clock_, 1)->document);
  EXPECT_TRUE(holds());
  FinishJobs();
  Revised();
  EXPECT_FALSE(holds());
  ExpectPoses(WholeBut([](const Edge&) { return false; }));
}

// All that left the window was past, and nothing was merged: the word by which it is past may be taken back all the
// same.
TEST_F(MergedSessionsTest, ARemountThatIsTakenBackBringsBackWhatLeftAsPast) {
  pairs_ = 1;
  Weeks(0, 10);
  Week(10, 10, {SensorId("right")});
  Weeks(11, 19);
  ExpectPoses(WholeBut([&](const Edge& edge) { return Before(edge, 10); }));
  clock_.now.ns -= 9LL * 7 * 86'400 * 1'000'000'000 + 1;
  Week(19, 10);
  clock_.now.ns += 9LL * 7 * 86'400 * 1'000'000'000 + 1;
  Revised();
  ExpectPoses(WholeBut([&](const Edge& edge) { return edge.session == sessions_[10]; }));
}

TEST_F(MergedSessionsTest, TheListOfEdgesSaysThatAMergedOneWasRetired) {
  Weeks(0, 20);
  ASSERT_TRUE(storage::RetireEdge(*store_, ids_[2], {{4}, "Ada", "typed wrong"}));
  Revised();
  EXPECT_TRUE(
      std::none_of(newest_.edges.begin(), newest_.edges.end(), [&](const Edge& edge) { return edge.id == ids_[2]; }));
  auto edges = storage::LoadEdges(*store_, kWeekly, false).value();
  ASSERT_TRUE(MarkPast(*store_, *storage::LoadWhatCounts(*store_, kWeekly), edges));
  for (const Edge& edge : edges) EXPECT_EQ(IsPast(edge), edge.id == ids_[2]);
}

// The edge of left and right of each week, and in which report its captures and pictures are; 0: in that of the
// revision itself.
TEST_F(MergedSessionsTest, AReportHasTheDetailsOfItsOwnVisit) {
  Weeks(0, 4);
  const auto detailed_in = [&](int number, std::size_t week) {
    const auto input = LoadReportInput(*store_, **storage::LoadRevision(*store_, kWeekly, number));
    const auto found = input->detailed_in.find(ids_[week]);
    return found == input->detailed_in.end() ? 0 : found->second;
  };
  EXPECT_EQ(detailed_in(4, 0), 1);
  EXPECT_EQ(detailed_in(4, 2), 3);
  EXPECT_EQ(detailed_in(4, 3), 0);
  EXPECT_EQ(detailed_in(3, 2), 0) << "drawn again, an older report shows what it showed";
  const auto input = LoadReportInput(*store_, **storage::LoadRevision(*store_, kWeekly, 4));
  for (const Edge& edge : input->revision.edges)
    EXPECT_TRUE(edge.state == EdgeState::kGood || !input->detailed_in.contains(edge.id))
        << "a failed one is shown again";
  ASSERT_TRUE(storage::RetireEdge(*store_, ids_[1], {clock_.now, "Anna", "typed wrong"}));
  Revised();
  EXPECT_EQ(detailed_in(5, 3), 0) << "the newest visit's stay where nothing else is new";
  EXPECT_EQ(detailed_in(5, 1), 2);
}

}  // namespace
}  // namespace rigcal::pipeline
