#include <algorithm>
#include <functional>

#include "client/bags/cursor.h"
#include "client/bags/limits.h"
#include "client/bags/mcap/mcap_walk.h"

namespace rigcal::bags {
namespace {

constexpr std::uint64_t kMagicBytes = 8, kFooterBytes = 9 + 8 + 8 + 4;

std::vector<std::byte> ReadPiece(ByteSource& source, std::uint64_t offset, std::uint64_t count) {
  std::vector<std::byte> bytes(static_cast<std::size_t>(count));
  const auto got = source.ReadAt(offset, bytes);
  bytes.resize(got ? *got : 0);
  return bytes;
}

std::optional<McapFooter> FooterOf(ByteSource& source) {
  if (source.size() < 2 * kMagicBytes + kFooterBytes) return std::nullopt;
  const auto bytes = ReadPiece(source, source.size() - kMagicBytes - kFooterBytes, kFooterBytes);
  Cursor in(bytes);
  const auto op = static_cast<McapOp>(in.Number<std::uint8_t>());
  const Bytes content = in.Bytes(in.Number<std::uint64_t>());
  if (in.failed() || op != McapOp::kFooter) return std::nullopt;
  return ReadMcapFooter(content);
}

// Every record of the summary, if the file has one that can be read.
void ForEachOfSummary(ByteSource& source, const std::function<void(McapOp, Bytes)>& take) {
  const auto footer = FooterOf(source);
  if (!footer) return;
  const std::uint64_t end = source.size() - kMagicBytes - kFooterBytes;
  if (footer->summary_start == 0 || footer->summary_start >= end ||
      end - footer->summary_start > limits::kRecordBytesMax)
    return;
  const auto bytes = ReadPiece(source, footer->summary_start, end - footer->summary_start);
  Cursor in(bytes);
  while (!in.AtEnd()) {
    const auto op = static_cast<McapOp>(in.Number<std::uint8_t>());
    const Bytes content = in.Bytes(in.Number<std::uint64_t>());
    if (!in.failed()) take(op, content);
  }
}

}  // namespace

std::vector<std::uint64_t> IndexedChunks(ByteSource& source) {
  std::vector<std::uint64_t> offsets;
  ForEachOfSummary(source, [&](McapOp op, Bytes content) {
    const auto index = op == McapOp::kChunkIndex ? ReadMcapChunkIndex(content) : std::nullopt;
    if (index && index->offset < source.size()) offsets.push_back(index->offset);
  });
  std::sort(offsets.begin(), offsets.end());
  return offsets;
}

std::optional<McapStatistics> SummaryStatistics(ByteSource& source) {
  std::optional<McapStatistics> statistics;
  ForEachOfSummary(source, [&](McapOp op, Bytes content) {
    if (op == McapOp::kStatistics) statistics = ReadMcapStatistics(content);
  });
  return statistics;
}

}  // namespace rigcal::bags
