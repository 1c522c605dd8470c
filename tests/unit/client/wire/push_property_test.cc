// The push engine against a model of the server, over a network that delays, reorders and (in some runs) loses, with
// restarts of the server and two clients at once. The model is written from idl/README.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <random>
#include <set>

#include "client/wire/push_engine.h"

namespace rigcal::client {
namespace {

constexpr std::int64_t kMs_ns = 1'000'000, kSecond_ns = 1'000'000'000;
constexpr std::int64_t kChunkBytes = 10;

struct Faults {
  double loss_ratio = 0.0;     // of what the client sends, and of receipts
  double restart_ratio = 0.0;  // per millisecond
  double discard_ratio = 0.0;  // chunks thrown away although within the window (another session fills the intake)
};

struct Message {
  enum class Kind { kHeader, kManifest, kChunk } kind;
  ChunkAt chunk;
  std::uint64_t to_incarnation;
};

class ModelServer {
 public:
  ModelServer(std::vector<std::int64_t> sizes, std::int64_t window_bytes)
      : sizes_(std::move(sizes)), window_bytes_(window_bytes), held_(sizes_.size(), false) {}

  void Restart() {
    ++incarnation_;
    sequence_number_ = 0;
    queue_.clear();
    parts_.clear();
    busy_.clear();
    written_bytes_ = queued_bytes_ = 0;
  }
  void Take(const Message& message, bool discard) {
    if (message.kind == Message::Kind::kManifest) knows_manifest_ = true;
    if (message.kind != Message::Kind::kChunk || !knows_manifest_) return;
    const auto size_bytes = static_cast<std::int64_t>(message.chunk.size_bytes);
    if (discard || queued_bytes_ + size_bytes > 3 * window_bytes_) {
      if (!held_[message.chunk.payload_idx]) busy_.insert({message.chunk.payload_idx, message.chunk.offset_bytes});
      return;
    }
    queued_bytes_ += size_bytes;
    queue_.push_back(message.chunk);
  }
  void WriteOne() {
    if (queue_.empty()) return;
    const ChunkAt chunk = queue_.front();
    queue_.pop_front();
    queued_bytes_ -= static_cast<std::int64_t>(chunk.size_bytes);
    written_bytes_ += chunk.size_bytes;
    busy_.erase({chunk.payload_idx, chunk.offset_bytes});
    parts_[chunk.payload_idx].insert(chunk.offset_bytes);
  }
  void Commit() {
    for (const auto& [payload, offsets] : parts_)
      if (static_cast<std::int64_t>(offsets.size()) * kChunkBytes >= sizes_[payload]) held_[payload] = true;
  }
  [[nodiscard]] wire::Receipt Tell() {
    wire::Receipt receipt;
    receipt.state = !knows_manifest_ ? wire::ReceiptState::kNeedManifest
                    : AllHeld()      ? wire::ReceiptState::kClosed
                                     : wire::ReceiptState::kReceiving;
    receipt.incarnation = incarnation_;
    receipt.sequence_number = ++sequence_number_;
    receipt.window_bytes = static_cast<std::uint64_t>(window_bytes_);
    receipt.written_bytes = written_bytes_;
    if (knows_manifest_) receipt.held = held_;
    for (const auto& [payload, offset] : busy_) receipt.busy.push_back({payload, offset});
    return receipt;
  }
  [[nodiscard]] bool AllHeld() const {
    return std::all_of(held_.begin(), held_.end(), [](bool held) { return held; });
  }
  [[nodiscard]] std::uint64_t incarnation() const { return incarnation_; }
  [[nodiscard]] std::int64_t queued_bytes() const { return queued_bytes_; }

 private:
  std::vector<std::int64_t> sizes_;
  std::int64_t window_bytes_;
  std::vector<bool> held_;  // on disk: survives Restart
  bool knows_manifest_ = false;
  std::uint64_t incarnation_ = 1, sequence_number_ = 0, written_bytes_ = 0;
  std::int64_t queued_bytes_ = 0;
  std::deque<ChunkAt> queue_;
  std::map<std::uint32_t, std::set<std::uint64_t>> parts_;
  std::set<std::pair<std::uint32_t, std::uint64_t>> busy_;
};

struct Client {
  Client(const PushPlan& plan, std::int64_t now_ns) : engine(plan, now_ns) {}
  PushEngine engine;
  std::deque<Message> on_the_way;
  std::set<std::uint32_t> told_held;  // payloads whose held bit reached this client, by this incarnation
  std::uint64_t told_by = 0;
  bool ended = false;
};

class World {
 public:
  World(unsigned seed, int clients, const Faults& faults) : random_(seed), faults_(faults) {
    PushPlan plan;
    plan.chunk_bytes = kChunkBytes;
    const int payloads = std::uniform_int_distribution<int>(1, 20)(random_);
    for (int i = 0; i < payloads; ++i) plan.payload_bytes.push_back(std::uniform_int_distribution<int>(1, 95)(random_));
    window_bytes_ = std::uniform_int_distribution<int>(kChunkBytes, 120)(random_);
    server_ = std::make_unique<ModelServer>(plan.payload_bytes, window_bytes_);
    for (int i = 0; i < clients; ++i) clients_.push_back(std::make_unique<Client>(plan, 0));
  }

