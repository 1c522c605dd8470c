#include "server/formats/yaml/yaml_values.h"

#include <cmath>

namespace rigcal::formats {

Eigen::Quaterniond ReadQuaternion(const YamlField& field) {
  constexpr double kFewDigits = 1e-3;
  double q[4] = {0, 0, 0, 1};
  field.Numbers(q, 4);
  const Eigen::Quaterniond read(q[3], q[0], q[1], q[2]);
  if (!(std::abs(read.norm() - 1.0) <= kFewDigits))
    field.Refuse("must have unit length (it is " + std::to_string(read.norm()) + ")");
  return read;
}

}  // namespace rigcal::formats
