// Stored sessions computed again, from the order to the candidate that a person approves.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "server/formats/boards/square_sizes.h"
#include "server/pipeline/answers/answer.h"
#include "server/pipeline/orders/orders.h"
#include "server/pipeline/recomputation/drain.h"
#include "server/pipeline/revisions/revise.h"
#include "server/pipeline/robots/validity.h"
#include "server/pipeline/sessions/session_refinement.h"
#include "storage/sessions/session_estimates.h"
#include "storage/work/jobs.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class RecomputationTest : public PipelineTest {
 protected:
  // The cameras in the left one's frame; the right one sits `x_m` further out.
  static std::map<SensorId, Se3> Places(double x_m) {
    std::map<SensorId, Se3> places;
    places[kCameras[0]] = {};
    places[kCameras[1]] = {{-0.5, 0.1, 0.0}, Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ()))};
    places[kCameras[2]] = {{0.3 + x_m, 0.0, 0.1}, Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()))};
    return places;
  }
  // A closed session without anything left to calibrate.
  SessionId Session(int day) {
    Manifest manifest;
    manifest.header.robot = kRig;
    manifest.header.reference = kCameras[0];
    manifest.header.captured_at = {1'700'000'000'000'000'000 + day * kDay_ns};
    Target board;
    board.id = TargetId("board"), board.cols = 9, board.rows = 6, board.square_m = 0.025, board.serial = "B-7";
    manifest.header.targets = {board};
    for (const SensorId& camera : kCameras) {
      Sensor& sensor = manifest.header.sensors.emplace_back();
      sensor.id = camera, sensor.sees = board.id;
      AddFile(camera.str() + "/01.png", camera.str() + " on day " + std::to_string(day), manifest);
    }
    const SessionId session = Close(manifest);
    while (const auto job = storage::LoadNextJob(*store_, {}).value())
      EXPECT_TRUE(storage::FinishJob(*store_, job->number, clock_.now));
    manifests_[session] = manifest;
    return session;
  }
  // Its pairs and its estimate by that estimator, and the revision that follows.
  SessionId Visit(int day, double x_m, const std::string& estimator = kSessionEstimator) {
    const SessionId session = Session(day);
    const auto places = Places(x_m);
    std::vector<Edge> edges;
    for (const auto& [a, b] : std::vector<std::pair<std::size_t, std::size_t>>{{0, 1}, {0, 2}, {1, 2}}) {
      Edge edge = GivenEdge("r", kCameras[a].str(), kCameras[b].str(), 0.0);
      edge.method = "stereo", edge.session = session;
      edge.T_a_b = places.at(kCameras[a]).Inverse() * places.at(kCameras[b]);
      edge.id = EstimatedEdgeId(kRig, session, edge.method, kCameras[a], kCameras[b]);
      edges.push_back(edge);
    }
    StoreEdges(edges);
    SessionEstimate estimate;
    estimate.session = session, estimate.reference = kCameras[0];
    for (const SensorId& camera : kCameras)
      estimate.poses.push_back({camera, places.at(camera), camera == kCameras[0] ? 0.0 : 50.0});
    estimate.covariance = 1e-8 * Eigen::MatrixXd::Identity(12, 12);
    EXPECT_TRUE(storage::AppendSessionEstimate(*store_, estimate, estimator, clock_.now));
    Again();
    return session;
  }
  int Again() {
    const auto revision = Revise(*store_, kRig, clock_);
    EXPECT_TRUE(revision) << Sentence(revision.error());
    return revision ? revision->number : 0;
  }
  int Used() { return LoadUsable(*store_, kRig).value().value_or(UsableRevision{}).number; }
  int Newest() { return storage::LoadRevisionSummary(*store_, kRig, 0).value().value().number; }
  // The disk has not kept what was pushed.
  void LoseFilesOf(const SessionId& session) {
    for (const Payload& payload : manifests_.at(session).payloads)
      EXPECT_TRUE(std::filesystem::remove(storage::BlobPath(store_->BlobFolder(), payload.digest)));
  }
  json Order(const std::string& verb, const json& parameters) {
    const auto done = CarryOut(*store_, clock_, verb, parameters.dump());
    EXPECT_TRUE(done) << Sentence(done.error());
    return done ? json::parse(done->document) : json();
  }
  json Resolve(json scope) {
    scope["who"] = "Ada";
    return Order("resolve", scope);
  }
  json Ask(const std::string& verb, const json& parameters) {
    RevisionCache revisions;
    const auto answer = Answer({*store_, clock_, revisions, clock_.now, ""}, verb, parameters.dump());
    EXPECT_TRUE(answer) << Sentence(answer.error());
    return json::parse(answer.value_or("{}"));
  }
  bool DrainOne() {
    const auto done = RecomputeNext({*store_, clock_, live_, claims_, announcer_, cameras_});
    EXPECT_TRUE(done) << Sentence(done.error());
    return done && done->worked;
  }
  int Drain() {
    int pieces = 0;
    while (pieces < 100 && DrainOne()) ++pieces;
    return pieces;
  }

  std::map<SessionId, Manifest> manifests_;
};

