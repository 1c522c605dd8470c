// CDR (OMG DDSI-RTPS, XCDR1 without parameter lists) and ROS 1's serialisation differ in three things: CDR has a head
// that says the byte order, aligns each number to its own size, and gives a text a zero at its end and an empty message
// a byte.
#include <algorithm>
#include <cstring>
#include <limits>

#include "client/bags/cursor.h"
#include "client/bags/limits.h"
#include "client/bags/messages/value.h"
#include "server/base/text.h"

namespace rigcal::bags {

class Decoder {
 public:
  Decoder(Bytes bytes, bool is_cdr, bool swapped) : bytes_(bytes), is_cdr_(is_cdr), swapped_(swapped) {}

  Result<Value> Message(const MessageType& type, std::size_t fields_max = SIZE_MAX) {
    Value value;
    value.kind_ = Value::Kind::kMessage;
    value.type_ = &type;
    RIGCAL_TRY(CountOne());
    if (type.fields.empty() && is_cdr_) RIGCAL_TRY(Take(1, 1));
    const std::size_t count = std::min(fields_max, type.fields.size());
    value.items_.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      auto item = Field(type.fields[i]);
      if (!item) return item;
      value.items_.push_back(*std::move(item));
    }
    return value;
  }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

 private:
  static constexpr std::size_t kReservedMax = 1024;  // elements, before they are seen

  Result<Value> Field(const FieldType& field) {
    if (field.arity == Arity::kOne) return One(field);
    std::size_t count = field.count;
    if (field.arity == Arity::kSequence) {
      RIGCAL_ASSIGN(count, Count());
      if (field.count_max > 0 && count > field.count_max)
        return Bad(Quoted(field.name) + " has " + std::to_string(count) + " elements, not at most " +
                   std::to_string(field.count_max));
    }
    return SizeOf(field.primitive) > 0 ? Numbers(field, count) : List(field, count);
  }

  Result<Value> One(const FieldType& field) {
    if (field.primitive == Primitive::kMessage) return Message(*field.type);
    RIGCAL_TRY(CountOne());
    if (field.primitive == Primitive::kString) return Text();
    if (field.primitive == Primitive::kWstring) return Bad("it has a wstring, of which vendors write different bytes");
    const std::size_t size = SizeOf(field.primitive);
    RIGCAL_ASSIGN(const Bytes taken, Take(size, size));
    return Number(field.primitive, taken);
  }

  Result<Value> Number(Primitive primitive, Bytes taken) const {
    Value value = Plain(Value::Kind::kNumbers, primitive);
    value.bytes_ = taken;
    value.count_ = 1;
    if (primitive == Primitive::kUint64 || primitive == Primitive::kInt64) {
      value.integer_ = Integer64(primitive, taken);
    } else {
      value.real_ = value.RealAt(0);
      value.integer_ = IsReal(primitive) ? 0 : static_cast<std::int64_t>(value.real_);
    }
    if (!IsReal(primitive)) value.real_ = 0;
    if (primitive == Primitive::kBool) value.integer_ = value.integer_ != 0 ? 1 : 0;
    value.kind_ = IsReal(primitive) ? Value::Kind::kReal : Value::Kind::kInteger;
    value.bytes_ = {};
    value.count_ = 0;
    return value;
  }
  static bool IsReal(Primitive primitive) {
    return primitive == Primitive::kFloat32 || primitive == Primitive::kFloat64;
  }
  [[nodiscard]] std::int64_t Integer64(Primitive primitive, Bytes taken) const {
    std::uint64_t bits = 0;
    std::memcpy(&bits, taken.data(), sizeof bits);
    if (swapped_) bits = __builtin_bswap64(bits);
    constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
    return static_cast<std::int64_t>(primitive == Primitive::kUint64 ? std::min(bits, kMost) : bits);
  }

  Result<Value> Text() {
    RIGCAL_ASSIGN(const std::size_t size, Count());
    RIGCAL_ASSIGN(const Bytes taken, Take(size, 1));
    Value value = Plain(Value::Kind::kText, Primitive::kString);
    value.text_ = TextOf(taken);
    if (is_cdr_ && !value.text_.empty() && value.text_.back() == '\0') value.text_.remove_suffix(1);
    return value;
  }

  Result<Value> Numbers(const FieldType& field, std::size_t count) {
    RIGCAL_TRY(CountOne());
    const std::size_t size = SizeOf(field.primitive);
    Value value = Plain(Value::Kind::kNumbers, field.primitive);
    if (count == 0) return value;
    if (count > left() / size)
      return Bad(Quoted(field.name) + " claims " + std::to_string(count) + " elements, which are not there");
    RIGCAL_ASSIGN(value.bytes_, Take(count * size, size));
    value.count_ = count;
    return value;
  }

