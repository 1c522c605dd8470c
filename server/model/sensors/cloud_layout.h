// What a lidar's .bin files hold of each point: numbers of one type, one after the other, little-endian.
#pragma once

#include <string>
#include <vector>

#include "server/base/result.h"

namespace rigcal {

enum class PointType { kFloat32, kFloat64 };  // "float32" | "float64"
// The spelling in documents, and back: kInvalidInput, with the known ones, for any other.
[[nodiscard]] std::string NameOf(PointType type);
[[nodiscard]] Result<PointType> PointTypeOf(const std::string& name);

struct CloudLayout {
  std::vector<std::string> fields;  // 3 to 8 names, x y z among them
  PointType type = PointType::kFloat32;
  friend bool operator==(const CloudLayout&, const CloudLayout&) = default;
};

// x y z intensity, float32.
[[nodiscard]] CloudLayout KittiLayout();
// "x y z intensity, float32": for messages, and where clouds of different layouts must not be taken for each other.
[[nodiscard]] std::string TextOf(const CloudLayout& layout);
[[nodiscard]] Status Validate(const CloudLayout& layout);

}  // namespace rigcal
