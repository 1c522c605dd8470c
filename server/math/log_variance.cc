#include "server/math/log_variance.h"

#include <boost/math/special_functions/digamma.hpp>
#include <boost/math/special_functions/trigamma.hpp>
#include <cmath>
#include <limits>

namespace rigcal {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr double kLeastDof = 1e-3, kMostDof = 1e9;  // between which the inverse is sought
constexpr int kBisections = 100;

}  // namespace

double LogVarianceBias(double dof) {
  if (!(dof > 0)) return -kUnbounded;
  return std::isfinite(dof) ? boost::math::digamma(dof / 2) - std::log(dof / 2) : 0.0;
}

double LogVarianceSpread(double dof) {
  if (!(dof > 0)) return kUnbounded;
  return std::isfinite(dof) ? boost::math::trigamma(dof / 2) : 0.0;
}

double DofOfLogVarianceSpread(double spread) {
  if (!(spread > LogVarianceSpread(kMostDof))) return kUnbounded;
  if (spread >= LogVarianceSpread(kLeastDof)) return 0.0;
  double low = std::log(kLeastDof), high = std::log(kMostDof);
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (LogVarianceSpread(std::exp(middle)) > spread ? low : high) = middle;
  }
  return std::exp(high);
}

}  // namespace rigcal
