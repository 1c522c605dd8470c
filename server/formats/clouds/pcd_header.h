// The header of a PCD file, 0.5 to 0.7.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "server/formats/clouds/cloud_table.h"

namespace rigcal::formats {

struct PcdField {
  std::string name;  // "_": padding
  Scalar type = Scalar::kFloat32;
  std::size_t count = 1;
};
enum class PcdBody { kAscii, kBinary, kBinaryCompressed };

struct PcdHeader {
  std::vector<PcdField> fields;  // of at most kPcdCountMax values each
  std::size_t points = 0;
  PcdBody body = PcdBody::kAscii;
  std::size_t body_offset_bytes = 0, body_line = 1;  // where the body begins
};

constexpr std::size_t kPcdCountMax = 1 << 16;

// Every key at most once, in any order up to DATA; VERSION, COUNT, HEIGHT and one of WIDTH and POINTS may be absent;
// what is there must agree. VIEWPOINT is not looked at.
[[nodiscard]] Result<PcdHeader> ReadPcdHeader(std::string_view bytes, const std::string& name);

}  // namespace rigcal::formats
