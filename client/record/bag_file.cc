#include "client/record/bag_file.h"

#include <sys/statvfs.h>

#include <chrono>
#include <utility>

namespace rigcal::recording {
namespace {

constexpr std::chrono::milliseconds kFlushEvery(500);

// Free for this user; none where the system does not tell.
std::optional<std::uint64_t> RoomBeside(const std::filesystem::path& file) {
  struct statvfs told {};
  if (statvfs(file.c_str(), &told) != 0) return std::nullopt;
  return static_cast<std::uint64_t>(told.f_bavail) * told.f_frsize;
}

std::optional<Error> NoRoom(const std::filesystem::path& file) {
  const auto room_bytes = RoomBeside(file);
  if (!room_bytes || *room_bytes >= BagFile::kRoomLeftMin_bytes) return std::nullopt;
  return Error{ErrorCode::kBusy,
               "the disk of " + file.string() + " has only " + std::to_string(*room_bytes >> 20) +
                   " MiB left, less than the " + std::to_string(BagFile::kRoomLeftMin_bytes >> 20) +
                   " MiB that recording leaves to the robot",
               "Make room, or record to another disk; what was recorded before is a whole bag."};
}

}  // namespace

Result<std::unique_ptr<BagFile>> BagFile::Begin(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.parent_path().empty() ? std::filesystem::path(".") : path.parent_path();
  if (const auto full = NoRoom(folder)) return Fail(*full);
  RIGCAL_ASSIGN(bags::McapWriter writer, bags::McapWriter::Create(path));
  std::unique_ptr<BagFile> file(new BagFile(std::move(writer)));
  file->thread_ = std::thread([&own = *file] { own.Run(); });
  return file;
}

BagFile::~BagFile() {
  if (thread_.joinable()) (void)End();
}

Result<std::uint16_t> BagFile::Add(const bags::Topic& topic) {
  const std::lock_guard lock(writer_mutex_);
  return writer_.Add(topic);
}

bool BagFile::Put(ReceivedMessage message) {
  const std::lock_guard lock(queue_.mutex);
  if (queue_.trouble || queue_.waiting_bytes + message.bytes.size() > kWaitingBytesMax) return false;
  queue_.waiting_bytes += message.bytes.size();
  queue_.waiting.push_back(std::move(message));
  queue_.news.notify_one();
  return true;
}

std::optional<Error> BagFile::Trouble() const {
  const std::lock_guard lock(queue_.mutex);
  return queue_.trouble;
}

std::deque<ReceivedMessage> BagFile::AwaitMessages(bool& ends) {
  std::unique_lock lock(queue_.mutex);
  queue_.news.wait_for(lock, kFlushEvery, [&] { return queue_.ends || !queue_.waiting.empty(); });
  ends = queue_.ends;
  return std::exchange(queue_.waiting, {});
}

void BagFile::Stop(Error error) {
  const std::lock_guard lock(queue_.mutex);
  queue_.trouble = std::move(error);
}

// What is being written counts as waiting until it is.
void BagFile::Release(std::size_t bytes) {
  const std::lock_guard lock(queue_.mutex);
  queue_.waiting_bytes -= bytes;
}

// A topic may be added between two messages.
Status BagFile::Write(const ReceivedMessage& message) {
  const std::lock_guard lock(writer_mutex_);
  return writer_.Write(message.channel, message.log_ns, message.sent_ns, message.bytes);
}

void BagFile::WriteAll(std::deque<ReceivedMessage> messages) {
  for (; !messages.empty(); messages.pop_front()) {
    const ReceivedMessage& message = messages.front();
    if (Trouble())
      ++unwritten_;
    else if (const Status done = Write(message); !done)
      Stop(done.error());
    Release(message.bytes.size());
  }
}

// A chunk is written when it is full, and twice a second; before each the room is looked at.
void BagFile::Run() {
  auto flushed_at = std::chrono::steady_clock::now();
  for (bool ends = false; !ends;) {
    WriteAll(AwaitMessages(ends));
    const auto now = std::chrono::steady_clock::now();
    if (!ends && now - flushed_at < kFlushEvery) continue;
    flushed_at = now;
    const std::lock_guard lock(writer_mutex_);
    const Status flushed = writer_.Flush();
    if (!flushed) Stop(flushed.error());
    if (const auto full = NoRoom(writer_.path()); full && !Trouble()) Stop(*full);
  }
}

BagTotals BagFile::End() {
  {
    const std::lock_guard lock(queue_.mutex);
    queue_.ends = true;
    queue_.news.notify_one();
  }
  thread_.join();
  const Status closed = writer_.Close();
  if (!closed && !queue_.trouble) queue_.trouble = closed.error();
  return {writer_.messages(), writer_.bytes(), unwritten_ + writer_.waiting_messages()};
}

}  // namespace rigcal::recording
