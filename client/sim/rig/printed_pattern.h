// What is black on a printed board, to be seen sharp or blurred.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "client/print/pattern.h"
#include "client/sim/views/soft_edge.h"

namespace rigcal::sim {

// Rectangles and discs in bins, so that what is near a point is found at once. Coordinates a and b run along columns
// and rows from the middle of the plate, metres.
class PrintedPattern {
 public:
  // `target` must be valid. kInvalidInput where its dictionary has too few markers.
  [[nodiscard]] static Result<PrintedPattern> Of(const Target& target);
  [[nodiscard]] bool IsBlack(const Eigen::Vector2d& ab_m) const;
  // The part that is black of what a Gaussian point spread of sigmas `blur_m` (> 0) along a and b takes in.
  [[nodiscard]] float Black(const Eigen::Array2f& ab_m, const Eigen::Array2f& blur_m, const SoftEdge& edge) const;

 private:
  static constexpr int kBins = 64;  // each way

  struct Shape {
    Eigen::Array2f low, high;  // its box
    bool is_disc = false;
  };

  void Add(const Eigen::Array2d& low_m, const Eigen::Array2d& high_m, bool is_disc);
  [[nodiscard]] Eigen::Array2i BinOf(const Eigen::Array2f& place) const;
  // Calls `see` once with each shape whose bins meet the box from `low` to `high`.
  template <typename See>
  void Near(const Eigen::Array2f& low, const Eigen::Array2f& high, const See& see) const;

  Eigen::Array2f low_ = Eigen::Array2f::Zero(), bin_m_ = Eigen::Array2f::Ones();  // of all
  std::vector<Shape> shapes_;
  std::vector<std::vector<int>> bins_;  // row by row
};

}  // namespace rigcal::sim
