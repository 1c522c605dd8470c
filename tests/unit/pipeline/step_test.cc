#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "server/formats/documents.h"
#include "server/model/edges/past.h"
#include "storage/revisions/revisions.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

TEST_F(PipelineTest, NothingStoredIsNothingToDo) { EXPECT_EQ(StepAll(), 0); }

TEST_F(PipelineTest, PushedEdgesBecomeOneRevisionWhatTheOrder) {
  std::vector<Edge> edges = Triangle("r");
  StoreEdges(edges);
  EXPECT_EQ(StepAll(), 2);  // revise, publish
  ASSERT_EQ(revisions_.size(), 1u);
  EXPECT_EQ(revisions_[0].number, 1);
  EXPECT_EQ(Count("graph_update"), 1);
  EXPECT_EQ(Count("published"), 1);
  // Least squares of a triangle with equal weights: each edge takes a third of the 3 mm closure.
  ASSERT_EQ(poses_.size(), 3u);
  EXPECT_NEAR(poses_[1].T_ref_sensor.p_m.x(), 1.001, 1e-9);
  EXPECT_NEAR(poses_[2].T_ref_sensor.p_m.x(), 2.002, 1e-9);

  std::vector<Edge> reversed = Triangle("r");
  std::reverse(reversed.begin(), reversed.end());
  auto other = storage::Store::Open(folder_ / "other");
  ASSERT_TRUE(other);
  std::swap(*store_, *other);
  LiveGraphs live;
  StoreEdges({reversed[0]});
  StoreEdges({reversed[1]});
  StoreEdges({reversed[2]});
  ASSERT_TRUE(Step({*store_, clock_, live, claims_, announcer_, cameras_}));
  ASSERT_EQ(revisions_.size(), 2u);
  EXPECT_EQ(revisions_[0].document, revisions_[1].document);
}

TEST_F(PipelineTest, ABatchCountsWholeOrNotAtAll) {
  const std::vector<Edge> edges = Triangle("r");
  const BatchId batch = BatchIdOf(RobotId("r"), edges);
  const auto store = [&](std::int64_t idx) {
    ASSERT_TRUE(store_->Write([&]() -> Status {
      RIGCAL_TRY(storage::AppendBatch(*store_, RobotId("r"), batch, 3, clock_.now));
      return storage::AppendBatchItems(*store_, batch, {{idx, edges[static_cast<std::size_t>(idx)]}}, clock_.now);
    }));
  };
  store(2);
  store(0);
  clock_.now.ns += 3'600'000'000'000;
  const auto waiting = StepOnce();
  ASSERT_TRUE(waiting) << Sentence(waiting.error());
  EXPECT_FALSE(waiting->worked);
  EXPECT_FALSE(waiting->wake_at);
  EXPECT_TRUE(events_.empty());

  std::vector<Edge> other = {GivenEdge("r", "a", "d", 3.0)};
  AssignPushedIds(other);
  StoreEdges(other);  // is not held up
  EXPECT_EQ(StepAll(), 2);
  ASSERT_EQ(revisions_.size(), 1u);
  EXPECT_EQ(poses_.size(), 2u);

  store(1);
  EXPECT_EQ(StepAll(), 2);
  ASSERT_EQ(revisions_.size(), 2u);
  EXPECT_EQ(poses_.size(), 4u);
  EXPECT_EQ(Count("graph_update"), 2);
}

TEST_F(PipelineTest, APictureThatCannotBeReadGivesAFailedEdgeWithACure) {
  StoreSession("r", {{"left/01.png", "not a picture"}, {"right/01.png", "nor this"}});
  StepAll();
  EXPECT_EQ(Count("session_closed"), 1);
  const auto edges = storage::LoadEdges(*store_, RobotId("r"), true);
  ASSERT_TRUE(edges);
  ASSERT_EQ(edges->size(), 1u);
  EXPECT_EQ(edges->front().state, EdgeState::kFailed);
  ASSERT_FALSE(edges->front().diagnoses.empty());
  EXPECT_FALSE(edges->front().diagnoses[0].cure.empty());
  ASSERT_EQ(revisions_.size(), 1u);
  EXPECT_NE(revisions_[0].verdict.level, VerdictLevel::kPass);
  EXPECT_TRUE(std::filesystem::exists(store_->ReportFolder() / "r" / "1" / "index.html"));
  const auto right =
      std::find_if(poses_.begin(), poses_.end(), [](const SensorPose& p) { return p.sensor.str() == "right"; });
  ASSERT_NE(right, poses_.end());
  EXPECT_FALSE(right->known);
}

