// The bag that a recording writes, by a thread of its own: who takes messages off the network never waits for the disk.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "client/bags/mcap/mcap_writer.h"

namespace rigcal::recording {

struct ReceivedMessage {
  std::uint16_t channel = 0;
  std::int64_t log_ns = 0, sent_ns = 0;  // by this machine's clock; by the sender's
  std::vector<std::byte> bytes;
};

struct BagTotals {
  std::uint64_t messages = 0, bytes = 0;  // in the file
  std::uint64_t unwritten = 0;            // that were put in, and are not: the disk failed
};

// What is put in is in the file a second later, and so when the process is killed; after End() power may fail.
class BagFile {
 public:
  // kConflict: there is a file of that name. kBusy: the disk has hardly any room left.
  [[nodiscard]] static Result<std::unique_ptr<BagFile>> Begin(const std::filesystem::path& path);
  ~BagFile();
  BagFile(const BagFile&) = delete;
  BagFile& operator=(const BagFile&) = delete;

  // The topic's number, for messages.
  [[nodiscard]] Result<std::uint16_t> Add(const bags::Topic& topic);
  // False: so much waits for the disk (kWaitingBytesMax) that this one is not taken.
  [[nodiscard]] bool Put(ReceivedMessage message);
  // Why nothing is written any more; nothing: it is. A disk that is nearly full counts (kBusy): the robot needs the
  // rest.
  [[nodiscard]] std::optional<Error> Trouble() const;
  // Writes what waits and closes the file, which stays what it is also where the disk failed: a bag as far as it goes.
  [[nodiscard]] BagTotals End();

  static constexpr std::size_t kWaitingBytesMax = 256 << 20;
  static constexpr std::uint64_t kRoomLeftMin_bytes = 64 << 20;

 private:
  explicit BagFile(bags::McapWriter writer) : writer_(std::move(writer)) {}
  void Run();
  [[nodiscard]] std::deque<ReceivedMessage> AwaitMessages(bool& ends);
  void WriteAll(std::deque<ReceivedMessage> messages);
  [[nodiscard]] Status Write(const ReceivedMessage& message);
  void Release(std::size_t bytes);
  void Stop(Error error);

  // What both threads use.
  struct Queue {
    mutable std::mutex mutex = {};
    std::condition_variable news = {};
    std::deque<ReceivedMessage> waiting = {};
    std::size_t waiting_bytes = 0;
    bool ends = false;
    std::optional<Error> trouble = {};
  } queue_;
  std::mutex writer_mutex_;
  bags::McapWriter writer_;
  std::uint64_t unwritten_ = 0;
  std::thread thread_;
};

}  // namespace rigcal::recording
