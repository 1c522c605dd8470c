// A server on a temporary store and clients beside it, isolated by a random tag. Sessions of small random payloads.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <vector>

#include "idl/convert.h"
#include "idl/dds.h"
#include "server/base/digests/sha256.h"
#include "server/dds/service.h"
#include "server/formats/documents.h"
#include "tests/unit/temp_folder.h"

namespace rigcal::dds {

using std::chrono::milliseconds;
constexpr milliseconds kPatience{60'000};  // for what must come; never waited out when all is well

inline std::string RandomTag() {
  std::random_device random;
  return "test-" + std::to_string(random()) + "-" + std::to_string(random());
}

// Unwraps a Result that must be good; a test stops here otherwise.
template <typename T>
T Must(Result<T> result) {
  if (!result) throw std::runtime_error(Sentence(result.error()));
  return std::move(*result);
}
inline void Must(const Status& status) {
  if (!status) throw std::runtime_error(Sentence(status.error()));
}

// A session as a client has it: manifest text and payload bytes in the manifest's order.
struct Session {
  RobotId robot;
  SessionId id;
  std::string manifest;
  std::vector<std::string> payloads;
};

inline std::string RandomBytes(std::size_t count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::string bytes("\x89PNG\r\n\x1a\n", 8);
  bytes.reserve(count + sizeof(std::uint64_t));
  while (bytes.size() < count) {
    const std::uint64_t word = random();
    bytes.append(reinterpret_cast<const char*>(&word), sizeof word);
  }
  bytes.resize(count);
  return bytes;
}

// One camera, `sizes.size()` captures; content by `seed`, so that another seed is another session.
inline Session MakeSession(const std::string& robot, const std::vector<std::size_t>& sizes, unsigned seed) {
  Manifest manifest;
  SessionHeader& header = manifest.header;
  header.robot = RobotId(robot);
  header.rig_model = "rig";
  header.captured_at = Stamp{1'700'000'000'000'000'000};
  header.reference = SensorId("front");
  Sensor camera;
  camera.id = SensorId("front");
  header.sensors = {camera};
  Target board;
  board.id = TargetId("board");
  board.cols = 9;
  board.rows = 6;
  board.square_m = 0.025;
  header.targets = {board};
  header.conditions["seed"] = std::to_string(seed);
  Session session;
  session.robot = header.robot;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    session.payloads.push_back(RandomBytes(sizes[i], seed + static_cast<unsigned>(i)));
    const std::string capture = std::to_string(100'000 + i);
    manifest.payloads.push_back({"front/" + capture + ".png", camera.id, CaptureId(capture),
                                 Sha256Of(std::string_view(session.payloads.back())),
                                 static_cast<std::int64_t>(sizes[i])});
  }
  session.manifest = formats::WriteManifest(manifest);
  session.id = SessionId(Sha256Of(std::string_view(session.manifest)).str());
  return session;
}

// The same payloads in the name of a robot; `note` makes it another session.
inline Session OfRobot(const Session& session, const std::string& robot, const std::string& note) {
  Manifest manifest = Must(formats::ReadManifest(session.manifest));
  manifest.header.robot = RobotId(robot);
  manifest.header.conditions["note"] = note;
  Session other = session;
  other.robot = manifest.header.robot;
  other.manifest = formats::WriteManifest(manifest);
  other.id = SessionId(Sha256Of(std::string_view(other.manifest)).str());
  return other;
}

// What a robot's computer does: writes in one robot's partition, reads its receipts.
class Client {
 public:
  Client(const wire::ParticipantOptions& options, const RobotId& partition)
      : participant_(Must(wire::Participant::Open(options))),
        headers_(Writer<rigcal_wire_SessionHeader>(partition)),
        manifests_(Writer<rigcal_wire_Manifest>(partition)),
        chunks_(Writer<rigcal_wire_Chunk>(partition)),
        edges_(Writer<rigcal_wire_PairwiseResult>(partition)),
        receipts_(Must(wire::Reader<rigcal_wire_Receipt>::Open(participant_, {wire::RobotPartition(partition)}))),
        waitset_(Must(wire::WaitSet::Open(participant_))) {
    Must(waitset_.Attach(receipts_.get()));
    Must(headers_.WaitForReader(kPatience));
    Must(manifests_.WaitForReader(kPatience));
    Must(chunks_.WaitForReader(kPatience));
    Must(edges_.WaitForReader(kPatience));
    Must(receipts_.WaitForWriter(kPatience));
  }

  void SendHeader(const Session& session, std::uint32_t protocol = 1) {
    rigcal_wire_SessionHeader sample{};
    Put(session.robot.str(), sample.robot_id);
    Put(session.id.str(), sample.session_id);
    sample.protocol = protocol;
    sample.payload_count = static_cast<std::uint32_t>(session.payloads.size());
    Must(headers_.Write(sample));
  }
  void SendManifest(const Session& session) {
    rigcal_wire_Manifest sample{};
    Put(session.robot.str(), sample.robot_id);
    Put(session.id.str(), sample.session_id);
    sample.bytes = Borrow(session.manifest);
    Must(manifests_.Write(sample));
  }
  // kBusy is the caller's to see.
  Status TrySendChunk(const Session& session, std::uint32_t payload_idx, std::uint64_t offset, std::string_view bytes) {
    rigcal_wire_Chunk sample{};
    Put(session.robot.str(), sample.robot_id);
    Put(session.id.str(), sample.session_id);
    sample.payload_idx = payload_idx;
    sample.offset_bytes = offset;
    sample.bytes = Borrow(bytes);
    return chunks_.Write(sample);
  }
  void SendChunk(const Session& session, std::uint32_t payload_idx, std::uint64_t offset, std::string_view bytes) {
    Must(TrySendChunk(session, payload_idx, offset, bytes));
  }
  void SendPayload(const Session& session, std::uint32_t payload_idx) {
    SendChunk(session, payload_idx, 0, session.payloads[payload_idx]);
  }
  void SendEdge(const wire::BatchItem& item) {
    const auto owned = Must(wire::ToPairwiseResult(item));
    Must(edges_.Write(owned.sample));
  }

  // Takes receipts until one of the subject satisfies `done`; that one.
  wire::Receipt Await(const std::string& subject, const std::function<bool(const wire::Receipt&)>& done) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    std::optional<wire::Receipt> found;
    while (!found) {
      if (std::chrono::steady_clock::now() > deadline) throw std::runtime_error("no such receipt of " + subject);
      static_cast<void>(Must(waitset_.Wait(milliseconds(200))));
      static_cast<void>(Must(receipts_.Take(64, [&](const rigcal_wire_Receipt& sample, const wire::SampleOrigin&) {
        wire::Receipt receipt = Must(wire::FromReceipt(sample));
        if (!found && receipt.subject_id == subject && done(receipt)) found = std::move(receipt);
      })));
    }
    return *found;
  }
  wire::Receipt AwaitState(const std::string& subject, wire::ReceiptState state) {
    return Await(subject, [&](const wire::Receipt& receipt) { return receipt.state == state; });
  }
  // Header, manifest, all payloads in one chunk each; the closing receipt.
  wire::Receipt Push(const Session& session) {
    SendHeader(session);
    AwaitState(session.id.str(), wire::ReceiptState::kNeedManifest);
    SendManifest(session);
    AwaitState(session.id.str(), wire::ReceiptState::kReceiving);
    for (std::uint32_t i = 0; i < session.payloads.size(); ++i) SendPayload(session, i);
    return AwaitState(session.id.str(), wire::ReceiptState::kClosed);
  }
  wire::Participant& participant() { return participant_; }

 private:
  template <typename T>
  wire::Writer<T> Writer(const RobotId& partition) {
    return Must(wire::Writer<T>::Open(participant_, {wire::RobotPartition(partition)}));
  }
  template <std::size_t N>
  static void Put(const std::string& text, char (&to)[N]) {
    Must(wire::CopyText(text, to, N, "text"));
  }
  static dds_sequence_octet Borrow(std::string_view bytes) {
    const auto count = static_cast<std::uint32_t>(bytes.size());
    auto* data = reinterpret_cast<std::uint8_t*>(const_cast<char*>(bytes.data()));
    return {count, count, data, false};
  }

  wire::Participant participant_;
  wire::Writer<rigcal_wire_SessionHeader> headers_;
  wire::Writer<rigcal_wire_Manifest> manifests_;
  wire::Writer<rigcal_wire_Chunk> chunks_;
  wire::Writer<rigcal_wire_PairwiseResult> edges_;
  wire::Reader<rigcal_wire_Receipt> receipts_;
  wire::WaitSet waitset_;
};

// The service with an answer that echoes, and what it called back.
class ServiceTest : public testing::Test {
 protected:
  void SetUp() override {
    options_.participant.tag = RandomTag();
    options_.place = folder_.path();
    StartServer();
  }
  void StartServer() {
    Callbacks callbacks;
    callbacks.answer = [this](storage::Store&, const std::string& verb, const std::string& json) {
      return answer_(verb, json);
    };
    callbacks.is_order = [](const std::string& verb) { return verb == "restore"; };
    callbacks.carry_out = [this](storage::Store&, const std::string& verb, const std::string& json,
                                 const OrderOrigin& origin) {
      channels_.push_back(origin.channel);
      if (origin.verified) verified_.push_back(origin.verified->name);
      return carry_out_(verb, json);
    };
    callbacks.state_of = [this](storage::Store&, const RobotId& robot) { return state_of_(robot); };
    callbacks.work_arrived = [this](const RobotId& robot) {
      const std::lock_guard lock(mutex_);
      work_.push_back(robot);
    };
    server_.emplace(Must(Service::Start(options_, std::move(callbacks))));
  }
  void StopServer() { server_.reset(); }
  Client MakeClient(const std::string& robot) { return Client(options_.participant, RobotId(robot)); }
  // As when a revision was stored.
  void StoreAndTell(const RobotState& state) {
    StoreState(state);
    server_->Tell(state.newest.robot);
  }
  void StoreState(const RobotState& state) {
    const std::lock_guard lock(mutex_);
    states_[state.newest.robot] = state;
  }
  Result<std::optional<RobotState>> LoadState(const RobotId& robot) {
    const std::lock_guard lock(mutex_);
    const auto found = states_.find(robot);
    return found == states_.end() ? std::nullopt : std::optional(found->second);
  }
  std::vector<RobotId> Work() {
    const std::lock_guard lock(mutex_);
    return work_;
  }

  TempFolder folder_;
  Options options_;
  std::function<Result<std::string>(const std::string&, const std::string&)> answer_ =
      [](const std::string& verb, const std::string& json) -> Result<std::string> { return verb + json; };
  std::vector<OrderChannel> channels_;  // of what was carried out
  std::vector<std::string> verified_;   // likewise: who was
  std::function<Result<OrderDone>(const std::string&, const std::string&)> carry_out_ =
      [](const std::string& verb, const std::string& json) -> Result<OrderDone> {
    return OrderDone{RobotId("mapper-01"), "done " + verb + json};
  };
  std::function<Result<std::optional<RobotState>>(const RobotId&)> state_of_ = [this](const RobotId& robot) {
    return LoadState(robot);
  };
  std::mutex mutex_;
  std::vector<RobotId> work_;
  std::map<RobotId, RobotState> states_;  // stored
  std::optional<Service> server_;
};

}  // namespace rigcal::dds
