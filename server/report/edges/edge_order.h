// Edges as the report shows them: joined with their residuals, failed first, then the worst fit, past ones last.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "server/report/render.h"

namespace rigcal::report {

struct ShownEdge {
  const Edge* edge = nullptr;
  const EdgeResidual* residual = nullptr;  // nullptr: not in the solution
  bool detailed = false;                   // has a section of its own
  double in_sigmas = 0.0;  // sqrt(T^2 / rank) by the covariance of this residual, else sqrt(e^T Omega e / rank)
  std::string anchor;      // of the section
  int detailed_in = 0;     // the revision whose report has the section; 0: this one, if any
};
// `detailed_in`: ReportInput's.
[[nodiscard]] std::vector<ShownEdge> InOrder(const formats::RevisionInput& revision,
                                             const std::map<EdgeId, int>& detailed_in = {});
// Edges that are worth a look although they were shown before: they failed, contradict others or may be behind it, or
// are beyond the limit of their test.
[[nodiscard]] std::set<EdgeId> WorthDetails(const ReportInput& input);

// How much of a very large graph goes into one page; the rest is in revision.json, edges.csv and `rigcal show --whole`.
inline constexpr std::size_t kPoseRowsMax = 3000;
inline constexpr std::size_t kEdgeRowsMax = 5500;
inline constexpr std::size_t kDetailItemsMax = 6000;    // captures + pictures + diagnoses, all sections together
inline constexpr std::size_t kPicturesPerEdgeMax = 24;  // the session's page has all
inline constexpr std::size_t kManySections = 24;        // of more edges than this half as many pictures are shown

}  // namespace rigcal::report
