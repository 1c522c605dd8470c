// The .msg text of ROS 1 and ROS 2: a field per line, and behind lines of '=' the types that it refers to.
#include <optional>

#include "client/bags/limits.h"
#include "client/bags/messages/definition.h"
#include "server/base/number_text.h"
#include "server/base/text.h"

namespace rigcal::bags {
namespace {

constexpr const char* kCure = "Record the topic again with its right definition.";

tl::unexpected<Error> Bad(std::string what) { return Fail(ErrorCode::kInvalidInput, std::move(what), kCure); }

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && IsBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && IsBlank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view TakeLine(std::string_view& text) {
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

std::string_view TakeWord(std::string_view& line) {
  line = Trimmed(line);
  std::size_t end = 0;
  while (end < line.size() && !IsBlank(line[end])) ++end;
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(end);
  return word;
}

// Of .msg text. `byte` differs between ROS 1 (int8) and ROS 2 (uint8): the bytes are the same, and nothing here asks
// for it.
std::optional<Primitive> PrimitiveOf(std::string_view word) {
  static const std::map<std::string_view, Primitive> kWords = {
      {"bool", Primitive::kBool},       {"byte", Primitive::kUint8},    {"char", Primitive::kUint8},
      {"int8", Primitive::kInt8},       {"uint8", Primitive::kUint8},   {"int16", Primitive::kInt16},
      {"uint16", Primitive::kUint16},   {"int32", Primitive::kInt32},   {"uint32", Primitive::kUint32},
      {"int64", Primitive::kInt64},     {"uint64", Primitive::kUint64}, {"float32", Primitive::kFloat32},
      {"float64", Primitive::kFloat64}, {"string", Primitive::kString}, {"wstring", Primitive::kWstring}};
  const auto found = kWords.find(word);
  return found == kWords.end() ? std::nullopt : std::optional(found->second);
}

// "[]", "[3]", "[<=3]" behind the type's name.
Status ReadArity(std::string_view brackets, FieldType& field) {
  std::string_view inner = brackets.substr(1, brackets.size() - 2);
  field.arity = Arity::kSequence;
  if (inner.empty()) return {};
  const bool is_bound = inner.rfind("<=", 0) == 0;
  if (is_bound) inner.remove_prefix(2);
  const auto count = NumberIn<std::size_t>(inner);
  if (!count) return Bad(Quoted(brackets) + " is no number of elements");
  if (!is_bound) field.arity = Arity::kFixed;
  (is_bound ? field.count_max : field.count) = *count;
  return {};
}

Status ReadType(std::string_view word, FieldType& field) {
  const std::size_t bracket = word.find('[');
  if (bracket != std::string_view::npos) {
    if (word.back() != ']') return Bad(Quoted(word) + " is no type");
    RIGCAL_TRY(ReadArity(word.substr(bracket), field));
    word = word.substr(0, bracket);
  }
  word = word.substr(0, word.find("<="));  // the bound of a string does not change its bytes
  if (word.empty()) return Bad("a field has no type");
  if (const auto primitive = PrimitiveOf(word)) {
    field.primitive = *primitive;
    return {};
  }
  field.primitive = Primitive::kMessage;
  field.message = word == "time"       ? "builtin_interfaces/Time"
                  : word == "duration" ? "builtin_interfaces/Duration"
                                       : std::string(word);
  return {};
}

// Nothing of a constant, a comment, an empty line.
Result<std::optional<FieldType>> ReadField(std::string_view line) {
  line = Trimmed(line.substr(0, line.find('#')));
  if (line.empty()) return std::nullopt;
  FieldType field;
  RIGCAL_TRY(ReadType(TakeWord(line), field));
  line = Trimmed(line);
  const std::size_t name_end = line.find_first_of("= \t");
  const std::string_view name = line.substr(0, name_end),
                         rest = name_end == std::string_view::npos ? "" : Trimmed(line.substr(name_end));
  if (name.empty()) return Bad("a field has a type and no name");
  if (rest.rfind('=', 0) == 0) return std::nullopt;
  field.name = name;
  return field;
}

bool IsRule(std::string_view line) { return line.size() >= 3 && line.find_first_not_of('=') == std::string_view::npos; }

}  // namespace

Status ReadMsgText(std::string_view text, const std::string& name, Types& types) {
  MessageType* type = &types[name];
  type->name = name;
  std::size_t fields = 0;
  while (!text.empty()) {
    const std::string_view line = Trimmed(TakeLine(text));
    if (IsRule(line)) {
      std::string_view title = TakeLine(text);
      if (TakeWord(title) != "MSG:") return Bad("a line of '=' is not followed by MSG:");
      const std::string next = PlainTypeName(Trimmed(title));
      type = &types[next];
      *type = {next, {}};
      continue;
    }
    auto field = ReadField(line);
    if (!field) return Fail(field.error().code, Quoted(type->name) + ": " + field.error().what, field.error().cure);
    if (*field) type->fields.push_back(*std::move(*field));
    if (++fields > limits::kFieldsMax) return Bad("more than " + std::to_string(limits::kFieldsMax) + " lines");
    if (types.size() > limits::kTypesMax) return Bad("more than " + std::to_string(limits::kTypesMax) + " types");
  }
  return {};
}

}  // namespace rigcal::bags
