#include "client/bags/mcap/mcap_writer.h"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>

#include "server/base/files/durable_file.h"

namespace rigcal::bags {
namespace {

constexpr std::size_t kChunkFrom_bytes = 4 << 20;  // a chunk of so many bytes is written
constexpr std::size_t kChannelsMax = 10'000;
constexpr std::string_view kRos2 = "ros2", kWrittenBy = "rigcal";

std::uint32_t CrcOf(Bytes bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

// Errno of what failed; 0: all is written.
int WriteAll(int file, Bytes bytes) {
  while (!bytes.empty()) {
    const ssize_t done = write(file, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return done == 0 ? ENOSPC : errno;
    bytes = bytes.subspan(static_cast<std::size_t>(done));
  }
  return 0;
}

McapBytes ChunkHead(std::uint64_t start_ns, std::uint64_t end_ns, Bytes records) {
  McapBytes content;
  content.Number(start_ns);
  content.Number(end_ns);
  content.Number<std::uint64_t>(records.size());
  content.Number(CrcOf(records));
  content.Text("");
  content.Number<std::uint64_t>(records.size());
  return content;
}

}  // namespace

Result<McapWriter> McapWriter::Create(const std::filesystem::path& path) {
  FileDescriptor file(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (file.get() < 0 && errno == EEXIST)
    return Fail(ErrorCode::kConflict, path.string() + " is there already", "Give another path, or remove it.");
  if (file.get() < 0) return FileFailure(path, "be created", errno);
  McapWriter writer(path, std::move(file));
  McapBytes head, content;
  head.Raw(BytesIn(kMcapMagic));
  content.Text(kRos2);
  content.Text(kWrittenBy);
  head.Record(McapOp::kHeader, content);
  RIGCAL_TRY(writer.Append(head));
  return writer;
}

// Whole, or not at all.
Status McapWriter::Append(const McapBytes& bytes) {
  if (failed_) return Fail(*failed_);
  const int error = WriteAll(file_.get(), bytes.bytes());
  if (error == 0) {
    written_bytes_ += bytes.size();
    return {};
  }
  failed_ = FileFailure(path_, "be written", error).value();
  const auto whole = static_cast<off_t>(written_bytes_);
  if (ftruncate(file_.get(), whole) != 0 || lseek(file_.get(), whole, SEEK_SET) < 0)
    failed_->what += ", and may end amid a chunk";
  return Fail(*failed_);
}

Result<std::uint16_t> McapWriter::Add(const Topic& topic) {
  for (std::size_t i = 0; i < contents_.channels.size(); ++i)
    if (contents_.channels[i].topic.name == topic.name && contents_.channels[i].topic.type == topic.type)
      return static_cast<std::uint16_t>(i);
  if (contents_.channels.size() >= kChannelsMax)
    return Fail(ErrorCode::kBusy, "more than " + std::to_string(kChannelsMax) + " topics in one bag",
                "Record fewer at once.");
  contents_.channels.push_back({topic});
  return static_cast<std::uint16_t>(contents_.channels.size() - 1);
}

// What a chunk needs of a channel stands in it once.
Status McapWriter::Write(std::uint16_t channel, std::int64_t log_ns, std::int64_t publish_ns, Bytes message) {
  if (failed_) return Fail(*failed_);
  if (!chunk_.index.contains(channel)) {
    chunk_.records.Record(McapOp::kSchema, SchemaContent(contents_, channel));
    chunk_.records.Record(McapOp::kChannel, ChannelContent(contents_, channel));
  }
  const auto at_ns = static_cast<std::uint64_t>(std::max<std::int64_t>(log_ns, 0));
  chunk_.start_ns = chunk_.messages == 0 ? at_ns : std::min(chunk_.start_ns, at_ns);
  chunk_.end_ns = chunk_.messages == 0 ? at_ns : std::max(chunk_.end_ns, at_ns);
  std::vector<Indexed>& indexed = chunk_.index[channel];
  indexed.push_back({at_ns, chunk_.records.size()});
  McapBytes head;
  head.Number(channel);
  head.Number(static_cast<std::uint32_t>(contents_.channels[channel].messages + indexed.size() - 1));
  head.Number(at_ns);
  head.Number(static_cast<std::uint64_t>(std::max<std::int64_t>(publish_ns, 0)));
  chunk_.records.Number(McapOp::kMessage);
  chunk_.records.Number<std::uint64_t>(head.size() + message.size());
  chunk_.records.Raw(head.bytes());
  chunk_.records.Raw(message);
  ++chunk_.messages;
  return chunk_.records.size() >= kChunkFrom_bytes ? Flush() : Status();
}

// Behind the chunk, which `out` is: a record for each channel, where its messages are.
McapWrittenChunk McapWriter::IndexChunk(McapBytes& out) const {
  McapWrittenChunk written{chunk_.start_ns, chunk_.end_ns, written_bytes_, out.size(), 0, chunk_.records.size(), {}};
  for (const auto& [channel, rows] : chunk_.index) {
    written.index_offsets[channel] = written_bytes_ + out.size();
    McapBytes content;
    content.Number(channel);
    content.Number(static_cast<std::uint32_t>(rows.size() * sizeof(Indexed)));
    for (const Indexed& row : rows) {
      content.Number(row.log_ns);
      content.Number(row.offset);
    }
    out.Record(McapOp::kMessageIndex, content);
  }
  written.index_length = out.size() - written.length;
  return written;
}

Status McapWriter::Flush() {
  if (failed_) return Fail(*failed_);
  if (chunk_.messages == 0) return {};
  const McapBytes head = ChunkHead(chunk_.start_ns, chunk_.end_ns, chunk_.records.bytes());
  McapBytes out;
  out.Number(McapOp::kChunk);
  out.Number<std::uint64_t>(head.size() + chunk_.records.size());
  out.Raw(head.bytes());
  out.Raw(chunk_.records.bytes());
  McapWrittenChunk written = IndexChunk(out);
  RIGCAL_TRY(Append(out));
  for (const auto& [channel, rows] : chunk_.index) contents_.channels[channel].messages += rows.size();
  contents_.chunks.push_back(std::move(written));
  chunk_ = {};
  return {};
}

Status McapWriter::Close() {
  RIGCAL_TRY(Flush());
  McapBytes out, content;
  content.Number<std::uint32_t>(0);  // no checksum of all data
  out.Record(McapOp::kDataEnd, content);
  out.Raw(SummaryRecords(contents_, written_bytes_ + out.size()).bytes());
  RIGCAL_TRY(Append(out));
  if (fsync(file_.get()) != 0) failed_ = FileFailure(path_, "be written", errno).value();
  if (!failed_ && !file_.Close()) failed_ = FileFailure(path_, "be closed", errno).value();
  if (failed_) return Fail(*failed_);
  return SyncFolder(path_.has_parent_path() ? path_.parent_path() : ".");
}

}  // namespace rigcal::bags