  Result<Value> List(const FieldType& field, std::size_t count) {
    RIGCAL_TRY(CountOne());
    Value value = Plain(Value::Kind::kList, field.primitive);
    value.items_.reserve(std::min({count, left() / 4, kReservedMax}));
    for (std::size_t i = 0; i < count; ++i) {
      auto item = One(field);
      if (!item) return item;
      value.items_.push_back(*std::move(item));
    }
    return value;
  }

  [[nodiscard]] Value Plain(Value::Kind kind, Primitive primitive) const {
    Value value;
    value.kind_ = kind;
    value.primitive_ = primitive;
    value.swapped_ = swapped_;
    return value;
  }
  Result<std::size_t> Count() {
    RIGCAL_ASSIGN(const Bytes taken, Take(4, 4));
    std::uint32_t count = 0;
    std::memcpy(&count, taken.data(), sizeof count);
    return std::size_t{swapped_ ? __builtin_bswap32(count) : count};
  }
  Result<Bytes> Take(std::size_t size, std::size_t alignment) {
    const std::size_t padding = is_cdr_ ? (alignment - at_ % alignment) % alignment : 0;
    if (padding > left() || size > left() - padding)
      return Bad("it ends within a field, " + std::to_string(left()) + " bytes before its end");
    at_ += padding + size;
    return bytes_.subspan(at_ - size, size);
  }
  Status CountOne() {
    if (++values_ <= limits::kValuesMax) return {};
    return Bad("it has more than " + std::to_string(limits::kValuesMax) + " values");
  }
  static tl::unexpected<Error> Bad(std::string what) {
    return Fail(ErrorCode::kInvalidInput, std::move(what),
                "The message is left out; record it again with its right definition.");
  }

  Bytes bytes_;
  bool is_cdr_, swapped_;
  std::size_t at_ = 0, values_ = 0;
};

namespace {

constexpr std::size_t kCdrHeadBytes = 4;
constexpr std::size_t kPaddingMax = 7;  // that serialisers leave behind a message

Result<Decoder> BeginCdr(Bytes bytes) {
  constexpr const char* kCure = "The message is left out; let the recorder write plain CDR.";
  if (bytes.size() < kCdrHeadBytes)
    return Fail(ErrorCode::kInvalidInput, "its " + std::to_string(bytes.size()) + " bytes are no CDR message", kCure);
  const unsigned kind = static_cast<unsigned>(bytes[0]) * 256 + static_cast<unsigned>(bytes[1]);
  if (kind > 1) {
    const std::string name = kind <= 3                 ? "PL_CDR, a list of parameters"
                             : kind >= 6 && kind <= 11 ? "XCDR2"
                                                       : "an unknown encoding";
    return Fail(ErrorCode::kUnsupported,
                "it is written as " + name + " (" + std::to_string(kind) + "), which is not read", kCure);
  }
  return Decoder(bytes.subspan(kCdrHeadBytes), true, kind == 0);
}

Result<Value> DecodeBytes(const Topic& topic, const Definition& definition, Bytes bytes, std::size_t fields_max) {
  const bool is_cdr = topic.encoding == "cdr";
  if (!is_cdr && topic.encoding != "ros1")
    return Fail(ErrorCode::kUnsupported,
                "it is encoded as " + Quoted(topic.encoding) + ", which is neither cdr nor ros1",
                "The topic is left out.");
  Decoder decoder(bytes, false, false);
  if (is_cdr) {
    RIGCAL_ASSIGN(decoder, BeginCdr(bytes));
  }
  auto value = decoder.Message(*definition.root, fields_max);
  if (!value || fields_max != SIZE_MAX || decoder.left() <= (is_cdr ? kPaddingMax : 0)) return value;
  return Fail(ErrorCode::kInvalidInput,
              "it has " + std::to_string(decoder.left()) + " bytes more than its definition says",
              "The message is left out; record it again with its right definition.");
}

}  // namespace

Result<Value> Decode(const Topic& topic, const Definition& definition, Bytes bytes, std::size_t fields_max) {
  auto value = DecodeBytes(topic, definition, bytes, fields_max);
  if (value) return value;
  return Fail(value.error().code, "a message of " + Quoted(topic.name) + ": " + value.error().what, value.error().cure);
}

}  // namespace rigcal::bags
