#include "client/bags/messages/definition.h"

#include "client/bags/limits.h"
#include "server/base/text.h"

namespace rigcal::bags {
namespace {

constexpr const char* kCure =
    "Its topic is listed and left out; record it with a recorder that writes message definitions.";

Error Refusal(ErrorCode code, const Topic& topic, const std::string& what) {
  return {code, "topic " + Quoted(topic.name) + " of type " + Quoted(topic.type) + ": " + what, kCure};
}

std::string PackageOf(const std::string& type) { return type.substr(0, type.find('/')); }

// Resolves what the fields of one definition refer to, and takes known types in where the text left them out.
class Resolver {
 public:
  Resolver(Types& types, bool is_ros1) : types_(types), is_ros1_(is_ros1) {}

  // The type of this name with all below it.
  Result<const MessageType*> Resolve(const std::string& name, std::size_t depth) {
    if (depth > limits::kNestingMax)
      return Bad("messages are nested deeper than " + std::to_string(limits::kNestingMax));
    auto found = types_.find(name);
    if (found == types_.end()) {
      const std::string text = KnownMsgText(name, is_ros1_);
      if (text.empty()) return Bad("the definition of " + Quoted(name) + " is missing");
      RIGCAL_TRY(ReadMsgText(text, name, types_));
      found = types_.find(name);
    }
    if (types_.size() > limits::kTypesMax) return Bad("more than " + std::to_string(limits::kTypesMax) + " types");
    const auto state = states_.find(name);
    if (state != states_.end() && !state->second) return Bad(Quoted(name) + " contains itself");
    if (state != states_.end()) return &found->second;
    states_[name] = false;
    for (FieldType& field : found->second.fields)
      if (field.primitive == Primitive::kMessage) RIGCAL_TRY(ResolveField(found->second, field, depth));
    states_[name] = true;
    return &found->second;
  }

 private:
  Status ResolveField(const MessageType& owner, FieldType& field, std::size_t depth) {
    RIGCAL_ASSIGN(const std::string name, FullName(owner, field.message));
    RIGCAL_ASSIGN(field.type, Resolve(name, depth + 1));
    field.message = name;
    return {};
  }

  // "Header" and a name without a package are looked for beside their owner.
  Result<std::string> FullName(const MessageType& owner, const std::string& name) const {
    if (name.find('/') != std::string::npos) return PlainTypeName(name);
    const std::string beside = PackageOf(owner.name) + "/" + name;
    if (types_.count(beside) > 0) return beside;
    if (name == "Header") return std::string("std_msgs/Header");
    return beside;
  }
  static tl::unexpected<Error> Bad(std::string what) { return Fail(ErrorCode::kInvalidInput, std::move(what), kCure); }

  Types& types_;
  bool is_ros1_;
  std::map<std::string, bool> states_;  // false: being resolved
};

Status ReadText(const Topic& topic, const std::string& name, bool is_ros1, Types& types) {
  if (topic.schema.size() > limits::kDefinitionBytesMax)
    return Fail(Refusal(ErrorCode::kInvalidInput, topic,
                        "its definition has " + std::to_string(topic.schema.size()) + " bytes"));
  // An empty text is that of an empty message, or of a recorder that did not find the definition.
  if (topic.schema.empty() && !KnownMsgText(name, is_ros1).empty()) return {};
  if (topic.schema.find("\n---") != std::string::npos || topic.schema.rfind("---", 0) == 0)
    return Fail(Refusal(ErrorCode::kUnsupported, topic, "it is of a service, not of a message"));
  if (topic.schema_encoding == "ros2msg" || topic.schema_encoding == "ros1msg")
    return ReadMsgText(topic.schema, name, types);
  if (topic.schema_encoding == "ros2idl" || topic.schema_encoding == "omgidl") return ReadIdlText(topic.schema, types);
  if (!topic.schema_encoding.empty() && KnownMsgText(name, is_ros1).empty())
    return Fail(Refusal(ErrorCode::kUnsupported, topic,
                        "its definition is written as " + Quoted(topic.schema_encoding) + ", which is not read"));
  return {};  // Resolve() knows it or says so
}

}  // namespace

std::size_t SizeOf(Primitive primitive) {
  switch (primitive) {
    case Primitive::kBool:
    case Primitive::kInt8:
    case Primitive::kUint8:
      return 1;
    case Primitive::kInt16:
    case Primitive::kUint16:
      return 2;
    case Primitive::kInt32:
    case Primitive::kUint32:
    case Primitive::kFloat32:
      return 4;
    case Primitive::kInt64:
    case Primitive::kUint64:
    case Primitive::kFloat64:
      return 8;
    case Primitive::kString:
    case Primitive::kWstring:
    case Primitive::kMessage:
      break;
  }
  return 0;
}

std::string PlainTypeName(std::string_view name) {
  std::string plain;
  for (std::size_t at = 0; at < name.size(); ++at) {
    const bool is_scope = name.substr(at, 2) == "::";
    plain += is_scope ? '/' : name[at];
    at += is_scope ? 1 : 0;
  }
  const std::size_t dds = plain.find("/dds_/");
  if (dds != std::string::npos) plain.erase(dds, 5);
  if (dds != std::string::npos && plain.back() == '_') plain.pop_back();
  const std::size_t first = plain.find('/'), last = plain.rfind('/');
  return first == last ? plain : plain.substr(0, first) + plain.substr(last);
}

Result<std::shared_ptr<const Definition>> DefinitionOf(const Topic& topic) {
  auto definition = std::make_shared<Definition>();
  const std::string name = PlainTypeName(topic.type);
  const bool is_ros1 = topic.encoding == "ros1";
  const auto named = [&](const Error& error) {
    return error.what.rfind("topic ", 0) == 0 ? error : Refusal(error.code, topic, error.what);
  };
  if (const Status read = ReadText(topic, name, is_ros1, definition->types); !read) return Fail(named(read.error()));
  const auto root = Resolver(definition->types, is_ros1).Resolve(name, 0);
  if (!root) return Fail(named(root.error()));
  definition->root = *root;
  return definition;
}

}  // namespace rigcal::bags
