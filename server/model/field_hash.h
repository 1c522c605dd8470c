// sha256 over a list of fields, such that different lists are different bytes:
//   text    uint64 little-endian length, then the bytes
//   number  uint64 little-endian
//   real    the 64 bits of the IEEE double, little-endian; -0.0 counts as 0.0
// A list begins with the text that names its kind ("rigcal edge content 1"), so that no two kinds can collide.
#pragma once

#include <cstdint>
#include <string_view>

#include "server/base/digests/sha256.h"
#include "server/math/se3.h"

namespace rigcal {

class FieldHash {
 public:
  // `kind` keeps apart things of different kinds whose fields are the same.
  explicit FieldHash(std::string_view kind) { Text(kind); }
  // Length in bytes, then the bytes.
  FieldHash& Text(std::string_view text);
  // 8 bytes, the least first.
  FieldHash& Number(std::uint64_t number);
  // The bits of the number; -0 counts as 0.
  FieldHash& Real(double value);
  // p_m, then q_xyzw with the sign that makes w >= 0 (at w = 0: the first of x y z that is not zero is positive).
  FieldHash& Pose(const Se3& T);
  // 6 reals.
  FieldHash& Vector(const Vector6d& vector);
  // 36 reals, row by row.
  FieldHash& Matrix(const Matrix6d& matrix);
  [[nodiscard]] Digest Finish() { return sha_.Finish(); }

 private:
  Sha256 sha_;
};

}  // namespace rigcal