TEST_F(RecomputationTest, WhatIsAsItWasMakesNoRevision) {
  Visit(0, 0.0);
  Visit(30, 5e-5);
  const int used = Used();
  ASSERT_GT(used, 0);
  const json asked = Resolve({{"all", true}});
  EXPECT_EQ(asked["new"], true);
  EXPECT_EQ(asked["sessions"]["total"], 2);
  EXPECT_EQ(asked["done"], false);
  EXPECT_EQ(Drain(), 3) << "two sessions and their robot";
  const json told = Ask("recomputation", json::object());
  EXPECT_EQ(told["done"], true);
  EXPECT_EQ(told["sessions"]["same"], 2);
  EXPECT_EQ(told["robots"][0]["how"], "unchanged");
  EXPECT_EQ(told["robots"][0]["revision"], nullptr);
  EXPECT_EQ(Newest(), used);
  const json again = Resolve({{"all", true}});
  EXPECT_EQ(again["new"], false) << "asked twice it is one run";
  EXPECT_EQ(again["run"], asked["run"]);
  EXPECT_EQ(Drain(), 0);
  EXPECT_THAT(Ask("audit", json::object())["rows"][0]["what"].get<std::string>(),
              HasSubstr("asked for run 1 of `rigcal resolve`: all robots"));
}

TEST_F(RecomputationTest, ACandidateIsHeldUntilAPersonApprovesIt) {
  Visit(0, 0.0);
  const SessionId old = Visit(30, 5e-5, "joint/0");  // as before an update: its estimate counts no more
  LoseFilesOf(old);
  const int used = Used();
  ASSERT_GT(used, 0);
  (void)Resolve({{"robot", "r"}});
  Drain();
  const json told = Ask("recomputation", {{"run", 1}});
  EXPECT_EQ(told["robots_count"]["changed"], 1);
  EXPECT_EQ(told["sessions"]["kept"], 1);
  EXPECT_EQ(told["sessions_left"][0]["session"], old.str());
  EXPECT_THAT(told["sessions_left"][0]["why"].get<std::string>(), HasSubstr("the server's disk has not kept"));
  const json& robot = told["robots"][0];
  const int candidate = robot["revision"];
  EXPECT_EQ(candidate, used + 1);
  EXPECT_EQ(robot["against"], used);
  EXPECT_EQ(robot["state"], "candidate");
  ASSERT_FALSE(robot["changes"].empty());
  EXPECT_EQ(robot["changes"][0]["sensor"], "right");
  EXPECT_GT(robot["changes"][0]["moved_m"].get<double>(), 0.0);
  EXPECT_EQ(Used(), used) << "nothing in use changes";
  const json shown = Ask("show", {{"robot", "r"}});
  EXPECT_EQ(shown["cause"],
            "re-computed with rigcal " + told["software"].get<std::string>() + ", estimator " + kSessionEstimator);
  (void)Order("set_policy", {{"text", "tolerance_mm: 7"}, {"who", "Eve"}, {"reason", "new mounts"}});
  EXPECT_EQ(Again(), candidate + 1);
  EXPECT_EQ(Used(), used) << "nor by a policy that is set meanwhile";
  (void)Order("approve", {{"robot", "r"}, {"revision", candidate}, {"who", "Ada"}, {"reason", "looked at"}});
  EXPECT_EQ(Used(), candidate);
}

