// The paper's experiment on its robot (section IV-B): E_global of 12 sensors and 59 edges before and after the global
// optimisation, here with the truth known.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tests/paper/joint_errors.h"
#include "tests/paper/page.h"
#include "tests/paper/visit.h"

namespace rigcal::paper {

// What the paper measured on its robot.
constexpr double kPaperBefore = 0.0149, kPaperAfter = 0.0126;

// One solved graph against the truth.
struct GlobalSample {
  GlobalError before, after;
  double pose_m2 = 0.0, pose_rad2 = 0.0;  // mean over the sensors but the reference, of the squared errors
  double cost = 0.0;                      // sum e^T Omega e at the optimum
  double whitened_ratio = 0.0;            // errors of the edges against the truth, from the solution over as measured
};

// Many graphs under one kind of errors, solved with one kind of information.
struct GlobalRun {
  std::vector<GlobalSample> samples;
  double predicted_before = 0.0, predicted_after = 0.0;  // means by the linear prediction
  double predicted_pose_m2 = 0.0, predicted_pose_rad2 = 0.0;
  // Of the mean over the samples, relative to its prediction: how far apart the two may be.
  double variance_before_ratio = 0.0, variance_after_ratio = 0.0;

  [[nodiscard]] GlobalSample Mean() const;
  [[nodiscard]] Interval IntervalBefore() const { return IntervalOf(2 / variance_before_ratio); }
  [[nodiscard]] Interval IntervalAfter() const { return IntervalOf(2 / variance_after_ratio); }
};
struct GlobalRuns {
  GlobalRun full, diagonal;  // information; diagonal as in the paper: one over each variance
};

// What the estimators say of one pair where the sensors themselves are as noisy as E_global would have it.
struct NoisyPair {
  SensorId a, b;
  std::string method;
  std::string refusal;  // empty: an edge, with this error
  double error_m = 0.0, error_rad = 0.0;
};

struct GlobalExperiment {
  std::size_t edges_min = 0;  // good ones, in the visit that has the fewest
  std::size_t sensors = 0, captures = 0;
  int draws = 0;
  GlobalRuns visits;     // edges by the estimators, one sample per visit
  GlobalRuns realistic;  // errors of independent edges drawn from their own covariances
  GlobalRuns paper;      // the same, larger by noise_factor: E_global before is the paper's
  double noise_factor = 0.0;
  int dof = 0;                                  // of the weighted cost with full information
  double edge_rms_m = 0.0, edge_rms_rad = 0.0;  // of one edge's error, realistic
  std::vector<NoisyPair> noisy_pairs;           // of four methods, at noise_factor

  // Of drawn errors with full information: the mean cost over its degrees of freedom, and the part of the weighted
  // noise that the poses keep, a ratio of chi-squares (beta distribution); but for odds of 1e-6.
  [[nodiscard]] Interval CostInterval() const { return IntervalOf(static_cast<double>(draws) * dof); }
  [[nodiscard]] double WhitenedExpected() const;
  [[nodiscard]] double WhitenedHalfWidth() const;
};

// `draws`: of each kind of drawn errors; they follow the first visit's edges.
// An error if a visit left sensors without a chain of good edges to the reference.
[[nodiscard]] Result<GlobalExperiment> RunGlobalExperiment(const std::vector<Visit>& visits, int draws,
                                                           std::uint64_t seed);
// `how`: as for the visits; which pairs is chosen here.
[[nodiscard]] Result<std::vector<NoisyPair>> TryNoisySensors(const sim::Experiment& like, double noise_factor,
                                                             VisitOptions how);
[[nodiscard]] Section GlobalSection(const GlobalExperiment& experiment);

}  // namespace rigcal::paper
