// Real picture pairs split by where the board was: what all captures share, as a lens that its model does not describe,
// is seen by place and not by leaving captures out.
#pragma once

#include <filesystem>

namespace rigcal {

// Prints one JSON object: of each split the largest difference of the two halves' poses in told sigmas, and their
// states. The program's exit code.
int PrintSplits(const std::filesystem::path& folder);

}  // namespace rigcal
