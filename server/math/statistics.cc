#include "server/math/statistics.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/non_central_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

namespace rigcal {
namespace {

namespace policies = boost::math::policies;
// No exceptions: a quantile at probability 1 is infinite.
using Quiet =
    policies::policy<policies::domain_error<policies::ignore_error>, policies::overflow_error<policies::ignore_error>,
                     policies::evaluation_error<policies::ignore_error>>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNoncentralityMax = 1e6;  // beyond it no test of ours has any power

}  // namespace

double ChiSquareQuantile(double probability, double dof) {
  if (!(dof > 0) || probability <= 0) return 0.0;  // without freedom the statistic is always zero
  if (probability >= 1) return kInfinity;
  return boost::math::quantile(boost::math::chi_squared_distribution<double, Quiet>(dof), probability);
}

double ChiSquareTail(double statistic, double dof) {
  if (statistic <= 0) return 1.0;
  if (!(dof > 0) || !std::isfinite(statistic)) return 0.0;
  return boost::math::cdf(complement(boost::math::chi_squared_distribution<double, Quiet>(dof), statistic));
}

double FisherTail(double statistic, double p, double nu) {
  if (!(statistic > 0) || !(p > 0) || !(nu > 0)) return 1.0;
  if (!std::isfinite(statistic)) return 0.0;
  return boost::math::cdf(complement(boost::math::fisher_f_distribution<double, Quiet>(p, nu), statistic));
}

double FisherQuantile(double tail, double p, double nu) {
  if (!(p > 0) || !(nu > 0) || tail <= 0) return kInfinity;
  if (tail >= 1) return 0.0;
  return boost::math::quantile(complement(boost::math::fisher_f_distribution<double, Quiet>(p, nu), tail));
}

double FisherNoncentrality(double limit, double p, double nu, double power) {
  if (!(p > 0) || !(nu > 0) || !std::isfinite(limit)) return kInfinity;
  const auto missed = [&](double noncentrality) {
    const boost::math::non_central_f_distribution<double, Quiet> fisher(p, nu, noncentrality);
    return boost::math::cdf(fisher, limit) - (1 - power);
  };
  double high = p * limit + 1;
  if (high > kNoncentralityMax) return kInfinity;  // the distribution is not to be had there
  while (missed(high) > 0) {
    high *= 2;
    if (high > kNoncentralityMax) return kInfinity;
  }
  if (missed(0) <= 0) return 0.0;
  std::uintmax_t rounds = 100;
  const auto root =
      boost::math::tools::toms748_solve(missed, 0.0, high, boost::math::tools::eps_tolerance<double>(30), rounds);
  return (root.first + root.second) / 2;
}

double StudentQuantile(double probability, double dof) {
  if (probability <= 0) return -kInfinity;
  if (probability >= 1) return kInfinity;
  if (probability == 0.5) return 0.0;
  if (!(dof > 0)) return probability > 0.5 ? kInfinity : -kInfinity;
  return boost::math::quantile(boost::math::students_t_distribution<double, Quiet>(dof), probability);
}

double HotellingLimit(int m, int p, double probability) {
  const int nu = m - 1;
  if (nu < p || probability >= 1) return kInfinity;
  if (p < 1 || probability <= 0) return 0.0;
  const double rest = nu - p + 1;
  const boost::math::fisher_f_distribution<double, Quiet> fisher(p, rest);
  return p * nu / rest * boost::math::quantile(fisher, probability);
}

}  // namespace rigcal