TEST_F(PipelineTest, RealPairsGiveAnEdgeARevisionAndAReport) {
  RIGCAL_SKIP_WITHOUT_STEREO_PAIRS();
  const auto files = RealPictures();
  StoreSession("r", files);
  EXPECT_EQ(StepAll(), 3);  // job, revise, publish
  const auto edges = storage::LoadEdges(*store_, RobotId("r"), true);
  ASSERT_TRUE(edges);
  ASSERT_EQ(edges->size(), 1u);
  const Edge& edge = edges->front();
  ASSERT_EQ(edge.state, EdgeState::kGood) << edge.diagnoses[0].what;
  EXPECT_NEAR(edge.T_a_b.p_m.norm(), 0.08318, 0.0003);
  EXPECT_GT(edge.T_a_b.p_m.x(), 0.08);  // the right camera is at +x of the left one
  EXPECT_EQ(edge.uncertainty.blocks.size(), 13u);
  const auto fits = std::count_if(edge.evidence.begin(), edge.evidence.end(),
                                  [](const Evidence& one) { return one.suffix == "fit"; });
  EXPECT_EQ(fits, 2);  // one per camera; the others are pictures
  EXPECT_EQ(edge.evidence.size(), 28u);
  EXPECT_EQ(edge.evidence[0].suffix, "jpg");
  EXPECT_TRUE(std::filesystem::exists(store_->ReportFolder() / "r" / "1" / "evidence" /
                                      (edge.evidence[0].digest.str() + ".jpg")));
}

TEST_F(PipelineTest, OneFileForBothCamerasIsNoMeasurement) {
  RIGCAL_SKIP_WITHOUT_STEREO_PAIRS();
  auto files = RealPictures();
  files["right/01.jpg"] = files["left/01.jpg"];
  StoreSession("r", files);
  StepAll();
  const auto edges = storage::LoadEdges(*store_, RobotId("r"), true);
  ASSERT_TRUE(edges && edges->size() == 1);
  ASSERT_EQ(edges->front().diagnoses.front().code, "same_picture");
  EXPECT_NE(edges->front().diagnoses.front().what.find("which are not used: 01."), std::string::npos);
  EXPECT_EQ(edges->front().captures.front().capture.str(), "01");
  EXPECT_FALSE(edges->front().captures.front().used);
  EXPECT_EQ(edges->front().captures.size(), files.size() / 2);
}

// Edges that do not count any more, as pages tell them from failed ones.
std::ptrdiff_t PastCount(const std::string& document) {
  const auto revision = formats::ReadRevisionDocument(document);
  return revision ? std::count_if(revision->edges.begin(), revision->edges.end(), IsPast) : -1;
}

TEST_F(PipelineTest, ACorrectedSessionSupersedesTheOneItRepeats) {
  const std::map<std::string, std::string> files = {{"left/01.png", "one"}, {"right/01.png", "two"}};
  StoreSession("r", files);
  StepAll();
  Edge good = GivenEdge("r", "left", "right", 0.1);  // as if the first session had given a good edge
  const auto first = storage::LoadSessions(*store_, RobotId("r"));
  ASSERT_TRUE(first);
  good.session = first->front().id;
  good.method = "stereo2";
  good.id = EstimatedEdgeId(good.robot, good.session, good.method, good.frame_a, good.frame_b);
  StoreEdges({good});
  StepAll();
  EXPECT_NE(revisions_.back().document.find("\"state\":\"good\""), std::string::npos);

  clock_.now.ns += 1'000'000'000;  // another captured_at: another session of the same pictures
  StoreSession("r", files);
  StepAll();
  EXPECT_EQ(revisions_.back().document.find("\"state\":\"good\""), std::string::npos);
  EXPECT_NE(revisions_.back().document.find("superseded"), std::string::npos);
  EXPECT_EQ(PastCount(revisions_.back().document), 2);  // also what failed in it: only the correction may be blamed
}

