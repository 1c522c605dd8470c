// A board as people describe it: in session.yaml, and in the file of a virtual rig.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "server/formats/yaml/yaml_field.h"
#include "server/model/sensors/target.h"

namespace rigcal::formats {

struct TargetRules {
  std::optional<TargetKind> otherwise = {};   // where no type is given; absent: it has to be
  std::vector<std::string_view> beside = {};  // keys that stand beside those of a board
};
// Named by its key (docs/session-format.md lists the fields of each type), and valid, else the field is refused.
[[nodiscard]] Target ReadTarget(const YamlField& field, const TargetRules& rules = {});

}  // namespace rigcal::formats
