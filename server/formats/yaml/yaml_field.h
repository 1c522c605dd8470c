// Reads YAML that a person wrote: bounded in size and depth, no anchors, no tags, no repeated keys, and every error
// names file, line and field ("session.yaml line 7: sensor 'left': fx_px: must be a number").
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"

namespace rigcal::formats {

constexpr int kYamlDepthMax = 8;

struct YamlNode {
  enum class Kind { kNull, kText, kList, kMap };
  Kind kind = Kind::kNull;
  std::string key;              // of a map's member
  int line = 0;                 // of the key, or of the value where there is no key; from 1
  std::string text;             // of kText, unquoted
  std::vector<YamlNode> items;  // of kList and kMap, in the file's order
};

struct YamlTree {
  std::string name, cure;
  YamlNode root;
  std::optional<Error> error;
};

// `name` starts every error; `cure` is what to do about a wrong file.
[[nodiscard]] Result<std::unique_ptr<YamlTree>> ParseYaml(std::string_view text, const std::string& name,
                                                          const std::string& cure, std::size_t bytes_max);

// A place in a tree. As JsonField: the first wrong field is remembered in the tree's `error`, from then on values are
// empty. Lives as long as the tree.
class YamlField {
 public:
  // The root of the tree.
  explicit YamlField(YamlTree& tree) : tree_(&tree), node_(&tree.root) {}
  // A member that must be there.
  [[nodiscard]] YamlField At(std::string_view key) const;
  // A member that may be absent or empty.
  [[nodiscard]] std::optional<YamlField> Find(std::string_view key) const;
  [[nodiscard]] std::vector<YamlField> Items() const;    // of a list
  [[nodiscard]] std::vector<YamlField> Members() const;  // of a map
  [[nodiscard]] const std::string& Key() const { return node_->key; }
  // The same place, called `title` in errors: "sensor 'left'".
  [[nodiscard]] YamlField Called(std::string title) const;

  // One value of that kind, else the field is refused; a number is finite, an integer within min to max.
  [[nodiscard]] std::string Text() const;
  [[nodiscard]] double Number() const;
  [[nodiscard]] std::int64_t Integer(std::int64_t min, std::int64_t max) const;
  void Numbers(double* to, std::size_t count) const;  // exactly `count`

  // Refuses the first other key of a map by name, with what was probably meant.
  void AllowOnly(const std::vector<std::string_view>& keys) const;
  // "<name> line <n>: <title>: <what>"; only the first one counts. An empty cure is the tree's.
  void Refuse(const std::string& what, const std::string& cure = {}) const;
  // The same with an error about the whole thing, its code and cure, without the title.
  void Refuse(const Error& error) const;

 private:
  YamlField(YamlTree* tree, const YamlNode* node, std::string title)
      : tree_(tree), node_(node), title_(std::move(title)) {}
  [[nodiscard]] YamlField Member(const YamlNode& node) const;

  YamlTree* tree_;
  const YamlNode* node_;
  std::string title_;
};

}  // namespace rigcal::formats
