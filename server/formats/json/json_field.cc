#include "server/formats/json/json_field.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "server/base/text.h"
#include "server/formats/json/nearest.h"

namespace rigcal::formats {

using nlohmann::json;

struct JsonTree {
  JsonKind kind;
  json root;
  std::optional<Error> error;

  void Refuse(const std::string& what) {
    if (!error) error = Error{ErrorCode::kInvalidInput, kind.name + ": " + what, kind.cure};
  }
};

namespace {

const json& Node(const void* node) { return *static_cast<const json*>(node); }

// nlohmann builds trees of any depth and keeps the last of repeated keys; this one refuses both.
class TreeBuilder : public nlohmann::json_sax<json> {
 public:
  TreeBuilder(std::string_view text, JsonTree& tree) : text_(text), tree_(tree) {}

  bool null() override { return Add(nullptr); }
  bool boolean(bool value) override { return Add(value); }
  bool number_integer(number_integer_t value) override { return Add(value); }
  bool number_unsigned(number_unsigned_t value) override { return Add(value); }
  bool number_float(number_float_t value, const string_t& /*text*/) override { return Add(value); }
  bool string(string_t& value) override { return Add(std::move(value)); }
  bool binary(binary_t& /*value*/) override { return Refuse("binary values are not JSON"); }
  bool start_object(std::size_t /*elements*/) override { return Open(json::object()); }
  bool start_array(std::size_t /*elements*/) override { return Open(json::array()); }
  bool end_object() override { return Close(); }
  bool end_array() override { return Close(); }

  bool key(string_t& value) override {
    if (open_.back()->contains(value)) return Refuse(Quoted(value) + " stands twice in one object");
    slot_ = &(*open_.back())[value];
    return true;
  }

  bool parse_error(std::size_t position, const std::string& token, const json::exception& error) override {
    const auto end = text_.begin() + static_cast<std::ptrdiff_t>(std::min(position, text_.size()));
    const auto line = 1 + std::count(text_.begin(), end, '\n');
    const bool too_large = dynamic_cast<const json::out_of_range*>(&error) != nullptr;
    const std::string near =
        token.empty() ? "the end" : Quoted(token.substr(token.size() - std::min(token.size(), kNear)));
    return Refuse("line " + std::to_string(line) + ": " +
                  (too_large ? "a number is too large, near " : "not JSON, near ") + near);
  }

 private:
  static constexpr std::size_t kNear = 24;

  bool Refuse(const std::string& what) {
    tree_.Refuse(what);
    return false;
  }

  json* Place(json value) {
    if (open_.empty()) {
      tree_.root = std::move(value);
      return &tree_.root;
    }
    if (open_.back()->is_array()) {
      open_.back()->push_back(std::move(value));
      return &open_.back()->back();
    }
    *slot_ = std::move(value);
    return slot_;
  }
  bool Add(json value) {
    Place(std::move(value));
    return true;
  }
  bool Open(json value) {
    if (open_.size() >= kJsonDepthMax) return Refuse("nested deeper than " + std::to_string(kJsonDepthMax) + " levels");
    open_.push_back(Place(std::move(value)));
    return true;
  }
  bool Close() {
    open_.pop_back();
    return true;
  }

