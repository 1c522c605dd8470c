#include "server/formats/yaml/yaml_field.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "server/base/text.h"
#include "server/formats/json/nearest.h"

namespace rigcal::formats {
namespace {

const YamlNode kNothing;  // what a field is after an error

template <typename T>
std::optional<T> Parsed(std::string_view text) {
  T value{};
  if (text.substr(0, 1) == "+") text.remove_prefix(1);
  const auto end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

}  // namespace

void YamlField::Refuse(const std::string& what, const std::string& cure) const {
  if (tree_->error) return;
  const std::string title = title_.empty() ? "" : title_ + ": ";
  tree_->error =
      Error{ErrorCode::kInvalidInput, tree_->name + " line " + std::to_string(node_->line) + ": " + title + what,
            cure.empty() ? tree_->cure : cure};
}

void YamlField::Refuse(const Error& error) const {
  if (tree_->error) return;
  tree_->error =
      Error{error.code, tree_->name + " line " + std::to_string(node_->line) + ": " + error.what, error.cure};
}

YamlField YamlField::Member(const YamlNode& node) const {
  return {tree_, &node, title_.empty() ? node.key : title_ + ": " + node.key};
}

YamlField YamlField::Called(std::string title) const { return {tree_, node_, std::move(title)}; }

YamlField YamlField::At(std::string_view key) const {
  YamlField nothing(tree_, &kNothing, {});
  if (tree_->error) return nothing;
  if (node_->kind != YamlNode::Kind::kMap) {
    Refuse("must be a map of names and values");
    return nothing;
  }
  for (const YamlNode& member : node_->items)
    if (member.key == key) return Member(member);
  Refuse(Quoted(key) + " is missing");
  return nothing;
}

std::optional<YamlField> YamlField::Find(std::string_view key) const {
  if (node_->kind != YamlNode::Kind::kMap) return std::nullopt;
  for (const YamlNode& member : node_->items)
    if (member.key == key && member.kind != YamlNode::Kind::kNull) return Member(member);
  return std::nullopt;
}

std::vector<YamlField> YamlField::Items() const {
  std::vector<YamlField> items;
  if (tree_->error) return items;
  if (node_->kind != YamlNode::Kind::kList) {
    Refuse("must be a list [...]");
    return items;
  }
  for (const YamlNode& item : node_->items) items.push_back({tree_, &item, title_});
  return items;
}

std::vector<YamlField> YamlField::Members() const {
  std::vector<YamlField> members;
  if (tree_->error) return members;
  if (node_->kind != YamlNode::Kind::kMap) {
    Refuse("must be a map of names and values");
    return members;
  }
  for (const YamlNode& member : node_->items) members.push_back(Member(member));
  return members;
}

std::string YamlField::Text() const {
  if (tree_->error) return {};
  if (node_->kind == YamlNode::Kind::kText) return node_->text;
  Refuse(node_->kind == YamlNode::Kind::kNull ? "has no value" : "must be one value");
  return {};
}

double YamlField::Number() const {
  const std::string text = Text();
  if (tree_->error) return 0.0;
  const std::optional<double> value = Parsed<double>(text);
  if (value && std::isfinite(*value)) return *value;
  Refuse("must be a number, not " + Quoted(text));
  return 0.0;
}

std::int64_t YamlField::Integer(std::int64_t min, std::int64_t max) const {
  const std::string text = Text();
  if (tree_->error) return min;
  const std::optional<std::int64_t> value = Parsed<std::int64_t>(text);
  if (value && *value >= min && *value <= max) return *value;
  Refuse("must be a whole number from " + std::to_string(min) + " to " + std::to_string(max) + ", not " + Quoted(text));
  return min;
}

void YamlField::Numbers(double* to, std::size_t count) const {
  const std::vector<YamlField> items = Items();
  if (tree_->error) return;
  if (items.size() != count)
    return Refuse("must be a list of " + std::to_string(count) + " numbers; it has " + std::to_string(items.size()));
  for (const YamlField& item : items) *to++ = item.Number();
}

void YamlField::AllowOnly(const std::vector<std::string_view>& keys) const {
  if (tree_->error || node_->kind != YamlNode::Kind::kMap) return;
  for (const YamlNode& member : node_->items) {
    if (std::find(keys.begin(), keys.end(), member.key) != keys.end()) continue;
    return YamlField(tree_, &member, title_)
        .Refuse("unknown key " + Quoted(member.key) + "; " + DidYouMean(member.key, keys));
  }
}

}  // namespace rigcal::formats
