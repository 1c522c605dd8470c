// The uncertainty of the method (paper, section III-D): one pair calibrated twice from the same captures, by two
// methods that share neither model nor assumptions; how far apart are they, in sigmas of their difference?
#pragma once

#include <string>
#include <vector>

#include "tests/paper/joint_errors.h"
#include "tests/paper/page.h"
#include "tests/paper/visit.h"

namespace rigcal::paper {

struct MethodSample {
  Vector6d difference;        // Log(T_first^-1 T_second)
  Vector6d sigma_difference;  // errors that both methods share cancel in it
  Vector6d sigma_first, sigma_second;
  Vector6d error_first, error_second;  // against the truth
};

struct MethodPair {
  SensorId a, b;
  std::vector<MethodSample> samples;  // one per visit
};

struct MethodFamily {
  std::string first, second;  // the methods, in words
  std::vector<MethodPair> pairs;
  double within_3_sigma_ratio = 0.0;  // of the coordinates of all differences
  double rms_sigmas = 0.0;            // of the differences over their sigmas: 1, if the sigmas are right
  std::size_t coordinates = 0;
};

struct MethodExperiment {
  std::vector<MethodFamily> families;
};

[[nodiscard]] MethodExperiment RunMethodExperiment(const std::vector<Visit>& visits);
[[nodiscard]] Section MethodSection(const MethodExperiment& experiment);

}  // namespace rigcal::paper
