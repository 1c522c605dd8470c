// Why what a sensor saw in a capture has no say in a refinement.
#pragma once

#include <string>

#include "server/base/result.h"

namespace rigcal {

// It contradicts all others; nothing tells where its board stood; by all others that was behind the camera.
enum class WhyHeldBack { kContradicts, kPlaceUnknown, kBehindTheCamera };
// "contradicts" | "place_unknown" | "behind_the_camera"
[[nodiscard]] const char* NameOf(WhyHeldBack why);
[[nodiscard]] Result<WhyHeldBack> WhyHeldBackOf(const std::string& name);

}  // namespace rigcal
