// What is odd about the points of a pair's clouds, as notes of its edge.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/model/diagnosis.h"

namespace rigcal::pipeline {

class OddClouds {
 public:
  // `what` of formats::OdditiesOf; empty: not odd.
  void Add(const SensorId& lidar, const CaptureId& capture, const std::string& what);
  // One of each lidar that has some, by name: how many, and what of the first.
  [[nodiscard]] std::vector<Diagnosis> Notes() const;

 private:
  std::map<SensorId, std::map<CaptureId, std::string>> odd_;
};

}  // namespace rigcal::pipeline
