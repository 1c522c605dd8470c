#include "server/model/field_hash.h"

#include <array>
#include <bit>

namespace rigcal {
namespace {

bool IsNegated(const Eigen::Quaterniond& q) {
  for (double part : {q.w(), q.x(), q.y(), q.z()})
    if (part != 0.0) return part < 0.0;
  return false;
}

}  // namespace

FieldHash& FieldHash::Text(std::string_view text) {
  Number(text.size());
  sha_.Add(text);
  return *this;
}

FieldHash& FieldHash::Number(std::uint64_t number) {
  std::array<std::byte, 8> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>((number >> (8 * i)) & 0xff);
  sha_.Add(bytes);
  return *this;
}

FieldHash& FieldHash::Real(double value) { return Number(std::bit_cast<std::uint64_t>(value == 0.0 ? 0.0 : value)); }

FieldHash& FieldHash::Pose(const Se3& T) {
  for (double value : T.p_m) Real(value);
  const double sign = IsNegated(T.q) ? -1.0 : 1.0;
  for (double value : T.q.coeffs()) Real(sign * value);
  return *this;
}

FieldHash& FieldHash::Vector(const Vector6d& vector) {
  for (double value : vector) Real(value);
  return *this;
}

FieldHash& FieldHash::Matrix(const Matrix6d& matrix) {
  for (int row = 0; row < 6; ++row) Vector(matrix.row(row).transpose());
  return *this;
}

}  // namespace rigcal
