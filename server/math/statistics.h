// Quantiles and limits for judging residuals (through Boost.Math).
#pragma once

namespace rigcal {

// The value below which a statistic lies with this probability, 0 to 1; infinite at 1, zero without freedom.
[[nodiscard]] double ChiSquareQuantile(double probability, double dof);
[[nodiscard]] double ChiSquareTail(double statistic, double dof);        // P(X >= statistic)
[[nodiscard]] double FisherTail(double statistic, double p, double nu);  // P(F(p, nu) >= statistic); 1 without freedom
[[nodiscard]] double FisherQuantile(double tail, double p,
                                    double nu);  // FisherTail's inverse; infinite without freedom
// Noncentrality at which F(p, nu) is beyond `limit` with this probability: the power of a test. Infinite without
// freedom.
[[nodiscard]] double FisherNoncentrality(double limit, double p, double nu, double power);
[[nodiscard]] double StudentQuantile(double probability, double dof);
// 95 % limit of T^2 = e^T C^-1 e with C estimated from m blocks: p nu/(nu-p+1) F_.95(p, nu-p+1), nu = m-1, p = 6
// (16.4 at m = 40). Infinite where nu < p. With known C use ChiSquareQuantile(0.95, 6).
[[nodiscard]] double HotellingLimit(int m, int p = 6, double probability = 0.95);

}  // namespace rigcal
