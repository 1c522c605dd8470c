#include <lzf.h>

#include <cstring>

#include "server/base/limits.h"
#include "server/formats/clouds/cloud_decoders.h"
#include "server/formats/clouds/cloud_table.h"
#include "server/formats/clouds/pcd_header.h"

namespace rigcal::formats {
namespace {

constexpr const char* kDamagedCure = "The file is damaged: copy or save it again.";
// LZF's longest reference takes 3 bytes and stands for 264.
constexpr std::size_t kLzfRatioMax = 88;

// Bytes and words of a point.
void Measure(const PcdHeader& header, CloudTable& table) {
  for (const PcdField& field : header.fields) {
    table.point_bytes += SizeOf(field.type) * field.count;
    table.words_per_line += field.count;
  }
}

// The columns of a field whose first value stands at `start_bytes`.
Status AddColumns(const PcdField& field, std::size_t start_bytes, std::size_t step_bytes, std::size_t word_idx,
                  CloudTable& table) {
  if (field.name == "_") return {};
  if (table.columns.size() + field.count > limits::kCloudFieldsMax)
    return RefuseCloud(table.file, "a point has more than " + std::to_string(limits::kCloudFieldsMax) + " values",
                       "Leave fields out that no calibration needs.");
  for (std::size_t k = 0; k < field.count; ++k) {
    const std::string name = field.count == 1 ? field.name : field.name + "_" + std::to_string(k);
    table.columns.push_back({name, field.type, start_bytes + k * SizeOf(field.type), step_bytes, word_idx + k});
  }
  return {};
}

// A compressed body has all points' values of the first field, then all of the second, ...
Result<CloudTable> TableOf(const PcdHeader& header, const std::string& name) {
  CloudTable table{name, header.points, 0, 0, {}};
  if (table.points > limits::kCloudPointsMax) return Fail(CheckTable(table).error());
  Measure(header, table);
  const bool by_field = header.body == PcdBody::kBinaryCompressed;
  std::size_t start_bytes = 0, word_idx = 0;
  for (const PcdField& field : header.fields) {
    const std::size_t field_bytes = SizeOf(field.type) * field.count;
    RIGCAL_TRY(AddColumns(field, start_bytes, by_field ? field_bytes : table.point_bytes, word_idx, table));
    start_bytes += field_bytes * (by_field ? table.points : 1);
    word_idx += field.count;
  }
  RIGCAL_TRY(CheckTable(table));
  return table;
}

std::size_t SizeAt(std::string_view body, std::size_t offset_bytes) {
  std::uint32_t size = 0;
  std::memcpy(&size, body.data() + offset_bytes, sizeof size);
  return size;
}

// Sizes first, as the file claims them; only what holds is allocated.
Status CheckCompressed(const CloudTable& table, std::string_view body) {
  constexpr std::size_t kSizesBytes = 8;
  if (body.size() < kSizesBytes)
    return RefuseCloud(table.file, "ends before the sizes of its compressed body", kDamagedCure);
  const std::size_t packed = SizeAt(body, 0), plain = SizeAt(body, 4), rest = body.size() - kSizesBytes;
  if (packed > rest)
    return RefuseCloud(table.file,
                       "its compressed body has " + std::to_string(rest) + " of " + std::to_string(packed) + " bytes",
                       kDamagedCure);
  if (plain != table.points * table.point_bytes)
    return RefuseCloud(table.file,
                       "its compressed body claims to hold " + std::to_string(plain) + " bytes, but its " +
                           std::to_string(table.points) + " points take " +
                           std::to_string(table.points * table.point_bytes),
                       kDamagedCure);
  if (plain > static_cast<std::size_t>(limits::kPayloadBytesMax) || plain > packed * kLzfRatioMax)
    return RefuseCloud(table.file, std::to_string(packed) + " compressed bytes cannot hold " + std::to_string(plain),
                       kDamagedCure);
  return {};
}

Result<Cloud> CloudOfCompressed(const CloudTable& table, std::string_view body) {
  RIGCAL_TRY(CheckCompressed(table, body));
  const std::size_t packed = SizeAt(body, 0);
  std::vector<std::byte> plain(SizeAt(body, 4));
  const unsigned size =
      lzf_decompress(body.data() + 8, static_cast<unsigned>(packed), plain.data(), static_cast<unsigned>(plain.size()));
  if (size != plain.size()) return RefuseCloud(table.file, "its compressed body cannot be unpacked", kDamagedCure);
  return CloudOfBinary(table, plain, ByteOrder::kLittle);
}

}  // namespace

Result<Cloud> ReadPcd(std::string_view bytes, const std::string& name) {
  RIGCAL_ASSIGN(const PcdHeader header, ReadPcdHeader(bytes, name));
  RIGCAL_ASSIGN(const CloudTable table, TableOf(header, name));
  const std::string_view body = bytes.substr(header.body_offset_bytes);
  if (header.body == PcdBody::kAscii) return CloudOfText(table, body, header.body_line, true);
  if (header.body == PcdBody::kBinaryCompressed) return CloudOfCompressed(table, body);
  RIGCAL_TRY(CheckBinarySize(table, body, true));
  return CloudOfBinary(table, std::as_bytes(std::span(body)), ByteOrder::kLittle);
}

}  // namespace rigcal::formats
