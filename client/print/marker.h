// The cells of a printed marker.
#pragma once

#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/model/sensors/target.h"

namespace rigcal::print {

struct Marker {
  int cells = 0;               // along each side, the border with them
  std::vector<bool> is_black;  // row by row from the top left
};

// The markers of these ids, of a board of this kind, with their borders: one cell wide, two of an AprilGrid.
// kInvalidInput where the dictionary is not known or has not all of them.
[[nodiscard]] Result<std::vector<Marker>> MarkersOf(TargetKind kind, const std::string& dictionary,
                                                    const std::vector<int>& ids);

}  // namespace rigcal::print
