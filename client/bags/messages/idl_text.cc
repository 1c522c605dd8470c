// The part of OMG IDL that ROS 2 writes: modules, structs, typedefs of arrays, enumerations, constants.
#include <optional>

#include "client/bags/limits.h"
#include "client/bags/messages/definition.h"
#include "client/bags/messages/idl_tokens.h"
#include "server/base/number_text.h"
#include "server/base/text.h"

namespace rigcal::bags {
namespace {

constexpr const char* kCure = "Record the topic again with a definition as .msg text.";

tl::unexpected<Error> Bad(std::string what) { return Fail(ErrorCode::kUnsupported, std::move(what), kCure); }

std::optional<Primitive> PrimitiveOf(std::string_view word) {
  static const std::map<std::string_view, Primitive> kWords = {
      {"boolean", Primitive::kBool},  {"octet", Primitive::kUint8},    {"char", Primitive::kUint8},
      {"int8", Primitive::kInt8},     {"uint8", Primitive::kUint8},    {"short", Primitive::kInt16},
      {"int16", Primitive::kInt16},   {"uint16", Primitive::kUint16},  {"long", Primitive::kInt32},
      {"int32", Primitive::kInt32},   {"uint32", Primitive::kUint32},  {"int64", Primitive::kInt64},
      {"uint64", Primitive::kUint64}, {"float", Primitive::kFloat32},  {"double", Primitive::kFloat64},
      {"string", Primitive::kString}, {"wstring", Primitive::kWstring}};
  const auto found = kWords.find(word);
  return found == kWords.end() ? std::nullopt : std::optional(found->second);
}

class IdlReader {
 public:
  IdlReader(std::vector<std::string_view> tokens, Types& types) : tokens_(std::move(tokens)), types_(types) {}

  Status Read() {
    while (!AtEnd()) RIGCAL_TRY(ReadOne());
    return {};
  }

 private:
  Status ReadOne() {
    const std::string_view word = Take();
    if (word == "module") return EnterModule();
    if (word == "}") return LeaveModule();
    if (word == ";") return {};
    if (word == "const") return SkipPast(";");
    if (word == "typedef") return ReadTypedef();
    if (word == "enum") return ReadEnum();
    if (word == "struct") return ReadStruct();
    return Bad("the IDL has " + Quoted(word) + ", which is not read");
  }

  Status EnterModule() {
    if (modules_.size() >= limits::kNestingMax)
      return Bad("the IDL's modules are nested deeper than " + std::to_string(limits::kNestingMax));
    modules_.emplace_back(Take());
    return Expect("{");
  }
  Status LeaveModule() {
    if (modules_.empty()) return Bad("the IDL has a \"}\" too many");
    modules_.pop_back();
    return {};
  }

  // All names of a package share one scope: "sensor_msgs/Image".
  [[nodiscard]] std::string InScope(std::string_view name) const {
    return (modules_.empty() ? std::string() : modules_.front() + "/") + std::string(name);
  }

  Status ReadTypedef() {
    FieldType field;
    RIGCAL_TRY(ReadType(field));
    RIGCAL_TRY(ReadDeclarator(field));
    aliases_[InScope(field.name)] = field;
    return {};
  }

  Status ReadEnum() {
    FieldType field;
    field.primitive = Primitive::kUint32;
    aliases_[InScope(Take())] = field;
    return SkipPast("}");
  }

  Status ReadStruct() {
    const std::string name = InScope(Take());
    if (Peek() == ":") return Bad("the IDL's struct " + Quoted(name) + " is derived from another, which is not read");
    RIGCAL_TRY(Expect("{"));
    MessageType type{name, {}};
    while (Peek() != "}") {
      if (AtEnd() || ++fields_ > limits::kFieldsMax)
        return Bad("the IDL's struct " + Quoted(name) + " has no end, or too many fields");
      FieldType field;
      RIGCAL_TRY(ReadType(field));
      RIGCAL_TRY(ReadDeclarator(field));
      // What stands in for the field that a struct without any would lack.
      type.fields.push_back(field);
    }
    (void)Take();
    if (types_.size() > limits::kTypesMax) return Bad("more than " + std::to_string(limits::kTypesMax) + " types");
    if (type.fields.size() == 1 && type.fields[0].name == "structure_needs_at_least_one_member") type.fields.clear();
    types_[name] = std::move(type);
    return {};
  }

