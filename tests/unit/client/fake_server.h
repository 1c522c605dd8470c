// The server's half of idl/README.md in memory, on a thread of the test: answers questions through a function, takes
// sessions and batches, tells receipts and events. Isolated by a tag of its own.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <thread>

#include "idl/convert.h"
#include "idl/dds.h"
#include "server/base/digests/sha256.h"
#include "server/formats/answers/answers.h"
#include "server/formats/documents.h"
#include "tests/unit/temp_folder.h"

namespace rigcal::client {

using std::chrono::milliseconds;

inline wire::ParticipantOptions TestPlace() {
  static const std::string tag = "test-" + std::to_string(std::random_device()()) + "-" + std::to_string(::getpid());
  return {0, tag};
}

// What the server knows of one session or batch.
struct FakeSubject {
  std::optional<Manifest> manifest;
  std::map<std::uint32_t, std::string> payloads;  // a batch: the edge ids
  std::uint32_t count = 0;
  std::uint64_t written_bytes = 0;
  int samples = 0;  // chunks or items that came
  std::optional<Error> complaint;
};

class FakeServer {
 public:
  using AnswerTo = std::function<Result<std::string>(const std::string& verb, const std::string& json)>;

  explicit FakeServer(const std::string& robot, AnswerTo answer = {})
      : robot_(robot),
        answer_(std::move(answer)),
        participant_(Must(wire::Participant::Open(TestPlace()))),
        requests_(Open<wire::Reader<rigcal_wire_Request>>("operator")),
        headers_(Open<wire::Reader<rigcal_wire_SessionHeader>>("robot/*")),
        manifests_(Open<wire::Reader<rigcal_wire_Manifest>>("robot/*")),
        chunks_(Open<wire::Reader<rigcal_wire_Chunk>>("robot/*")),
        items_(Open<wire::Reader<rigcal_wire_PairwiseResult>>("robot/*")),
        replies_(Open<wire::Writer<rigcal_wire_Reply>>("operator")),
        receipts_(Open<wire::Writer<rigcal_wire_Receipt>>("robot/" + robot)),
        events_(Open<wire::Writer<rigcal_wire_Event>>("robot/" + robot)),
        waitset_(Must(wire::WaitSet::Open(participant_))) {
    for (const dds_entity_t reader : {requests_.get(), headers_.get(), manifests_.get(), chunks_.get(), items_.get()})
      EXPECT_TRUE(waitset_.Attach(reader));
    thread_ = std::thread([this] { Run(); });
  }
  FakeServer(const FakeServer&) = delete;
  FakeServer& operator=(const FakeServer&) = delete;
  ~FakeServer() {
    stopped_ = true;
    waitset_.Wake();
    thread_.join();
  }

  // Parts of this size; 0: one part.
  std::atomic<std::size_t> part_bytes{0};
  std::atomic<int> requests_to_ignore{0};
  std::atomic<int> requests_seen{0};
  std::atomic<bool> restart_after_next_chunk{false};

  FakeSubject Subject(const std::string& id) {
    const std::lock_guard lock(mutex_);
    return subjects_[id];
  }
  // Ids of all sessions and batches of which anything came.
  std::set<std::string> SubjectsSeen() {
    const std::lock_guard lock(mutex_);
    std::set<std::string> ids;
    for (const auto& [id, subject] : subjects_) ids.insert(id);
    return ids;
  }
  [[nodiscard]] const wire::Participant& participant() const { return participant_; }
  void SendEvent(const std::string& kind, const std::string& json) {
    rigcal_wire_Event event{};
    EXPECT_TRUE(wire::CopyText(robot_, event.robot_id, sizeof event.robot_id, "robot"));
    EXPECT_TRUE(wire::CopyText(kind, event.kind, sizeof event.kind, "kind"));
    std::string text = json;
    event.json = text.data();
    event.stamp_ns = 1'700'000'000'000'000'000;
    EXPECT_TRUE(events_.Write(event));
  }
  [[nodiscard]] bool HasWatcher() const { return events_.WaitForReader(milliseconds(100)).has_value(); }

