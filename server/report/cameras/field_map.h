// A drawing of a picture with one number of pixels for each of its fields (sensors/coverage.h), in five classes of one
// scale: so the maps of all cameras compare. What a map says is in its text alternative, too.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "server/report/frame/page.h"

namespace rigcal::report {

// Drawing units: a map is so wide, and as high as the picture's shape makes it (within bounds: odd sizes are drawn,
// too).
inline constexpr double kMapWidth = 360.0;
// As a number for the drawing's height; of a size that is not known two thirds of the width.
[[nodiscard]] std::string MapHeightText(int width_px, int height_px);

struct FieldMap {
  int width_px = 0, height_px = 0;              // of the picture
  int columns = 0, rows = 0;                    // of its fields, which follow row by row
  std::vector<std::optional<double>> value_px;  // absent: the field is blank
  std::vector<bool> seen;                       // false: hatched
  std::vector<std::optional<Eigen::Vector2d>> arrow_px =
      {};  // from each field's middle, all magnified alike; may be empty
};

// The largest number, and where: "at the upper left". Nothing where there is none. `among`: of these fields only;
// empty: all.
struct WorstField {
  double value_px = 0.0;
  std::string where;
};
// Of equals the first, row by row.
[[nodiscard]] std::optional<WorstField> WorstOf(const FieldMap& map, const std::vector<bool>& among = {});
// Of the field that holds the middle of the picture.
[[nodiscard]] std::optional<double> MiddleValue(const FieldMap& map);

// "0.41 px", "below 0.001 px".
[[nodiscard]] std::string PixelsText(double value_px);

// {{>FIELD_MAP}} of `parent`, with `label` as its text alternative.
void FillFieldMap(Dictionary& parent, const FieldMap& map, const std::string& label);

}  // namespace rigcal::report
