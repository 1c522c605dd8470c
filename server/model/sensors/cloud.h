// A point cloud as it was decoded.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace rigcal {

struct CloudField {
  std::string name;            // as in the file: "intensity", "ring", "time", ...
  std::vector<double> values;  // one per point, finite
};

struct Cloud {
  std::vector<Eigen::Vector3f> points_m;  // in the sensor's frame, metres, finite
  std::vector<CloudField> fields;         // whatever the file holds beyond x y z, in its order
  std::size_t dropped = 0;                // points of the file that are not in points_m: beams without a return, and
  std::size_t beyond_1km = 0;             // of those, with finite coordinates that no lidar measures
  // Fields that are not in `fields` because a point that is kept has no finite value there: no number is made up, and
  // no NaN goes on.
  std::vector<std::string> left_out;
};

}  // namespace rigcal