 private:
  template <typename T>
  static T Must(Result<T> result) {
    if (!result) throw std::runtime_error(Sentence(result.error()));
    return std::move(*result);
  }
  template <typename Endpoint>
  Endpoint Open(const std::string& partition) {
    return Must(Endpoint::Open(participant_, {partition}));
  }

  void Run() {
    while (!stopped_) {
      EXPECT_TRUE(waitset_.Wait(milliseconds(1000)));
      TakeRequests();
      const std::lock_guard lock(mutex_);
      std::set<std::string> touched;
      TakeSessions(touched);
      TakeItems(touched);
      for (const std::string& id : touched) SendReceipt(id);
    }
  }

  void TakeRequests() {
    std::vector<std::array<std::string, 3>> taken;
    EXPECT_TRUE(requests_.Take(64, [&](const rigcal_wire_Request& request, const wire::SampleOrigin&) {
      ++requests_seen;
      if (requests_to_ignore > 0)
        --requests_to_ignore;
      else
        taken.push_back({request.id, request.verb, request.json});
    }));
    for (const auto& [id, verb, json] : taken) {
      const auto answer = answer_ ? answer_(verb, json) : Result<std::string>("{}");
      SendReply("unrelated", "{\"other\":true}");
      SendReply(id, answer ? *answer : formats::WriteError(answer.error()));
    }
  }

  void SendReply(const std::string& id, const std::string& text) {
    const std::size_t size = part_bytes == 0 ? text.size() : part_bytes.load();
    const std::size_t count = std::max<std::size_t>((text.size() + size - 1) / std::max<std::size_t>(size, 1), 1);
    for (std::size_t i = count; i-- > 0;) {  // last part first: the order must not matter
      rigcal_wire_Reply reply{};
      EXPECT_TRUE(wire::CopyText(id, reply.id, sizeof reply.id, "id"));
      reply.part_idx = static_cast<std::uint32_t>(i);
      reply.part_count = static_cast<std::uint32_t>(count);
      std::string part = text.substr(i * size, size);
      reply.json = part.data();
      EXPECT_TRUE(replies_.Write(reply));
    }
  }

  void TakeSessions(std::set<std::string>& touched) {
    EXPECT_TRUE(headers_.Take(64, [&](const rigcal_wire_SessionHeader& header, const wire::SampleOrigin&) {
      subjects_[header.session_id].count = header.payload_count;
      touched.insert(header.session_id);
    }));
    EXPECT_TRUE(manifests_.Take(8, [&](const rigcal_wire_Manifest& sample, const wire::SampleOrigin&) {
      const std::string text(reinterpret_cast<const char*>(sample.bytes._buffer), sample.bytes._length);
      EXPECT_EQ(Sha256Of(text).str(), sample.session_id);
      subjects_[sample.session_id].manifest = Must(formats::ReadManifest(text));
      touched.insert(sample.session_id);
    }));
    EXPECT_TRUE(chunks_.Take(64, [&](const rigcal_wire_Chunk& chunk, const wire::SampleOrigin&) {
      TakeChunk(chunk);
      touched.insert(chunk.session_id);
    }));
  }

  void TakeChunk(const rigcal_wire_Chunk& chunk) {
    FakeSubject& subject = subjects_[chunk.session_id];
    ++subject.samples;
    subject.written_bytes += chunk.bytes._length;
    if (!subject.manifest || chunk.payload_idx >= subject.count) return;
    std::string& bytes = subject.payloads[chunk.payload_idx];
    bytes.resize(std::max<std::size_t>(bytes.size(), chunk.offset_bytes + chunk.bytes._length));
    std::copy_n(chunk.bytes._buffer, chunk.bytes._length,
                bytes.begin() + static_cast<std::ptrdiff_t>(chunk.offset_bytes));
    const Payload& payload = subject.manifest->payloads[chunk.payload_idx];
    if (static_cast<std::int64_t>(bytes.size()) == payload.size_bytes && Sha256Of(bytes) != payload.digest) {
      subject.payloads.erase(chunk.payload_idx);
      subject.complaint = Error{ErrorCode::kConflict, payload.path + ": its bytes do not have the hash", "Push again"};
    }
    if (restart_after_next_chunk.exchange(false)) Restart();
  }