// Good edges of the newest revision, by session.
std::set<std::string> GoodSessions(const std::string& document) {
  std::set<std::string> sessions;
  const auto parsed = nlohmann::json::parse(document);
  for (const auto& edge : parsed["edges"])
    if (edge["state"] == "good") sessions.insert(edge["session"].get<std::string>());
  return sessions;
}

Edge EdgeOfSession(const SessionId& session, double x_m) {
  Edge edge = GivenEdge("r", "left", "right", x_m);
  edge.session = session;
  edge.method = "given_" + session.str().substr(0, 4);
  edge.id = EstimatedEdgeId(edge.robot, edge.session, edge.method, edge.frame_a, edge.frame_b);
  return edge;
}

TEST_F(PipelineTest, WhatWasMeasuredBeforeASensorWasRemountedIsPast) {
  const auto measure = [this](const SessionId& session, double x_m) {
    StoreEdges({EdgeOfSession(session, x_m)});
    StepAll();
  };
  const std::int64_t hour_ns = 3'600'000'000'000;
  const Stamp start = clock_.now;
  const SessionId first = StoreSession("r", {{"left/01.png", "1"}, {"right/01.png", "2"}});
  StepAll();
  measure(first, 0.1);
  EXPECT_EQ(GoodSessions(revisions_.back().document), std::set<std::string>{first.str()});

  clock_.now.ns = start.ns + hour_ns;
  const SessionId second = StoreSession("r", {{"left/01.png", "3"}, {"right/01.png", "4"}}, {SensorId("right")});
  StepAll();
  EXPECT_EQ(GoodSessions(revisions_.back().document), std::set<std::string>());
  EXPECT_NE(revisions_.back().document.find("sensor right was remounted after this was measured"), std::string::npos);
  EXPECT_EQ(PastCount(revisions_.back().document), 1);
  measure(second, 0.2);
  EXPECT_EQ(GoodSessions(revisions_.back().document), std::set<std::string>{second.str()});

  // It comes last and was captured first: what it says was remounted, was so before all others.
  clock_.now.ns = start.ns - hour_ns;
  StoreSession("r", {{"left/01.png", "5"}, {"right/01.png", "6"}}, {SensorId("right")});
  StepAll();
  EXPECT_EQ(GoodSessions(revisions_.back().document), std::set<std::string>{second.str()});

  // Pushed again without it: the remount was a mistake.
  clock_.now.ns = start.ns + hour_ns + 1'000'000'000;
  StoreSession("r", {{"left/01.png", "3"}, {"right/01.png", "4"}});
  StepAll();
  EXPECT_EQ(GoodSessions(revisions_.back().document), std::set<std::string>{first.str()});
}

// captured_at may be a day: then who names the sensor was later, and where all do nobody knows.
TEST_F(PipelineTest, OfSessionsOfOneTimeThatWhichNamesTheSensorIsTheLater) {
  const SessionId second = StoreSession("r", {{"left/01.png", "3"}, {"right/01.png", "4"}}, {SensorId("right")});
  const SessionId first = StoreSession("r", {{"left/01.png", "1"}, {"right/01.png", "2"}});
  StoreEdges({EdgeOfSession(first, 0.1), EdgeOfSession(second, 0.2)});
  StepAll();
  EXPECT_EQ(GoodSessions(revisions_.back().document), std::set<std::string>{second.str()});
  const SessionId third =
      StoreSession("r", {{"left/01.png", "5"}, {"right/01.png", "6"}}, {SensorId("right"), SensorId("left")});
  StoreEdges({EdgeOfSession(third, 0.2)});
  StepAll();
  // "left" was moved before the third, and so after the second.
  EXPECT_EQ(GoodSessions(revisions_.back().document), std::set<std::string>{third.str()});
  StoreSession("r", {{"left/01.png", "7"}, {"right/01.png", "8"}}, {SensorId("right"), SensorId("left")});
  StepAll();
  EXPECT_EQ(GoodSessions(revisions_.back().document), std::set<std::string>{third.str()});
}

