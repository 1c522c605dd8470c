// What the cloud formats have in common: a table of numbers, a row per point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"
#include "server/model/sensors/cloud.h"

namespace rigcal::formats {

enum class Scalar { kInt8, kInt16, kInt32, kInt64, kUint8, kUint16, kUint32, kUint64, kFloat32, kFloat64 };
[[nodiscard]] std::size_t SizeOf(Scalar type);  // in bytes
enum class ByteOrder { kLittle, kBig };

// One number of every point. In bytes it stands at start + i * step for point i; in text it is word `word_idx` of a
// line.
struct CloudColumn {
  std::string name;
  Scalar type = Scalar::kFloat32;
  std::size_t start_bytes = 0, step_bytes = 0;
  std::size_t word_idx = 0;
};

struct CloudTable {
  std::string file;  // named in errors
  std::size_t points = 0;
  std::size_t words_per_line = 0;  // columns and padding
  std::size_t point_bytes = 0;     // columns and padding
  std::vector<CloudColumn> columns;
};

// 'file "a.pcd": <what>'.
[[nodiscard]] tl::unexpected<Error> RefuseCloud(const std::string& file, const std::string& what, std::string cure);

// x y z are there as float or double, no name twice or unprintable, everything within limits.h.
[[nodiscard]] Status CheckTable(const CloudTable& table);

// The body is refused if it is shorter than the table. `is_last`: nothing follows the table, so what has room for
// another point and is not all zeros (some writers append a page of those) is refused as well.
[[nodiscard]] Status CheckBinarySize(const CloudTable& table, std::string_view body, bool is_last);

// Tables that passed CheckTable; the body has every byte that a column refers to.
[[nodiscard]] Result<Cloud> CloudOfBinary(const CloudTable& table, std::span<const std::byte> body, ByteOrder order);
// A line per point; `line` is the number of the line that `body` starts with. Blank lines are skipped.
[[nodiscard]] Result<Cloud> CloudOfText(const CloudTable& table, std::string_view body, std::size_t line, bool is_last);

}  // namespace rigcal::formats
