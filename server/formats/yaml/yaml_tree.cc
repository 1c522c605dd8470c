#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <sstream>

#include "server/base/text.h"
#include "server/formats/yaml/yaml_field.h"

namespace rigcal::formats {
namespace {

// Leaves yaml-cpp's parser from within an event; caught in ParseYaml.
struct Refused {
  int line;
  std::string what;
};

// Builds the tree from events, so that what is refused is refused before it is expanded.
class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(YamlNode& root) : root_(root) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (std::exchange(started_, true)) throw Refused{Line(mark), "a second document begins; there is one per file"};
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    CheckAnchor(mark, anchor);
    if (KeyIsNext()) throw Refused{Line(mark), "a key is empty"};
    Place(mark);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override { RefuseAnchor(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    CheckAnchor(mark, anchor);
    CheckTag(mark, tag);
    if (!IsPrintableUtf8(value)) throw Refused{Line(mark), "text has control characters or is not UTF-8"};
    if (KeyIsNext()) return BeginMember(mark, value);
    YamlNode& node = Place(mark);
    node.kind = YamlNode::Kind::kText;
    node.text = value;
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value /*style*/) override {
    Open(mark, tag, anchor, YamlNode::Kind::kList);
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value /*style*/) override {
    Open(mark, tag, anchor, YamlNode::Kind::kMap);
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  static int Line(const YAML::Mark& mark) { return mark.line + 1; }
  [[noreturn]] static void RefuseAnchor(const YAML::Mark& mark) {
    throw Refused{Line(mark), "anchors and aliases (& and *) are not used here: write the value out"};
  }
  static void CheckAnchor(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (anchor != YAML::NullAnchor) RefuseAnchor(mark);
  }
  // "?" is a plain, "!" a quoted value.
  static void CheckTag(const YAML::Mark& mark, const std::string& tag) {
    if (!tag.empty() && tag != "?" && tag != "!")
      throw Refused{Line(mark), "tags are not used here: remove " + Quoted(tag)};
  }

  [[nodiscard]] bool KeyIsNext() const {
    return !open_.empty() && open_.back()->kind == YamlNode::Kind::kMap && !member_begun_;
  }

  void BeginMember(const YAML::Mark& mark, const std::string& key) {
    std::vector<YamlNode>& members = open_.back()->items;
    for (const YamlNode& member : members)
      if (member.key == key)
        throw Refused{Line(mark), Quoted(key) + " stands twice (first in line " + std::to_string(member.line) + ")"};
    if (members.size() >= kMembersMax) throw Refused{Line(mark), "too many entries"};
    members.push_back({YamlNode::Kind::kNull, key, Line(mark), {}, {}});
    member_begun_ = true;
  }

  YamlNode& Place(const YAML::Mark& mark) {
    if (open_.empty()) {
      root_.line = Line(mark);
      return root_;
    }
    if (!std::exchange(member_begun_, false)) {
      open_.back()->items.emplace_back();
      open_.back()->items.back().line = Line(mark);
    }
    return open_.back()->items.back();
  }

  void Open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YamlNode::Kind kind) {
    CheckAnchor(mark, anchor);
    CheckTag(mark, tag);
    if (KeyIsNext()) throw Refused{Line(mark), "a key must be plain text"};
    if (open_.size() >= kYamlDepthMax)
      throw Refused{Line(mark), "nested deeper than " + std::to_string(kYamlDepthMax) + " levels"};
    YamlNode& node = Place(mark);
    node.kind = kind;
    open_.push_back(&node);
  }

  static constexpr std::size_t kMembersMax = 2048;  // repeated keys are looked for one by one

  YamlNode& root_;
  std::vector<YamlNode*> open_;
  bool member_begun_ = false;
  bool started_ = false;
};

// Line by line, so that the error can name the line.
void CheckText(std::string_view text) {
  if (text.substr(0, 3) == "\xef\xbb\xbf") text.remove_prefix(3);
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string content(text.substr(0, end));
    std::replace(content.begin(), content.end(), '\t', ' ');
    if (!content.empty() && content.back() == '\r') content.pop_back();
    if (!IsPrintableUtf8(content)) throw Refused{line, "is not UTF-8 text: save the file as UTF-8"};
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

void Build(std::string_view text, YamlNode& root) {
  CheckText(text);
  std::istringstream stream{std::string(text)};
  YAML::Parser parser(stream);
  TreeBuilder builder(root);
  while (parser.HandleNextDocument(builder)) {
  }
}

}  // namespace

Result<std::unique_ptr<YamlTree>> ParseYaml(std::string_view text, const std::string& name, const std::string& cure,
                                            std::size_t bytes_max) {
  const auto refused = [&](const std::string& what) { return Fail(ErrorCode::kInvalidInput, name + what, cure); };
  const auto refused_at = [&](int line, const std::string& what) {
    return refused(" line " + std::to_string(line) + ": " + what);
  };
  if (text.size() > bytes_max)
    return refused(" has " + std::to_string(text.size()) + " bytes; the limit is " + std::to_string(bytes_max));
  auto tree = std::make_unique<YamlTree>(YamlTree{name, cure, {}, std::nullopt});
  tree->root.line = 1;
  try {
    Build(text, tree->root);
  } catch (const Refused& problem) {
    return refused_at(problem.line, problem.what);
  } catch (const YAML::Exception& problem) {
    return refused_at(problem.mark.line + 1, "not YAML: " + problem.msg);
  } catch (const std::exception& problem) {
    return refused(": not YAML: " + std::string(problem.what()));
  }
  return tree;
}

}  // namespace rigcal::formats