TEST_F(RecomputationTest, ThePolicyHasItsSayAboutWhatIsMeasuredLater) {
  Visit(0, 0.0);
  LoseFilesOf(Visit(30, 5e-5, "joint/0"));
  (void)Resolve({{"robot", "r"}});
  Drain();
  const int held = Newest();
  ASSERT_NE(Used(), held);
  Visit(60, 0.0);
  EXPECT_EQ(Used(), held + 1);
}

TEST_F(RecomputationTest, ARunGoesOnWhereTheProcessDied) {
  Visit(0, 0.0);
  Visit(30, 5e-5);
  (void)Resolve({{"all", true}});
  ASSERT_TRUE(DrainOne());
  store_.reset();
  store_ = std::make_unique<storage::Store>(storage::Store::Open(folder_).value());
  EXPECT_EQ(Ask("recomputation", json::object())["sessions"]["done"], 1);
  EXPECT_EQ(Drain(), 2);
  EXPECT_EQ(Ask("recomputation", json::object())["done"], true);
}

TEST_F(RecomputationTest, WhatWasPushedComesFirst) {
  Visit(0, 0.0);
  (void)Resolve({{"all", true}});
  StoreSession("r", {{"left/01.png", "x"}, {"right/01.png", "y"}});
  EXPECT_FALSE(DrainOne()) << "a pair of the robot waits to be calibrated";
  while (const auto job = storage::LoadNextJob(*store_, {}).value())
    ASSERT_TRUE(storage::FinishJob(*store_, job->number, clock_.now));
  EXPECT_TRUE(DrainOne());
}

TEST_F(RecomputationTest, ABoardIsTakenAsItWasMeasuredLast) {
  const SessionId session = Visit(0, 0.0);
  const auto unmeasured = CarryOut(*store_, clock_, "resolve", R"({"board":"B-7","who":"Ada"})");
  ASSERT_FALSE(unmeasured);
  EXPECT_THAT(Sentence(unmeasured.error()), HasSubstr("nobody measured board"));
  (void)Order("measure_board", {{"serial", "B-7"},
                                {"type", "checkerboard"},
                                {"cols", 9},
                                {"rows", 6},
                                {"square_m", "0.025"},
                                {"measured_x_m", "0.198"},
                                {"measured_y_m", "0.198"},
                                {"who", "Ada"}});
  (void)Resolve({{"board", "B-7"}});
  Drain();
  EXPECT_EQ(Ask("recomputation", json::object())["sessions"]["computed"], 1);
  const auto measure = Ask("board", {{"serial", "B-7"}})["board"]["size"];
  const double sigma_m = 0.5 * std::hypot(measure["sigma_x_m"].get<double>(), measure["sigma_y_m"].get<double>());
  const std::string sizes = formats::WriteSquareSizes({{TargetId("board"), {measure["x_m"].get<double>(), sigma_m}}});
  EXPECT_TRUE(storage::HasSessionEstimate(*store_, session, storage::EstimatorNamed(kSessionEstimator, sizes)).value())
      << sizes;
  EXPECT_THAT(Ask("recomputation", json::object())["cause"].get<std::string>(),
              HasSubstr("board B-7 with its measured size"));
}

TEST_F(RecomputationTest, RefusesWhatNamesNothing) {
  const auto refused = [&](const std::string& parameters) {
    const auto done = CarryOut(*store_, clock_, "resolve", parameters);
    return done ? "taken" : Sentence(done.error());
  };
  EXPECT_THAT(refused(R"({"all":true,"who":"Ada"})"), HasSubstr("there is nothing to compute again of all robots"));
  Visit(0, 0.0);
  EXPECT_THAT(refused(R"({"who":"Ada"})"), HasSubstr("nothing says which robots"));
  EXPECT_THAT(refused(R"({"all":true,"robot":"r","who":"Ada"})"), HasSubstr("only one thing"));
  EXPECT_THAT(refused(R"({"all":true})"), HasSubstr("who"));
  EXPECT_THAT(refused(R"({"robot":"s","who":"Ada"})"), HasSubstr("s"));
  EXPECT_NE(refused(R"({"model":"mars","who":"Ada"})"), "taken");
  EXPECT_THAT(refused(R"({"all":true,"who":"policy"})"), HasSubstr("the policy itself decides"));
}

}  // namespace
}  // namespace rigcal::pipeline
