// The figures of an edge in words, what matters first: numbers that belong together in one row, codes never shown.
#pragma once

#include <string>
#include <vector>

#include "server/model/edges/edge.h"

namespace rigcal::report {

struct FigureRow {
  std::string name, value;
};
struct FigureRows {
  std::vector<FigureRow>
      checks;                   // what the method says of its own result; figures of other programs by their own names
  std::vector<FigureRow> lens;  // intrinsics that this edge was solved with
};
// Places in lists ("_idx") are left out; figures that we know come first, in the order of the words for them.
[[nodiscard]] FigureRows RowsOf(const Edge& edge);
// "lidar_camera" -> "lidar-camera"; a method that is not ours stays as it is.
[[nodiscard]] std::string MethodText(const std::string& method);
// Not the plain method's answer, but polished from there.
[[nodiscard]] bool IsPolished(const Edge& edge);
// "lidar-lidar, polished by GICP".
[[nodiscard]] std::string MethodText(const Edge& edge);

}  // namespace rigcal::report
