// Speaks the wire contract wrongly on purpose, against the rigcald of the environment: one attack per run. Prints what
// came back in two lines, "<state>: <what>" and the cure. Exit code 0 if anything came back.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <iterator>
#include <limits>
#include <map>

#include "client/wire/connection.h"
#include "tests/unit/dds/fixture.h"
#include "tests/unit/idl/sample_edge.h"

namespace rigcal::dds {
namespace {

using wire::Receipt;
using wire::ReceiptState;

constexpr std::size_t kSmall_bytes = 2000;

void Say(const std::string& state, const std::string& what, const std::string& cure = "") {
  std::printf("%s: %s\n%s\n", state.c_str(), what.c_str(), cure.c_str());
}

void Say(const Receipt& receipt) {
  const std::map<ReceiptState, std::string> names = {{ReceiptState::kNeedManifest, "need_manifest"},
                                                     {ReceiptState::kReceiving, "receiving"},
                                                     {ReceiptState::kClosed, "closed"},
                                                     {ReceiptState::kRefused, "refused"}};
  const Error error = receipt.error.value_or(Error{ErrorCode::kInternal, "", ""});
  Say(names.at(receipt.state), error.what, error.cure);
}

// Another seed, another session; the process's id keeps repeated runs apart.
Session Fresh(const std::string& robot, const std::vector<std::size_t>& sizes, unsigned seed) {
  return MakeSession(robot, sizes, seed + 1000U * static_cast<unsigned>(::getpid()));
}

// A refusal is sent once and kept for nobody, so the server's writer must know our reader before the attack: a question
// whose answer is kept shows that it does.
Client ClientOf(const std::string& robot) {
  Client client(wire::ParticipantOptions{}, RobotId(robot));
  const Session greeting = Fresh(robot, {kSmall_bytes}, 100);
  client.SendHeader(greeting);
  client.AwaitState(greeting.id.str(), ReceiptState::kNeedManifest);
  return client;
}

// The session, opened, with its manifest stored.
void Open(Client& client, const Session& session) {
  client.SendHeader(session);
  client.AwaitState(session.id.str(), ReceiptState::kNeedManifest);
  client.SendManifest(session);
  client.AwaitState(session.id.str(), ReceiptState::kReceiving);
}

void SayRefusal(Client& client, const std::string& subject) { Say(client.AwaitState(subject, ReceiptState::kRefused)); }

Receipt AwaitComplaint(Client& client, const Session& session) {
  return client.Await(session.id.str(), [](const Receipt& receipt) {
    return receipt.state == ReceiptState::kReceiving && receipt.error.has_value();
  });
}

void ForeignRobot() {
  Client client = ClientOf("wire-a");
  const Session session = Fresh("wire-b", {kSmall_bytes}, 1);
  client.SendHeader(session);
  SayRefusal(client, session.id.str());
}

void StrangerSession() {
  Client victim = ClientOf("wire-victim"), client = ClientOf("wire-a");
  Session session = Fresh("wire-victim", {kSmall_bytes}, 2);
  victim.Push(session);
  session.robot = RobotId("wire-a");
  client.SendHeader(session);
  SayRefusal(client, session.id.str());
}

void StrangerChunk() {
  Client victim = ClientOf("wire-victim"), client = ClientOf("wire-a");
  const Session session = Fresh("wire-victim", {kSmall_bytes}, 3);
  Open(victim, session);
  Session claimed = session;
  claimed.robot = RobotId("wire-a");
  client.SendChunk(claimed, 0, 0, std::string(kSmall_bytes, 'x'));
  const Receipt refused = client.AwaitState(session.id.str(), ReceiptState::kRefused);
  victim.SendPayload(session, 0);
  victim.AwaitState(session.id.str(), ReceiptState::kClosed);  // the stranger's bytes did no harm
  Say(refused);
}

void UnknownSessionChunk() {
  Client client = ClientOf("wire-a");
  const Session session = Fresh("wire-a", {kSmall_bytes}, 4);
  client.SendPayload(session, 0);
  Say(client.AwaitState(session.id.str(), ReceiptState::kNeedManifest));
}

void ChunkOutside() {
  Client client = ClientOf("wire-a");
  const Session session = Fresh("wire-a", {kSmall_bytes}, 5);
  Open(client, session);
  client.SendChunk(session, 0, std::numeric_limits<std::uint64_t>::max() - 10, "outside of all");
  client.SendChunk(session, 77, 0, "of no payload");
  Say(AwaitComplaint(client, session));
}

void HugeChunk() {
  Client client = ClientOf("wire-a");
  const Session session = Fresh("wire-a", {kSmall_bytes}, 6);
  Open(client, session);
  client.SendChunk(session, 0, 0, std::string((1U << 20) + 1, 'x'));
  SayRefusal(client, session.id.str());
}

// Backwards, every chunk twice, each overlapping its neighbour.
void Disorder() {
  constexpr std::size_t kAll = 300'000, kPiece = 40'000, kOverlap = 1'000;
  Client client = ClientOf("wire-a");
  const Session session = Fresh("wire-a", {kAll}, 7);
  Open(client, session);
  const std::string_view bytes = session.payloads[0];
  for (std::size_t end = kAll; end > 0; end = end > kPiece ? end - kPiece : 0) {
    const std::size_t begin = end > kPiece + kOverlap ? end - kPiece - kOverlap : 0;
    for (int times = 0; times < 2; ++times) client.SendChunk(session, 0, begin, bytes.substr(begin, end - begin));
  }
  client.AwaitState(session.id.str(), ReceiptState::kClosed);  // closed only where the digest is the manifest's
  Say("closed", "same digest");
}

void WrongHash() {
  Client client = ClientOf("wire-a");
  const Session session = Fresh("wire-a", {kSmall_bytes, kSmall_bytes}, 8);
  Open(client, session);
  client.SendPayload(session, 1);
  client.SendChunk(session, 0, 0, std::string(kSmall_bytes, 'x'));
  Say(AwaitComplaint(client, session));
}

// Everything at once, whatever the window says; then what was answered busy, until all is there.
void BeyondWindow() {
  Client client = ClientOf("wire-flood");
  const Session session = Fresh("wire-flood", std::vector<std::size_t>(40, 1U << 20), 9);
  Open(client, session);
  const auto send = [&](std::uint32_t idx) {
    while (!client.TrySendChunk(session, idx, 0, session.payloads[idx])) continue;
  };
  for (std::uint32_t idx = 0; idx < session.payloads.size(); ++idx) send(idx);
  std::size_t busy = 0;
  client.Await(session.id.str(), [&](const Receipt& receipt) {
    busy += receipt.busy.size();
    for (const Receipt::ChunkAt& chunk : receipt.busy) send(chunk.payload_idx);
    return receipt.state == ReceiptState::kClosed;
  });
  Say("busy", std::to_string(busy) + " chunks; closed");
}

// A session whose manifest was changed; `same_id` keeps the id of the good one.
void BadManifest(const std::function<void(std::string&)>& spoil, bool same_id = false) {
  Client client = ClientOf("wire-a");
  Session session = Fresh("wire-a", {kSmall_bytes}, 10);
  spoil(session.manifest);
  if (!same_id) session.id = SessionId(Sha256Of(std::string_view(session.manifest)).str());
  client.SendHeader(session);
  client.AwaitState(session.id.str(), ReceiptState::kNeedManifest);
  client.SendManifest(session);
  SayRefusal(client, session.id.str());
}

// The manifest on standard input, in the name of the robot that it names, and not one picture.
void ForeignManifest() {
  Session session;
  session.manifest = std::string(std::istreambuf_iterator<char>(std::cin), {});
  session.robot = Must(formats::ReadManifest(session.manifest)).header.robot;
  session.id = SessionId(Sha256Of(std::string_view(session.manifest)).str());
  Client client = ClientOf(session.robot.str());
  client.SendHeader(session);
  client.AwaitState(session.id.str(), ReceiptState::kNeedManifest);
  client.SendManifest(session);
  const Receipt answer = client.Await(
      session.id.str(), [](const Receipt& receipt) { return receipt.state != ReceiptState::kNeedManifest; });
  const auto held = std::count(answer.held.begin(), answer.held.end(), true);
  Say(answer.state == ReceiptState::kClosed ? "closed" : "open", std::to_string(held) + " payloads held",
      session.id.str());
}

void Replace(std::string& text, const std::string& old, const std::string& put) {
  const std::size_t at = text.find(old);
  if (at == std::string::npos) throw std::runtime_error("the manifest has no " + old);
  text.replace(at, old.size(), put);
}

void FutureProtocol() {
  Client client = ClientOf("wire-a");
  const Session session = Fresh("wire-a", {kSmall_bytes}, 11);
  client.SendHeader(session, 4'000'000'000U);
  SayRefusal(client, session.id.str());
}

void Ask(const std::string& verb, const std::string& json) {
  const auto participant = Must(wire::Participant::Open({}));
  auto connection = Must(client::Connection::Open(participant, {}));
  Must(connection.WaitForServer(kPatience));
  const auto answer = connection.Ask(verb, json, kPatience);
  if (answer) return Say("answer", *answer);
  Say(answer.error().code == ErrorCode::kUnreachable ? "silence" : "error", answer.error().what, answer.error().cure);
}

// One edge of robot wire-a in its partition, changed as a value and as a sample.
void BadEdge(const std::function<void(Edge&)>& spoil,
             const std::function<void(rigcal_wire_PairwiseResult&)>& break_it) {
  Client client = ClientOf("wire-a");
  Edge edge = wire::SampleEdge();
  edge.robot = RobotId("wire-a");
  edge.T_a_b.q.normalize();
  spoil(edge);
  auto owned = Must(wire::ToPairwiseResult(wire::SampleBatch({edge}).front()));
  break_it(owned.sample);
  auto writer = Must(wire::Writer<rigcal_wire_PairwiseResult>::Open(client.participant(), {"robot/wire-a"}));
  Must(writer.WaitForReader(kPatience));
  const std::string subject = owned.sample.batch_id;
  Must(writer.Write(owned.sample));
  SayRefusal(client, subject);
}

const std::map<std::string, std::function<void()>>& Attacks() {
  using Sample = rigcal_wire_PairwiseResult;
  const auto nothing = [](auto&) {};
  static const std::map<std::string, std::function<void()>> kAttacks = {
      {"foreign-robot", ForeignRobot},
      {"stranger-session", StrangerSession},
      {"stranger-chunk", StrangerChunk},
      {"unknown-session-chunk", UnknownSessionChunk},
      {"chunk-outside", ChunkOutside},
      {"huge-chunk", HugeChunk},
      {"disorder", Disorder},
      {"wrong-hash", WrongHash},
      {"beyond-window", BeyondWindow},
      {"manifest-traversal", [] { BadManifest([](auto& text) { Replace(text, "front/100000", "../../etc/x"); }); }},
      {"manifest-hash", [] { BadManifest([](auto& text) { Replace(text, "rig", "gir"); }, true); }},
      {"manifest-garbage", [] { BadManifest([](auto& text) { text = std::string("\xff\x00{{{[", 6); }); }},
      {"manifest-future", [] { BadManifest([](auto& text) { Replace(text, "2023-11-14", "2190-01-01"); }); }},
      {"foreign-manifest", ForeignManifest},
      {"future-protocol", FutureProtocol},
      {"request-malformed", [] { Ask("show", "{{{"); }},
      {"request-10MB", [] { Ask("show", R"({"robot":")" + std::string(10'000'000, 'x') + "\"}"); }},
      {"request-verb", [] { Ask("no-such-verb", "{}"); }},
      {"request-not-utf8", [] { Ask("show", "{\"robot\":\"\xff\xfe\"}"); }},
      {"edge-nan", [=] { BadEdge(nothing, [](Sample& s) { s.p_m[0] = std::numeric_limits<double>::quiet_NaN(); }); }},
      {"edge-foreign", [=] { BadEdge([](Edge& edge) { edge.robot = RobotId("wire-b"); }, nothing); }},
      {"edge-not-utf8", [=] { BadEdge(nothing, [](Sample& s) { s.frame_a[0] = '\xff'; }); }},
      {"edge-id", [=] { BadEdge(nothing, [](Sample& s) { s.edge_id[0] = s.edge_id[0] == '0' ? '1' : '0'; }); }},
      {"edge-index", [=] { BadEdge(nothing, [](Sample& s) { s.batch_idx = 7; }); }},
      {"edge-absurd", [=] { BadEdge([](Edge& edge) { edge.T_a_b.p_m.x() = 1e300; }, nothing); }},
  };
  return kAttacks;
}

}  // namespace
}  // namespace rigcal::dds

int main(int argc, char** argv) {
  const auto& attacks = rigcal::dds::Attacks();
  const auto attack = argc == 2 ? attacks.find(argv[1]) : attacks.end();
  if (attack == attacks.end()) {
    for (const auto& [name, ignored] : attacks) std::fprintf(stderr, "%s\n", name.c_str());
    return 2;
  }
  try {
    attack->second();
    return 0;
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "%s\n", failure.what());
    return 1;
  }
}