  // A restarted process: only whole payloads survive.
  void Restart() {
    ++incarnation_;
    for (auto& [id, subject] : subjects_) {
      subject.written_bytes = 0;
      for (std::uint32_t i = 0; i < subject.count; ++i)
        if (!IsHeld(subject, i)) subject.payloads.erase(i);
    }
  }

  void TakeItems(std::set<std::string>& touched) {
    EXPECT_TRUE(items_.Take(4096, [&](const rigcal_wire_PairwiseResult& sample, const wire::SampleOrigin&) {
      const auto item = wire::FromPairwiseResult(sample);
      ASSERT_TRUE(item) << Sentence(item.error());
      FakeSubject& subject = subjects_[sample.batch_id];
      subject.count = item->count;
      ++subject.samples;
      subject.payloads[item->idx] = item->edge.id.str();
      touched.insert(sample.batch_id);
    }));
  }

  static bool IsHeld(const FakeSubject& subject, std::uint32_t idx) {
    const auto found = subject.payloads.find(idx);
    if (found == subject.payloads.end()) return false;
    return !subject.manifest ||
           static_cast<std::int64_t>(found->second.size()) == subject.manifest->payloads[idx].size_bytes;
  }

  void SendReceipt(const std::string& id) {
    FakeSubject& subject = subjects_[id];
    wire::Receipt receipt;
    receipt.robot = RobotId(robot_);
    receipt.subject_id = id;
    receipt.incarnation = incarnation_;
    receipt.sequence_number = ++sequence_number_;
    receipt.window_bytes = 4 << 20;
    receipt.written_bytes = subject.written_bytes;
    receipt.error = subject.complaint;
    for (std::uint32_t i = 0; i < subject.count; ++i) receipt.held.push_back(IsHeld(subject, i));
    const bool all = std::all_of(receipt.held.begin(), receipt.held.end(), [](bool held) { return held; });
    const bool needs_manifest = !subject.manifest && subject.payloads.empty();
    receipt.state = needs_manifest ? wire::ReceiptState::kNeedManifest
                    : all          ? wire::ReceiptState::kClosed
                                   : wire::ReceiptState::kReceiving;
    if (needs_manifest) receipt.held.clear();
    EXPECT_TRUE(receipts_.Write(Must(wire::ToReceipt(receipt)).sample));
  }

  std::string robot_;
  AnswerTo answer_;
  wire::Participant participant_;
  wire::Reader<rigcal_wire_Request> requests_;
  wire::Reader<rigcal_wire_SessionHeader> headers_;
  wire::Reader<rigcal_wire_Manifest> manifests_;
  wire::Reader<rigcal_wire_Chunk> chunks_;
  wire::Reader<rigcal_wire_PairwiseResult> items_;
  wire::Writer<rigcal_wire_Reply> replies_;
  wire::Writer<rigcal_wire_Receipt> receipts_;
  wire::Writer<rigcal_wire_Event> events_;
  wire::WaitSet waitset_;
  std::mutex mutex_;
  std::map<std::string, FakeSubject> subjects_;
  std::uint64_t incarnation_ = 1, sequence_number_ = 0;
  std::atomic<bool> stopped_{false};
  std::thread thread_;
};

// A session's folder that goes with the test.
class SessionFolder : public TempFolder {
 public:
  void Write(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories((path() / name).parent_path());
    std::ofstream(path() / name, std::ios::binary) << bytes;
  }
  // Two cameras, `captures` each, files of `size_bytes` that begin like pictures.
  void WriteSession(const std::string& robot, int captures, std::size_t size_bytes) const {
    Write("session.yaml",
          "format: 1\nrobot: " + robot +
              "\ncaptured_at: 2026-01-31T12:00:00Z\ntargets:\n  board: {type: checkerboard, inner_corners: [9, 6], "
              "square_size_m: 0.025}\nsensors:\n  left: {type: camera}\n  right: {type: camera}\n");
    std::mt19937 random(7);
    for (const std::string sensor : {"left", "right"})
      for (int i = 0; i < captures; ++i) {
        std::string bytes("\x89PNG\r\n\x1a\n", 8);
        while (bytes.size() < size_bytes) bytes.push_back(static_cast<char>(random()));
        Write(sensor + "/" + std::to_string(i) + ".png", bytes);
      }
  }
};

}  // namespace rigcal::client