  Status ReadType(FieldType& field) {
    std::string_view word = Take();
    if (word == "sequence") return ReadSequence(field);
    const bool is_unsigned = word == "unsigned";
    if (is_unsigned) word = Take();
    auto primitive = PrimitiveOf(word);
    if (word == "long" && (Peek() == "long" || Peek() == "double")) {
      if (Take() == "double") return Bad("the IDL has a \"long double\", which is not read");
      primitive = Primitive::kInt64;
    }
    if (primitive && is_unsigned) primitive = UnsignedOf(*primitive);
    if (!primitive) return ReadNamed(word, field);
    field.primitive = *primitive;
    const bool is_text = *primitive == Primitive::kString || *primitive == Primitive::kWstring;
    return is_text && Peek() == "<" ? SkipPast(">") : Status();
  }
  static Primitive UnsignedOf(Primitive primitive) {
    if (primitive == Primitive::kInt16) return Primitive::kUint16;
    if (primitive == Primitive::kInt32) return Primitive::kUint32;
    return primitive == Primitive::kInt64 ? Primitive::kUint64 : primitive;
  }

  Status ReadSequence(FieldType& field) {
    RIGCAL_TRY(Expect("<"));
    RIGCAL_TRY(ReadType(field));
    if (field.arity != Arity::kOne) return Bad("the IDL has a sequence of arrays, which is not read");
    field.arity = Arity::kSequence;
    if (Peek() == ",") {
      (void)Take();
      RIGCAL_ASSIGN(field.count_max, TakeCount());
    }
    return Expect(">");
  }

  Status ReadNamed(std::string_view word, FieldType& field) {
    const std::string scoped = word.find("::") == std::string_view::npos ? InScope(word) : PlainTypeName(word);
    const auto alias = aliases_.find(scoped);
    if (alias != aliases_.end()) {
      field = alias->second;
      return {};
    }
    field.primitive = Primitive::kMessage;
    field.message = scoped;
    return {};
  }

  // The name, "[3]" behind it, ";".
  Status ReadDeclarator(FieldType& field) {
    field.name = Take();
    if (Peek() == "[") {
      (void)Take();
      if (field.arity != Arity::kOne)
        return Bad("the IDL's " + Quoted(field.name) + " is an array of arrays, which is not read");
      field.arity = Arity::kFixed;
      RIGCAL_ASSIGN(field.count, TakeCount());
      RIGCAL_TRY(Expect("]"));
      if (Peek() == "[")
        return Bad("the IDL's " + Quoted(field.name) + " is an array of two dimensions, which is not read");
    }
    return Expect(";");
  }

  [[nodiscard]] bool AtEnd() const { return at_ >= tokens_.size(); }
  [[nodiscard]] std::string_view Peek() const { return AtEnd() ? std::string_view() : tokens_[at_]; }
  std::string_view Take() { return AtEnd() ? std::string_view() : tokens_[at_++]; }
  Status Expect(std::string_view token) {
    const std::string_view got = Take();
    if (got == token) return {};
    return Bad("the IDL has " + Quoted(got) + " in place of " + Quoted(token));
  }
  Status SkipPast(std::string_view token) {
    while (!AtEnd())
      if (Take() == token) return {};
    return Bad("the IDL ends before " + Quoted(token));
  }
  Result<std::size_t> TakeCount() {
    const std::string_view word = Take();
    if (const auto count = NumberIn<std::size_t>(word)) return *count;
    return Bad("the IDL has " + Quoted(word) + " in place of a number");
  }

  std::vector<std::string_view> tokens_;
  Types& types_;
  std::size_t at_ = 0, fields_ = 0;
  std::vector<std::string> modules_;
  std::map<std::string, FieldType> aliases_;
};

}  // namespace

Status ReadIdlText(std::string_view text, Types& types) {
  RIGCAL_ASSIGN(std::vector<std::string_view> tokens, IdlTokens(text));
  return IdlReader(std::move(tokens), types).Read();
}

}  // namespace rigcal::bags
