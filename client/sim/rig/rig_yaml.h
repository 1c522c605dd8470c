// A rig as YAML (client/sim/README.md) -> Rig.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "client/sim/rig/rig.h"

namespace rigcal::sim {

// `name` is used in errors ("rig.yaml line 7: ...").
[[nodiscard]] Result<Rig> ReadRig(std::string_view text, const std::string& name);

// Their names.
[[nodiscard]] std::vector<std::string> BuiltInRigs();
// The text of a built-in rig.
[[nodiscard]] Result<std::string> BuiltInRig(const std::string& name);
// A built-in rig by name, else the file at that path.
[[nodiscard]] Result<Rig> LoadRig(const std::string& name_or_path);

}  // namespace rigcal::sim
