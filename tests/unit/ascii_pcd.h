// Points of an ASCII PCD whose first fields are x y z; for tests only.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "server/model/sensors/cloud.h"

namespace rigcal {

inline Cloud AsciiPcd(const std::filesystem::path& path) {
  Cloud cloud;
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line) && line.rfind("DATA ascii", 0) != 0) continue;
  while (std::getline(file, line)) {
    Eigen::Vector3f point;
    std::istringstream words(line);
    if (words >> point.x() >> point.y() >> point.z()) cloud.points_m.push_back(point);
  }
  return cloud;
}

}  // namespace rigcal