TEST_F(PipelineTest, WhatIsPastDoesNotDependOnTheOrderOfArrival) {
  const Stamp start = clock_.now;
  std::vector<std::string> documents;
  for (const std::vector<int>& order : {std::vector<int>{0, 1, 2}, {2, 1, 0}, {1, 2, 0}}) {
    for (const int k : order) {
      const std::string name = std::to_string(k);
      clock_.now.ns = start.ns + k * 1'000'000'000LL;
      const SessionId session = StoreSession("r", {{"left/01.png", name}, {"right/01.png", name + "r"}},
                                             k == 0 ? std::vector<SensorId>{} : std::vector{SensorId("right")});
      StoreEdges({EdgeOfSession(session, 0.1 * (k + 1))});
      StepAll();
    }
    documents.push_back(revisions_.back().document);
    TearDown();
    SetUp();
  }
  EXPECT_EQ(GoodSessions(documents[0]).size(), 1u);
  EXPECT_EQ(documents[1], documents[0]);
  EXPECT_EQ(documents[2], documents[0]);
}

TEST_F(PipelineTest, ASensorInNoPairIsUnknownNotAbsent) {
  Manifest manifest;
  manifest.header.robot = RobotId("r");
  manifest.header.reference = SensorId("left");
  manifest.header.captured_at = clock_.now;
  for (const char* name : {"near", "far"}) {
    Target board;
    board.id = TargetId(name);
    board.cols = 9, board.rows = 6, board.square_m = 0.025;
    manifest.header.targets.push_back(board);
  }
  for (const auto& [name, target] : {std::pair("left", "near"), {"right", "near"}, {"side", "far"}}) {
    Sensor sensor;
    sensor.id = SensorId(name);
    sensor.sees = TargetId(target);
    manifest.header.sensors.push_back(sensor);
    Payload payload;
    payload.sensor = sensor.id;
    payload.capture = CaptureId("01");
    payload.path = std::string(name) + "/01.png";
    payload.digest = *storage::AppendBlob(store_->BlobFolder(), payload.path);
    payload.size_bytes = static_cast<std::int64_t>(payload.path.size());
    manifest.payloads.push_back(payload);
  }
  Close(manifest);
  StepAll();
  ASSERT_EQ(poses_.size(), 3u);
  const auto side =
      std::find_if(poses_.begin(), poses_.end(), [](const SensorPose& p) { return p.sensor.str() == "side"; });
  ASSERT_NE(side, poses_.end());
  EXPECT_FALSE(side->known);
}

TEST_F(PipelineTest, ALostBlobCostsThePairNotTheRobot) {
  StoreSession("r", {{"left/01.png", "one"}, {"right/01.png", "two"}});
  std::filesystem::remove(storage::BlobPath(store_->BlobFolder(), Sha256Of(std::string("one"))));
  StepAll();
  EXPECT_EQ(Count("session_closed"), 1);
  const auto edges = storage::LoadEdges(*store_, RobotId("r"), true);
  ASSERT_TRUE(edges);
  ASSERT_EQ(edges->size(), 1u);
  EXPECT_EQ(edges->front().state, EdgeState::kFailed);
  EXPECT_EQ(edges->front().diagnoses.front().code, "file_lost");
  EXPECT_EQ(revisions_.size(), 1u);
}

TEST_F(PipelineTest, WorkLeftByACrashIsFoundAgain) {
  StoreEdges(Triangle("r"));
  const auto first = StepOnce();  // revised, not yet published
  ASSERT_TRUE(first && first->worked);
  LiveGraphs fresh_live;  // a new process has neither live graphs nor claims
  RobotLocks fresh_claims;
  const auto second = Step({*store_, clock_, fresh_live, fresh_claims, announcer_, cameras_});
  ASSERT_TRUE(second && second->worked);
  EXPECT_EQ(Count("published"), 1);
  EXPECT_EQ(revisions_.size(), 1u);
}

}  // namespace
}  // namespace rigcal::pipeline
