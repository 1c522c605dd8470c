#include "client/bags/mcap/mcap_walk.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "client/bags/cursor.h"
#include "client/bags/limits.h"
#include "client/bags/unpack.h"
#include "server/base/text.h"

namespace rigcal::bags {
namespace {

constexpr std::array<unsigned char, 8> kMagic = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
constexpr std::size_t kVersionIdx = 5;
constexpr std::uint64_t kRecordHeadBytes = 9;  // opcode, length
constexpr const char* kCure = "What could be read is given; record the bag again, or mend it with `mcap recover`.";

std::uint32_t CrcOf(Bytes bytes, std::uint32_t so_far = 0) {
  return static_cast<std::uint32_t>(crc32_z(so_far, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

Status CheckMagic(ByteSource& source) {
  std::array<std::byte, kMagic.size()> begins{};
  RIGCAL_ASSIGN(const std::size_t got, source.ReadAt(0, begins));
  if (got == 0) return Fail(ErrorCode::kInvalidInput, source.name() + " is empty", "Record the bag again.");
  if (std::memcmp(begins.data(), kMagic.data(), std::min(got, kVersionIdx)) != 0 || got < kMagic.size())
    return Fail(ErrorCode::kInvalidInput, source.name() + " is no MCAP file: it does not begin as one",
                "Give the path of a bag.");
  if (std::memcmp(begins.data(), kMagic.data(), kMagic.size()) == 0) return {};
  return Fail(ErrorCode::kUnsupported,
              source.name() + " is an MCAP file of version " + Quoted(TextOf(Bytes(begins).subspan(kVersionIdx, 1))) +
                  ", not 0",
              "Convert it to version 0.");
}

}  // namespace

Result<McapWalk> McapWalk::Begin(std::unique_ptr<ByteSource> source) {
  RIGCAL_TRY(CheckMagic(*source));
  McapWalk walk(std::move(source));
  walk.at_ = kMagic.size();
  return walk;
}

std::optional<McapRecord> McapWalk::Next() {
  while (!over_) {
    if (chunk_ && !chunk_->in_file) {
      if (auto record = NextOfUnpacked()) return record;
      LeaveChunk();
      continue;
    }
    if (chunk_ && at_ >= chunk_->end) {
      LeaveChunk();
      continue;
    }
    if (auto record = NextOfFile()) return record;
  }
  return std::nullopt;
}

// Nothing: a chunk was entered, something lost, or the walk is over; Next() looks which.
std::optional<McapRecord> McapWalk::NextOfFile() {
  const std::uint64_t offset = at_, size = source_->size(), end = chunk_ ? chunk_->end : size;
  const auto head = Read(offset, kRecordHeadBytes);
  if (!head || end - offset < kRecordHeadBytes) {
    if (!head) damage_.Add(head.error());
    if (head && (chunk_ || !closed_) && offset < size) Lose(offset, "ends within a record");
    if (chunk_) {
      at_ = end;
      chunk_->trouble.reset();  // it is told
      chunk_->crc = 0;
    }
    over_ = over_ || !chunk_ || !head;
    return std::nullopt;
  }
  Cursor in(*head);
  const auto op = static_cast<McapOp>(in.Number<std::uint8_t>());
  const auto length = in.Number<std::uint64_t>();
  const std::uint64_t content_at = offset + kRecordHeadBytes, there = end - content_at;
  if (chunk_) chunk_->crc_so_far = CrcOf(*head, chunk_->crc_so_far);
  if (op == McapOp::kChunk && !chunk_) {
    if (!EnterChunk(content_at, length)) over_ = !SkipToIndexedChunk(offset);
    return std::nullopt;
  }
  if (length > there || length > limits::kRecordBytesMax) {
    Lose(offset, length > there ? NameOf(op) + " of " + std::to_string(length) + " bytes, of which " +
                                      std::to_string(there) + " are there"
                                : NameOf(op) + " of " + std::to_string(length) + " bytes is beyond the limit of " +
                                      std::to_string(limits::kRecordBytesMax));
    at_ = length > there ? end : content_at + length;
    if (length > there) over_ = !SkipToIndexedChunk(chunk_ ? chunk_->offset : offset);
    return std::nullopt;
  }
  const auto content = Read(content_at, length);
  if (!content) {
    damage_.Add(content.error());
    over_ = true;
    return std::nullopt;
  }
  if (chunk_) chunk_->crc_so_far = CrcOf(*content, chunk_->crc_so_far);
  at_ = content_at + length;
  closed_ = closed_ || op == McapOp::kFooter;
  over_ = over_ || op == McapOp::kFooter;
  return McapRecord{op, *content, chunk_ ? chunk_->offset : offset};
}

std::optional<McapRecord> McapWalk::NextOfUnpacked() {
  Cursor in(Bytes(chunk_->unpacked).subspan(chunk_->read));
  if (in.AtEnd()) return std::nullopt;
  const auto op = static_cast<McapOp>(in.Number<std::uint8_t>());
  const Bytes content = in.Bytes(in.Number<std::uint64_t>());
  if (in.failed()) {
    if (!chunk_->trouble) chunk_->trouble = "its last record is not whole";
    return std::nullopt;
  }
  chunk_->read = chunk_->unpacked.size() - in.rest().size();
  return McapRecord{op, content, chunk_->offset};
}

// False: nothing of it can be read.
bool McapWalk::EnterChunk(std::uint64_t content_at, std::uint64_t length) {
  const std::uint64_t offset = content_at - kRecordHeadBytes, there = std::min(length, source_->size() - content_at);
  const auto head = Read(content_at, std::min<std::uint64_t>(there, kChunkHeadBytesMax));
  if (!head) {
    damage_.Add(head.error());
    return false;
  }
  const auto chunk = ReadMcapChunk(*head);
  if (!chunk || (there == length && chunk->packed_bytes != length - chunk->head_bytes)) {
    Lose(offset, there < length ? "it ends within the chunk" : "the chunk contradicts itself");
    at_ = content_at + length;
    return there == length && length <= source_->size() && chunk.has_value();
  }
  const auto packing = PackingOf(chunk->packing);
  chunk_.emplace();
  chunk_->offset = offset;
  chunk_->crc = chunk->crc;
  if (there < length)
    chunk_->trouble = "the file ends within it, " + std::to_string(length - there) + " bytes are missing";
  if (packing == Packing::kNone) {
    chunk_->in_file = true;
    at_ = content_at + chunk->head_bytes;
    chunk_->end = content_at + there;
    return true;
  }
  at_ = content_at + there;
  if (!packing || packing == Packing::kBz2) {
    chunk_->trouble = "it is compressed with " + Quoted(chunk->packing) + ", which is neither lz4 nor zstd";
    return true;
  }
  return UnpackChunk(*chunk, content_at + chunk->head_bytes, there - chunk->head_bytes);
}

bool McapWalk::UnpackChunk(const McapChunk& chunk, std::uint64_t records_at, std::uint64_t there) {
  const Packing packing = *PackingOf(chunk.packing);  // before its head is read over
  if (there > limits::kRecordBytesMax || chunk.unpacked_bytes > limits::kChunkBytesMax) {
    chunk_->trouble = "it has " + std::to_string(std::max(there, chunk.unpacked_bytes)) + " bytes; the limit is " +
                      std::to_string(limits::kChunkBytesMax);
    return true;
  }
  const auto packed = Read(records_at, there);
  if (!packed) {
    damage_.Add(packed.error());
    over_ = true;
    return true;
  }
  Unpacked unpacked = Unpack(packing, *packed, limits::kChunkBytesMax);
  if (unpacked.trouble && !chunk_->trouble) chunk_->trouble = unpacked.trouble;
  if (!chunk_->trouble && unpacked.bytes.size() != chunk.unpacked_bytes)
    chunk_->trouble = "it unpacks to " + std::to_string(unpacked.bytes.size()) + " bytes, not " +
                      std::to_string(chunk.unpacked_bytes);
  chunk_->unpacked = std::move(unpacked.bytes);
  if (chunk.crc != 0) chunk_->crc_so_far = CrcOf(chunk_->unpacked);
  return true;
}

void McapWalk::LeaveChunk() {
  if (!chunk_->trouble && chunk_->crc != 0 && chunk_->crc != chunk_->crc_so_far)
    chunk_->trouble = "its checksum is wrong, so that its messages may be";
  if (chunk_->trouble) Lose(chunk_->offset, "of the chunk there not all can be relied on: " + *chunk_->trouble);
  chunk_.reset();
}

Result<Bytes> McapWalk::Read(std::uint64_t offset, std::uint64_t count) {
  if (count > buffer_.size()) buffer_.resize(static_cast<std::size_t>(count));
  RIGCAL_ASSIGN(const std::size_t got,
                source_->ReadAt(offset, std::span(buffer_).first(static_cast<std::size_t>(count))));
  return Bytes(buffer_).first(got);
}

void McapWalk::Lose(std::uint64_t offset, const std::string& what) {
  damage_.Add({ErrorCode::kInvalidInput, source_->name() + " at byte " + std::to_string(offset) + ": " + what, kCure});
}

// Whether there is one behind `after` to go on at.
bool McapWalk::SkipToIndexedChunk(std::uint64_t after) {
  if (!indexed_) indexed_ = IndexedChunks(*source_);
  const auto next = std::upper_bound(indexed_->begin(), indexed_->end(), after);
  if (next == indexed_->end()) return false;
  if (chunk_) LeaveChunk();
  at_ = *next;
  return true;
}

}  // namespace rigcal::bags
