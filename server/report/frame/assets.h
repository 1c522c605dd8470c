// The pages' scripts: bundles of web-static, named by their content, so that a browser may keep them for ever.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rigcal::report {

struct Asset {
  std::string name;  // "rig-0123456789ab.js"
  std::string_view bytes;
};
// All scripts and styles that pages use, each named by its content; valid as long as the process.
[[nodiscard]] const std::vector<Asset>& Assets();

// Relative to the folder that holds assets/: "rig.js" -> "assets/rig-0123456789ab.js".
[[nodiscard]] std::string AssetPath(std::string_view bundle);

}  // namespace rigcal::report
