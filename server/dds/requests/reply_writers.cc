#include "server/dds/requests/reply_writers.h"

namespace rigcal::dds {
namespace {

constexpr std::size_t kPartitionsMax = 16'000;  // a participant may have 16,382 publishers
constexpr std::chrono::seconds kReplyQuietFor{5}, kReplyLookEvery{1};

}  // namespace

Result<ReplyWriters::Kept*> ReplyWriters::WriterOf(const std::string& partition) {
  const auto known = writers_.find(partition);
  if (known != writers_.end()) return &known->second;
  if (writers_.size() >= kPartitionsMax)
    return Fail(ErrorCode::kInvalidInput, "too many partitions ask", "Ask in partition operator");
  RIGCAL_ASSIGN(auto writer, Writer::Open(participant_, {partition}));
  RIGCAL_TRY(waitset_.Attach(writer.get()));
  return &writers_.emplace(partition, Kept{std::move(writer), std::chrono::steady_clock::now()}).first->second;
}

Status ReplyWriters::Add(const std::string& partition) {
  RIGCAL_TRY(WriterOf(partition));
  return {};
}

Status ReplyWriters::Send(const std::string& partition, dds_instance_handle_t participant,
                          const rigcal_wire_Reply& part) {
  RIGCAL_ASSIGN(Kept* const kept, WriterOf(partition));
  if (!kept->writer.HasReaderOf(participant))
    return Fail(ErrorCode::kUnreachable, "a client that asked does not read replies yet", "Wait for its reader");
  return kept->writer.Write(part);
}

void ReplyWriters::CloseQuiet() {
  const Time now = std::chrono::steady_clock::now();
  if (now < next_look_) return;
  next_look_ = now + kReplyLookEvery;
  for (auto& [partition, kept] : writers_)
    if (kept.writer.MatchedReaders() > 0 || partition == wire::kOperatorPartition) kept.quiet_since = now;
  std::erase_if(writers_, [&](const auto& one) { return one.second.quiet_since + kReplyQuietFor < now; });
}

}  // namespace rigcal::dds
