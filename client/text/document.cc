#include "client/text/document.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

namespace rigcal::client {

using nlohmann::json;

// Points into the tree that `root` owns; null: absent.
struct Document::Node {
  std::shared_ptr<const json> root;
  const json* value = nullptr;
};

Document::Document() : Document(std::make_shared<const Node>()) {}

Document::Document(std::shared_ptr<const Node> node) : node_(std::move(node)) {}

Result<Document> Document::Parse(std::string_view text, std::string_view origin) {
  int deepest = 0;
  // Of what is nested too deep nothing is kept: writing it would take a stack frame for each level.
  const auto bounded = [&deepest](int depth, json::parse_event_t event, json&) {
    const bool opens = event == json::parse_event_t::object_start || event == json::parse_event_t::array_start;
    if (opens) deepest = std::max(deepest, depth + 1);
    return !opens || depth < kDocumentDepthMax;
  };
  auto root = std::make_shared<const json>(json::parse(text, bounded, false));
  if (deepest > kDocumentDepthMax)
    return Fail(ErrorCode::kUnsupported,
                std::string(origin) + " is nested deeper than " + std::to_string(kDocumentDepthMax) + " levels",
                "No answer of a rigcald is: ask which program answers there");
  if (root->is_discarded())
    return Fail(ErrorCode::kUnsupported, std::string(origin) + " is not JSON",
                "Check with `rigcal doctor` that client and server are of the same version");
  const json* top = root.get();
  return Document(std::make_shared<const Node>(Node{std::move(root), top}));
}

Document Document::operator[](std::string_view key) const {
  Node node{node_->root, nullptr};
  if (node_->value && node_->value->is_object()) {
    const auto found = node_->value->find(std::string(key));
    if (found != node_->value->end()) node.value = &*found;
  }
  return Document(std::make_shared<const Node>(std::move(node)));
}

Document Document::operator[](std::size_t idx) const {
  const bool exists = node_->value && node_->value->is_array() && idx < node_->value->size();
  return Document(std::make_shared<const Node>(Node{node_->root, exists ? &(*node_->value)[idx] : nullptr}));
}

bool Document::IsNull() const { return !node_->value || node_->value->is_null(); }

bool Document::Has(std::string_view key) const {
  return node_->value && node_->value->is_object() && node_->value->contains(std::string(key));
}

std::size_t Document::size() const { return node_->value && node_->value->is_structured() ? node_->value->size() : 0; }

std::vector<Document> Document::Items() const {
  std::vector<Document> items;
  if (!node_->value || !node_->value->is_array()) return items;
  items.reserve(node_->value->size());
  for (const json& item : *node_->value)
    items.push_back(Document(std::make_shared<const Node>(Node{node_->root, &item})));
  return items;
}

std::vector<std::string> Document::Keys() const {
  std::vector<std::string> keys;
  if (!node_->value || !node_->value->is_object()) return keys;
  for (const auto& item : node_->value->items()) keys.push_back(item.key());
  return keys;
}

std::string Document::Text(std::string_view fallback) const {
  return node_->value && node_->value->is_string() ? node_->value->get<std::string>() : std::string(fallback);
}

std::optional<double> Document::Number() const {
  if (!node_->value || !node_->value->is_number()) return std::nullopt;
  return node_->value->get<double>();
}

std::optional<std::int64_t> Document::Integer() const {
  if (!node_->value || !node_->value->is_number_integer()) return std::nullopt;
  return node_->value->get<std::int64_t>();
}

bool Document::Flag(bool fallback) const {
  return node_->value && node_->value->is_boolean() ? node_->value->get<bool>() : fallback;
}

std::string Document::Dump() const {
  return node_->value ? node_->value->dump(-1, ' ', false, json::error_handler_t::replace) : "null";
}

namespace {
std::string Quoted(const std::string& text) { return json(text).dump(-1, ' ', false, json::error_handler_t::replace); }
}  // namespace

Field::Field(std::string key_in, const std::string& text) : key(std::move(key_in)), json(Quoted(text)) {}
Field::Field(std::string key_in, const char* text) : Field(std::move(key_in), std::string(text)) {}
Field::Field(std::string key_in, std::int64_t value) : key(std::move(key_in)), json(std::to_string(value)) {}

Field Field::Raw(std::string key, std::string json_text) {
  Field field(std::move(key), std::int64_t{0});
  field.json = std::move(json_text);
  return field;
}

std::string JsonObject(const std::vector<Field>& fields) {
  std::string text = "{";
  for (const Field& field : fields) text += (text.size() > 1 ? "," : "") + Quoted(field.key) + ":" + field.json;
  return text + "}";
}

}  // namespace rigcal::client
