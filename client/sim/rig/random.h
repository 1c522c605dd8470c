// Random numbers that depend on a key only, never on threads, order or the standard library's distributions.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <initializer_list>
#include <string_view>

namespace rigcal::sim {

// What a stream is for: streams of different keys are independent.
[[nodiscard]] std::uint64_t KeyOf(std::uint64_t seed, std::string_view purpose, std::string_view name = {},
                                  std::uint64_t idx = 0);

// A counter run through a mixing function (Steele, Lea & Flood 2014: SplitMix).
class Random {
 public:
  // The stream of this key, from its beginning.
  explicit Random(std::uint64_t key) : state_(key) {}
  [[nodiscard]] std::uint64_t Bits();                     // 64, each as likely 0 as 1
  [[nodiscard]] double Uniform();                         // [0, 1)
  [[nodiscard]] double Uniform(double low, double high);  // [low, high)
  [[nodiscard]] double Normal();                          // mean 0, standard deviation 1 (Box & Muller)
  // Independent, each as Normal().
  template <int kRows>
  [[nodiscard]] Eigen::Matrix<double, kRows, 1> Normals() {
    Eigen::Matrix<double, kRows, 1> values;
    for (int i = 0; i < kRows; ++i) values[i] = Normal();
    return values;
  }

 private:
  std::uint64_t state_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace rigcal::sim
