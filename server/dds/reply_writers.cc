#include "server/dds/reply_writers.h"

namespace rigcal::dds {
namespace {

constexpr std::size_t kPartitionsMax = 16'000;  // a participant may have 16,382 publishers

}  // namespace

Result<ReplyWriters::Writer*> ReplyWriters::WriterOf(const std::string& partition) {
  const auto known = writers_.find(partition);
  if (known != writers_.end()) return &known->second;
  if (writers_.size() >= kPartitionsMax)
    return Fail(ErrorCode::kInvalidInput, "too many partitions ask", "Ask in partition operator");
  RIGCAL_ASSIGN(auto writer, Writer::Open(participant_, {partition}));
  RIGCAL_TRY(waitset_.Attach(writer.get()));
  return &writers_.emplace(partition, std::move(writer)).first->second;
}

Status ReplyWriters::Add(const std::string& partition) {
  RIGCAL_TRY(WriterOf(partition));
  return {};
}

Status ReplyWriters::Send(const std::string& partition, dds_instance_handle_t participant,
                          const rigcal_wire_Reply& part) {
  RIGCAL_ASSIGN(Writer* const writer, WriterOf(partition));
  if (!writer->HasReaderOf(participant))
    return Fail(ErrorCode::kUnreachable, "a client that asked does not read replies yet", "Wait for its reader");
  return writer->Write(part);
}

}  // namespace rigcal::dds
