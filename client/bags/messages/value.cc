#include "client/bags/messages/value.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace rigcal::bags {
namespace {

template <typename T>
double NumberAt(const std::byte* from, bool swapped) {
  std::byte bytes[sizeof(T)];
  std::memcpy(bytes, from, sizeof(T));
  if (swapped) std::reverse(bytes, bytes + sizeof(T));
  T number;
  std::memcpy(&number, bytes, sizeof(T));
  return static_cast<double>(number);
}

double NumberOf(Primitive primitive, const std::byte* from, bool swapped) {
  switch (primitive) {
    case Primitive::kBool:
    case Primitive::kUint8:
      return NumberAt<std::uint8_t>(from, swapped);
    case Primitive::kInt8:
      return NumberAt<std::int8_t>(from, swapped);
    case Primitive::kInt16:
      return NumberAt<std::int16_t>(from, swapped);
    case Primitive::kUint16:
      return NumberAt<std::uint16_t>(from, swapped);
    case Primitive::kInt32:
      return NumberAt<std::int32_t>(from, swapped);
    case Primitive::kUint32:
      return NumberAt<std::uint32_t>(from, swapped);
    case Primitive::kInt64:
      return NumberAt<std::int64_t>(from, swapped);
    case Primitive::kUint64:
      return NumberAt<std::uint64_t>(from, swapped);
    case Primitive::kFloat32:
      return NumberAt<float>(from, swapped);
    case Primitive::kFloat64:
      return NumberAt<double>(from, swapped);
    case Primitive::kString:
    case Primitive::kWstring:
    case Primitive::kMessage:
      break;
  }
  return 0;
}

bool Same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

const Value& Value::operator[](std::string_view name) const {
  static const Value kNone;
  if (kind_ != Kind::kMessage) return kNone;
  for (std::size_t i = 0; i < items_.size(); ++i)
    if (type_->fields[i].name == name) return items_[i];
  return kNone;
}

const Value& Value::Either(std::string_view name, std::string_view other) const {
  const Value& first = (*this)[name];
  return first.IsAbsent() ? (*this)[other] : first;
}

double Value::Real(double fallback) const {
  if (kind_ == Kind::kReal) return real_;
  return kind_ == Kind::kInteger ? static_cast<double>(integer_) : fallback;
}

std::int64_t Value::Integer(std::int64_t fallback) const { return kind_ == Kind::kInteger ? integer_ : fallback; }

double Value::RealAt(std::size_t idx) const {
  if (kind_ != Kind::kNumbers || idx >= count_) return 0;
  return NumberOf(primitive_, bytes_.data() + idx * SizeOf(primitive_), swapped_);
}

bool Value::SameAs(const Value& other) const {
  if (kind_ != other.kind_ || integer_ != other.integer_ || !Same(real_, other.real_) || text_ != other.text_)
    return false;
  if (count_ != other.count_ || items_.size() != other.items_.size()) return false;
  if (kind_ == Kind::kMessage && type_->name != other.type_->name) return false;
  for (std::size_t i = 0; i < items_.size(); ++i) {
    if (kind_ == Kind::kMessage && type_->fields[i].name != other.type_->fields[i].name) return false;
    if (!items_[i].SameAs(other.items_[i])) return false;
  }
  for (std::size_t i = 0; kind_ == Kind::kNumbers && i < count_; ++i)
    if (!Same(RealAt(i), other.RealAt(i))) return false;
  return true;
}

}  // namespace rigcal::bags
