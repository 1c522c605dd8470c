#include "client/import/files/yaml_out.h"

#include <algorithm>
#include <cctype>
#include <cstdio>

namespace rigcal::importing {
namespace {

using formats::YamlNode;

bool IsPlain(const std::string& text) {
  if (text.empty() || text == "~" || text == "null" || text == "Null" || text == "NULL") return false;
  const auto is_alnum = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  if (!is_alnum(text[0]) && text[0] != '/' && text[0] != '_' &&
      !(text[0] == '-' && text.size() > 1 && is_alnum(text[1])))
    return false;
  return std::all_of(text.begin(), text.end(), [&](char c) {
    return is_alnum(c) || std::string_view("/_.+-").find(c) != std::string_view::npos;
  });
}

std::string Inline(const YamlNode& node) {
  if (node.kind == YamlNode::Kind::kNull) return "~";
  if (node.kind == YamlNode::Kind::kText) return YamlWord(node.text);
  const bool is_map = node.kind == YamlNode::Kind::kMap;
  std::string text = is_map ? "{" : "[";
  for (const YamlNode& item : node.items) {
    if (text.size() > 1) text += ", ";
    text += (is_map ? YamlWord(item.key) + ": " : "") + Inline(item);
  }
  return text + (is_map ? "}" : "]");
}

}  // namespace

std::string YamlWord(const std::string& text) {
  if (IsPlain(text)) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') quoted += '\\';
    if (byte >= 0x20 && byte != 0x7F) {
      quoted += c;
      continue;
    }
    char escaped[8];
    std::snprintf(escaped, sizeof escaped, "\\x%02X", byte);
    quoted += escaped;
  }
  return quoted + "\"";
}

std::string YamlLines(const YamlNode& map, int indent) {
  std::string lines;
  for (const YamlNode& item : map.items) {
    lines += std::string(static_cast<std::size_t>(indent), ' ') + YamlWord(item.key) + ":";
    // Maps of maps are spread over lines, the rest stays on one.
    const bool nests = item.kind == YamlNode::Kind::kMap && !item.items.empty() && indent < 4;
    lines += nests ? "\n" + YamlLines(item, indent + 2) : " " + Inline(item) + "\n";
  }
  return lines;
}

}  // namespace rigcal::importing
