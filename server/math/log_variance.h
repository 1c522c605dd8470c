// The log of a variance that was estimated: s^2 = sigma^2 X / nu, X a chi-square of nu degrees of freedom.
#pragma once

namespace rigcal {

// E log(s^2 / sigma^2) = digamma(nu / 2) - log(nu / 2), below zero; minus infinity without freedom.
[[nodiscard]] double LogVarianceBias(double dof);
// Var log s^2 = trigamma(nu / 2); infinite without freedom.
[[nodiscard]] double LogVarianceSpread(double dof);
// The degrees of freedom at which LogVarianceSpread is that; infinite at zero or less, zero where it is infinite.
[[nodiscard]] double DofOfLogVarianceSpread(double spread);

}  // namespace rigcal
