// The figures of a certificate: how certain poses are, how far off they were found, and what a limit says of both.
#pragma once

#include <optional>

#include "server/formats/documents.h"
#include "server/model/sessions/as_found.h"

namespace rigcal::report {

// Guarded acceptance (JCGM 106:2012, 8.3.2), the guard band being U: what is open may be within or beyond.
enum class Conformity { kNoLimit, kWithin, kOpen, kBeyond };  // kNoLimit: there is none
// Of |off| and U, the half-width of the interval that holds it with 95 %: within where |off| + U is at most the limit,
// beyond where |off| - U is more. All in one unit.
[[nodiscard]] Conformity Decide(double off, double U, double limit);
// Of two that both have to be kept.
[[nodiscard]] Conformity Worse(Conformity a, Conformity b);

// k of U = k sigma, the half-width of the interval that holds the value with a probability of 95 %: of Student's t by
// the degrees of freedom behind the pose's covariance (JCGM 100:2008 (GUM), 6.2 and G.3); of the normal distribution
// where that is not estimated from how captures scatter but follows from the noise, or was given (0; G.4.2). Absent of
// a pose that is not known as a whole.
[[nodiscard]] std::optional<double> CoverageFactor(const SensorPose& pose);

// Of three shifts, in m, or three turns, in rad, the worst.
struct CertifiedFigure {
  std::optional<double> sigma, U, limit;  // what is not known, or not finite, is absent
  Conformity decision = Conformity::kNoLimit;
};
struct CertifiedPose {
  std::optional<double> k;
  CertifiedFigure shift, turn;
  Conformity decision = Conformity::kNoLimit;  // of both
};
// Of a pose that is known, whole or in part (then of what was measured of it). It is its own best estimate, so that off
// is 0; beyond its limit is what has a sigma beyond it.
[[nodiscard]] CertifiedPose CertifiedPoseOf(const SensorPose& pose, const formats::RevisionInput& revision);

// As found and as left, of the axes that were measured: k is 2, as nobody knows degrees of freedom for what visits
// scatter by.
struct FoundFigure {
  std::optional<double> off, U, limit, left;   // off and U on the axis that was off most; m or rad
  Conformity decision = Conformity::kNoLimit;  // over these axes; open at best where one was not measured
};
struct FoundFigures {
  FoundFigure shift, turn;
  Conformity decision = Conformity::kNoLimit;
};
// `needs_all`: an axis that was not measured leaves the decision open.
[[nodiscard]] FoundFigures FoundFiguresOf(const SensorFound& found, const std::optional<PoseLimit>& limit,
                                          bool needs_all);

}  // namespace rigcal::report