  std::string_view text_;
  JsonTree& tree_;
  std::vector<json*> open_;
  json* slot_ = nullptr;
};

constexpr std::size_t kPathShownMax = 200;

// The path of `target` below `node`, found by search: paths are needed once, for the error, and cost nothing before.
bool FindPath(const json& node, const void* target, std::string& path) {
  if (&node == target) return true;
  const std::size_t length = path.size();
  if (node.is_array()) {
    for (std::size_t i = 0; i < node.size(); ++i) {
      path += "[" + std::to_string(i) + "]";
      if (FindPath(node[i], target, path)) return true;
      path.resize(length);
    }
  } else if (node.is_object()) {
    for (const auto& [key, value] : node.get_ref<const json::object_t&>()) {
      path += (path.empty() ? "" : ".") + key;
      if (FindPath(value, target, path)) return true;
      path.resize(length);
    }
  }
  return false;
}

}  // namespace

JsonDocument::JsonDocument(std::unique_ptr<JsonTree> tree) : tree_(std::move(tree)) {}
JsonDocument::JsonDocument(JsonDocument&&) noexcept = default;
JsonDocument& JsonDocument::operator=(JsonDocument&&) noexcept = default;
JsonDocument::~JsonDocument() = default;

Result<JsonDocument> JsonDocument::Parse(std::string_view text, const JsonKind& kind) {
  auto tree = std::make_unique<JsonTree>(JsonTree{kind, nullptr, std::nullopt});
  if (text.size() > kind.bytes_max) {
    tree->Refuse("has " + std::to_string(text.size()) + " bytes; the limit is " + std::to_string(kind.bytes_max));
    return Fail(*tree->error);
  }
  TreeBuilder builder(text, *tree);
  if (!json::sax_parse(text, &builder)) return Fail(*tree->error);
  return JsonDocument(std::move(tree));
}

JsonField JsonDocument::Root() { return JsonField(tree_.get(), &tree_->root); }

Status JsonDocument::status() const {
  if (tree_->error) return Fail(*tree_->error);
  return {};
}

void JsonField::Refuse(const std::string& what) const {
  if (tree_->error) return;
  std::string path;
  if (node_ != nullptr) FindPath(tree_->root, node_, path);
  if (!IsPrintableUtf8(path) || path.size() > kPathShownMax) path = Quoted(path);
  tree_->Refuse(path.empty() ? what : path + ": " + what);
}

JsonField JsonField::At(std::string_view key) const {
  const JsonField nothing(tree_, nullptr);
  if (node_ == nullptr) return nothing;
  if (!Node(node_).is_object()) {
    Refuse("must be an object {...}");
    return nothing;
  }
  const auto found = Node(node_).find(std::string(key));
  if (found == Node(node_).end()) {
    Refuse(Quoted(key) + " is missing");
    return nothing;
  }
  return JsonField(tree_, &*found);
}

std::optional<JsonField> JsonField::Find(std::string_view key) const {
  if (node_ == nullptr || !Node(node_).is_object()) return std::nullopt;
  const auto found = Node(node_).find(std::string(key));
  if (found == Node(node_).end() || found->is_null()) return std::nullopt;
  return JsonField(tree_, &*found);
}

std::vector<JsonField> JsonField::Items(std::size_t count_max) const {
  std::vector<JsonField> items;
  if (node_ == nullptr) return items;
  const json& list = Node(node_);
  if (!list.is_array()) {
    Refuse("must be a list [...]");
  } else if (list.size() > count_max) {
    Refuse("has " + std::to_string(list.size()) + " entries; the limit is " + std::to_string(count_max));
  } else {
    items.reserve(list.size());
    for (const json& item : list) items.push_back(JsonField(tree_, &item));
  }
  return items;
}

std::vector<std::pair<std::string, JsonField>> JsonField::Members(std::size_t count_max) const {
  std::vector<std::pair<std::string, JsonField>> members;
  if (node_ == nullptr) return members;
  if (!Node(node_).is_object()) {
    Refuse("must be an object {...}");
  } else if (Node(node_).size() > count_max) {
    Refuse("has " + std::to_string(Node(node_).size()) + " members; the limit is " + std::to_string(count_max));
  } else {
    for (const auto& [key, value] : Node(node_).get_ref<const json::object_t&>())
      members.emplace_back(key, JsonField(tree_, &value));
  }
  return members;
}

bool JsonField::IsNull() const { return node_ == nullptr || Node(node_).is_null(); }

double JsonField::Number() const {
  if (node_ == nullptr) return 0.0;
  if (Node(node_).is_number()) return Node(node_).get<double>();
  Refuse("must be a number");
  return 0.0;
}

std::int64_t JsonField::Integer(std::int64_t min, std::int64_t max) const {
  if (node_ == nullptr) return min;
  const json& value = Node(node_);
  const bool fits = value.is_number_unsigned() ? value.get<std::uint64_t>() <= static_cast<std::uint64_t>(INT64_MAX)
                                               : value.is_number_integer();
  if (fits && value.get<std::int64_t>() >= min && value.get<std::int64_t>() <= max) return value.get<std::int64_t>();
  Refuse("must be an integer from " + std::to_string(min) + " to " + std::to_string(max));
  return min;
}

bool JsonField::Flag() const {
  if (node_ == nullptr) return false;
  if (Node(node_).is_boolean()) return Node(node_).get<bool>();
  Refuse("must be true or false");
  return false;
}

std::string JsonField::Text(std::size_t bytes_max) const {
  if (node_ == nullptr) return {};
  if (!Node(node_).is_string()) {
    Refuse("must be text");
    return {};
  }
  const std::string& text = Node(node_).get_ref<const std::string&>();
  if (text.size() <= bytes_max) return text;
  Refuse("has " + std::to_string(text.size()) + " bytes; the limit is " + std::to_string(bytes_max));
  return {};
}

void JsonField::Numbers(double* to, std::size_t count) const {
  if (node_ == nullptr) return;
  if (!Node(node_).is_array() || Node(node_).size() != count)
    return Refuse("must be a list of " + std::to_string(count) + " numbers");
  for (const json& item : Node(node_)) *to++ = JsonField(tree_, &item).Number();
}

void JsonField::AllowOnly(std::initializer_list<std::string_view> keys) const {
  if (node_ == nullptr || !Node(node_).is_object()) return;
  for (const auto& [key, value] : Node(node_).get_ref<const json::object_t&>()) {
    if (std::find(keys.begin(), keys.end(), key) == keys.end())
      return Refuse("unknown field " + Quoted(key) + "; " + DidYouMean(key, {keys.begin(), keys.size()}));
  }
}

}  // namespace rigcal::formats
