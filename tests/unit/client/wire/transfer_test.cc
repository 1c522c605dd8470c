#include "client/wire/transfer.h"

#include <gtest/gtest.h>

#include "client/wire/edge_outlet.h"
#include "client/wire/session_outlet.h"
#include "server/formats/sessions/session_folder.h"
#include "tests/unit/client/fake_server.h"

namespace rigcal::client {
namespace {

// A session as `rigcal push` sends it.
struct Sender {
  explicit Sender(const SessionFolder& folder) : marks(MarkFiles(folder.path())) {
    manifest = formats::ReadSessionFolder(folder.path(), {}).value();
    session = SessionOf(manifest);
    for (const Payload& payload : session.payloads) plan.payload_bytes.push_back(payload.size_bytes);
    plan.give_up_ns = 20'000'000'000;
    path = folder.path();
  }
  Status Push() {
    const auto participant = wire::Participant::Open(TestPlace()).value();
    const auto outlet = SessionOutlet::Open(participant, session, FilePieces(path, session.payloads, marks)).value();
    PushEngine engine(plan, SteadyNow_ns());
    const Status done = RunTransfer(participant, {session.robot, session.id.str(), "here"}, engine, *outlet, {});
    restarts = engine.restarts();
    return done;
  }

  std::filesystem::path path;
  FileMarks marks;
  Manifest manifest;
  SessionToPush session;
  PushPlan plan;
  int restarts = 0;
};

std::string Contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void ExpectAllThere(FakeServer& server, const Sender& sender) {
  const FakeSubject subject = server.Subject(sender.session.id.str());
  ASSERT_EQ(subject.payloads.size(), sender.session.payloads.size());
  for (const auto& [idx, bytes] : subject.payloads)
    EXPECT_TRUE(bytes == Contents(sender.path / sender.session.payloads[idx].path)) << idx;
}

TEST(Transfer, EveryByteArrivesAndASecondPushSendsNothing) {
  SessionFolder folder;
  folder.WriteSession("r1", 3, 2'500'000);  // three chunks each, more than a window in all
  FakeServer server("r1");
  Sender sender(folder);
  ASSERT_TRUE(sender.Push());
  ExpectAllThere(server, sender);
  EXPECT_EQ(server.Subject(sender.session.id.str()).samples, 18);
  ASSERT_TRUE(sender.Push());
  EXPECT_EQ(server.Subject(sender.session.id.str()).samples, 18);
}

TEST(Transfer, ARestartOfTheServerInBetweenLosesNothing) {
  SessionFolder folder;
  folder.WriteSession("r1", 2, 2'500'000);
  FakeServer server("r1");
  server.restart_after_next_chunk = true;
  Sender sender(folder);
  ASSERT_TRUE(sender.Push());
  EXPECT_EQ(sender.restarts, 1);
  ExpectAllThere(server, sender);
}

TEST(Transfer, TwoClientsWithTheSameSessionBothEndWell) {
  SessionFolder folder;
  folder.WriteSession("r1", 3, 1'500'000);
  FakeServer server("r1");
  Sender one(folder), other(folder);
  Status other_done;
  std::thread thread([&] { other_done = other.Push(); });
  const Status done = one.Push();
  thread.join();
  EXPECT_TRUE(done);
  EXPECT_TRUE(other_done);
  ExpectAllThere(server, one);
}

TEST(Transfer, AFileThatChangedSinceHashingIsNamed) {
  SessionFolder folder;
  folder.WriteSession("r1", 2, 1000);
  FakeServer server("r1");
  Sender sender(folder);
  folder.Write("right/1.png", std::string("\x89PNG\r\n\x1a\n", 8) + std::string(992, 'x'));
  const Status done = sender.Push();
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::kInvalidInput);
  EXPECT_NE(done.error().what.find("right/1.png changed"), std::string::npos) << done.error().what;
}

TEST(Transfer, NobodyThereIsUnreachable) {
  SessionFolder folder;
  folder.WriteSession("r1", 1, 1000);
  Sender sender(folder);
  sender.plan.give_up_ns = 300'000'000;
  const Status done = sender.Push();
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::kUnreachable);
}

std::vector<Edge> Edges(int count) {
  std::vector<Edge> edges;
  for (int i = 0; i < count; ++i) {
    Edge edge;
    edge.robot = RobotId("r2");
    edge.frame_a = SensorId("a");
    edge.frame_b = SensorId("b" + std::to_string(i));
    edge.T_a_b.p_m = Eigen::Vector3d(0.0, i, 0.0);
    edge.method = "given";
    edge.state = EdgeState::kGood;
    edge.uncertainty = FromInformation(Matrix6d::Identity(), UncertaintySource::kGiven, 0);
    edges.push_back(edge);
  }
  AssignPushedIds(edges);
  return edges;
}

TEST(Transfer, ABatchOfEdgesArrivesWholeAndOnce) {
  FakeServer server("r2");
  const EdgesToPush batch = EdgesOf(RobotId("r2"), Edges(500), 3);
  for (int push = 0; push < 2; ++push) {
    const auto participant = wire::Participant::Open(TestPlace()).value();
    const auto outlet = EdgeOutlet::Open(participant, batch).value();
    PushPlan plan = BatchPlan(batch.edges.size(), 100);
    plan.send_order = batch.send_order;
    PushEngine engine(plan, SteadyNow_ns());
    ASSERT_TRUE(RunTransfer(participant, {batch.robot, batch.id.str(), "here"}, engine, *outlet, {}));
  }
  const FakeSubject subject = server.Subject(batch.id.str());
  ASSERT_EQ(subject.payloads.size(), 500U);
  for (const auto& [idx, id] : subject.payloads) EXPECT_EQ(id, batch.edges[idx].id.str());
  EXPECT_LE(subject.samples, 502);  // each once; a probe per push
}

}  // namespace
}  // namespace rigcal::client