  // False if somebody did not end well in ten minutes of the model's time.
  bool Run() {
    for (now_ns_ = 0; now_ns_ < 600 * kSecond_ns; now_ns_ += kMs_ns) {
      if (Chance(faults_.restart_ratio)) server_->Restart();
      for (auto& client : clients_) Act(*client);
      for (auto& client : clients_) Deliver(*client);
      for (int i = 0; i < 3; ++i) server_->WriteOne();
      if (Chance(0.2)) Tell();
      if (std::all_of(clients_.begin(), clients_.end(), [](const auto& client) { return client->ended; })) return true;
    }
    return false;
  }
  [[nodiscard]] const ModelServer& server() const { return *server_; }
  [[nodiscard]] int chunks_sent() const { return chunks_sent_; }

 private:
  bool Chance(double ratio) { return std::uniform_real_distribution<double>(0.0, 1.0)(random_) < ratio; }

  void Act(Client& client) {
    while (!client.ended) {
      const PushAction action = client.engine.Next(now_ns_);
      ASSERT_NE(action.kind, PushAction::Kind::kRefused);
      ASSERT_NE(action.kind, PushAction::Kind::kGaveUp);
      if (action.kind == PushAction::Kind::kClosed) client.ended = true;
      if (action.kind == PushAction::Kind::kWait || client.ended) break;
      Send(client, action);
    }
    if (clients_.size() == 1 && faults_.loss_ratio == 0.0) CheckWindow(client);
  }

  void Send(Client& client, const PushAction& action) {
    Message message{Message::Kind::kHeader, action.chunk, server_->incarnation()};
    if (action.kind == PushAction::Kind::kSendManifest) message.kind = Message::Kind::kManifest;
    if (action.kind == PushAction::Kind::kSendChunk) {
      message.kind = Message::Kind::kChunk;
      ++chunks_sent_;
      EXPECT_EQ(client.told_held.count(action.chunk.payload_idx), 0U) << "a receipted payload was sent again";
    }
    if (!Chance(faults_.loss_ratio)) client.on_the_way.push_back(message);
  }

  // What is on its way to this server or waits in it, neither written nor discarded.
  void CheckWindow(const Client& client) {
    std::int64_t bytes = server_->queued_bytes();
    for (const Message& message : client.on_the_way)
      if (message.kind == Message::Kind::kChunk && message.to_incarnation == server_->incarnation())
        bytes += static_cast<std::int64_t>(message.chunk.size_bytes);
    // What went out between a restart and the first word of the new process is unknown to both sides: one window more.
    EXPECT_LE(bytes, server_->incarnation() == 1 ? window_bytes_ : 2 * window_bytes_);
  }

  void Deliver(Client& client) {
    while (!client.on_the_way.empty() && Chance(0.7)) {
      const std::size_t last = std::min<std::size_t>(client.on_the_way.size(), 3) - 1;
      const auto pick = client.on_the_way.begin() +
                        std::uniform_int_distribution<std::ptrdiff_t>(0, static_cast<std::ptrdiff_t>(last))(random_);
      const Message message = *pick;
      client.on_the_way.erase(pick);
      if (message.to_incarnation != server_->incarnation()) continue;  // went down with the old process
      server_->Take(message, Chance(faults_.discard_ratio));
      if (message.kind == Message::Kind::kHeader) Tell();
    }
  }

  void Tell() {
    server_->Commit();
    const wire::Receipt receipt = server_->Tell();
    for (auto& client : clients_) {
      if (client->ended || Chance(faults_.loss_ratio)) continue;
      if (client->told_by != receipt.incarnation) client->told_held.clear();
      client->told_by = receipt.incarnation;
      for (std::uint32_t i = 0; i < receipt.held.size(); ++i)
        if (receipt.held[i]) client->told_held.insert(i);
      client->engine.OnReceipt(receipt, now_ns_);
    }
  }

  std::mt19937 random_;
  Faults faults_;
  std::int64_t window_bytes_ = 0, now_ns_ = 0;
  int chunks_sent_ = 0;
  std::unique_ptr<ModelServer> server_;
  std::vector<std::unique_ptr<Client>> clients_;
};

void ExpectEndsWell(int clients, const Faults& faults, unsigned runs) {
  for (unsigned seed = 0; seed < runs; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    World world(seed, clients, faults);
    ASSERT_TRUE(world.Run()) << "did not end";
    EXPECT_TRUE(world.server().AllHeld());
    if (testing::Test::HasFailure()) return;
  }
}

TEST(PushProperty, InPeaceTheWindowIsKept) { ExpectEndsWell(1, {}, 200); }
TEST(PushProperty, DiscardedChunksComeAgainWithinTheWindow) { ExpectEndsWell(1, {0.0, 0.0, 0.2}, 200); }
TEST(PushProperty, RestartsOfTheServer) { ExpectEndsWell(1, {0.0, 0.005, 0.05}, 200); }
TEST(PushProperty, LossesOfEverything) { ExpectEndsWell(1, {0.2, 0.0, 0.05}, 100); }
TEST(PushProperty, LossesAndRestarts) { ExpectEndsWell(1, {0.1, 0.0005, 0.05}, 100); }
TEST(PushProperty, TwoClientsAtOnceBothEndWell) { ExpectEndsWell(2, {0.0, 0.0005, 0.1}, 200); }

}  // namespace
}  // namespace rigcal::client
