// Which of its two layouts a charuco board was printed in, as a picture tells it.
#pragma once

#include <string>
#include <string_view>

#include "server/model/sensors/features.h"

namespace rigcal {

// Stands in BoardView::why_not where the markers lie as the other layout (Target::legacy_layout) has them.
inline constexpr std::string_view kSetsLayout = "set legacy_layout: ";
// Whether the board was not found for that reason only.
inline bool ShowsOtherLayout(const BoardView& view) {
  return !view.found && view.why_not.find(kSetsLayout) != std::string::npos;
}

}  // namespace rigcal
