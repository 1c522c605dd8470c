// YAML as a file for people, from a tree that was read.
#pragma once

#include <string>

#include "server/formats/yaml/yaml_field.h"

namespace rigcal::importing {

// A word as it stands where YAML takes it for text, else in double quotes.
[[nodiscard]] std::string YamlWord(const std::string& text);
// The members of a map, a line each, indented by `indent`. Reads back as the same tree.
[[nodiscard]] std::string YamlLines(const formats::YamlNode& map, int indent);

}  // namespace rigcal::importing
