#include "server/pipeline/pages/trend_data.h"

#include <algorithm>
#include <map>
#include <memory>

#include "server/formats/documents.h"
#include "server/pipeline/robots/robot_rows.h"
#include "server/pipeline/sessions/session_refinement.h"
#include "server/report/robot_pages.h"
#include "storage/revisions/merged_edges.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/session_estimates.h"
#include "storage/sessions/sessions.h"

namespace rigcal::pipeline {
namespace {

constexpr std::int64_t kTrendRevisionsMax = 24;
constexpr std::size_t kTrendBytesMax = 64u << 20;

Result<std::vector<report::SolvedRevision>> LoadSolved(const AnswerContext& context, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto revisions, storage::LoadRevisions(context.store, robot, 0, kTrendRevisionsMax));
  std::vector<report::SolvedRevision> solved;
  std::size_t bytes = 0;
  for (const Revision& revision : revisions) {
    if (bytes >= kTrendBytesMax) break;
    RIGCAL_ASSIGN(const Revision whole, LoadRevisionOf(context.store, robot, revision.number));
    RIGCAL_ASSIGN(auto document, formats::ReadRevisionDocument(whole.document));
    bytes += whole.document.size();
    solved.push_back({whole.number, std::make_shared<const formats::RevisionInput>(std::move(document)),
                      whole.calibrated_at.value_or(Stamp{})});
  }
  std::reverse(solved.begin(), solved.end());
  return solved;
}

std::vector<SensorPose> PosesOf(const SessionEstimate& estimate) {
  std::vector<SensorPose> poses;
  for (std::size_t i = 0; i < estimate.poses.size(); ++i) {
    SensorPose pose;
    pose.sensor = estimate.poses[i].sensor;
    pose.known = true;
    pose.T_ref_sensor = estimate.poses[i].T_ref_sensor;
    if (const int row = RowOf(estimate, i); row >= 0) pose.covariance = estimate.covariance.block<6, 6>(row, row);
    poses.push_back(pose);
  }
  return poses;
}

struct Visits {
  std::vector<report::Visit> visits;  // the oldest first
  std::vector<Epoch> epochs;
};

// Of sessions that count, as the joint refinement of each alone has it.
Result<Visits> LoadVisits(const AnswerContext& context, const RobotId& robot) {
  RIGCAL_ASSIGN(auto counts, storage::LoadWhatCounts(context.store, robot));
  RIGCAL_ASSIGN(const auto captured_at, storage::LoadCapturedAt(context.store, robot));
  RIGCAL_ASSIGN(const auto rows,
                storage::LoadSessionEstimates(context.store, robot, kSessionEstimator, kSessionsFused));
  Visits found;
  for (const storage::SessionEstimateRow& row : rows) {
    if (!row.estimate || !row.estimate->why_not.empty() || !captured_at.contains(row.session)) continue;
    found.visits.push_back({row.session, captured_at.at(row.session), row.estimate->reference, PosesOf(*row.estimate)});
  }
  std::reverse(found.visits.begin(), found.visits.end());
  found.epochs = std::move(counts.epochs);
  return found;
}

}  // namespace

Result<PageText> AnswerTrend(const AnswerContext& context, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto solved, LoadSolved(context, robot));
  Visits found;
  RIGCAL_TRY(context.store.Read([&]() -> Status {
    RIGCAL_ASSIGN(found, LoadVisits(context, robot));
    return {};
  }));
  return PageText{report::TrendData(solved, found.visits, found.epochs), "text/javascript; charset=utf-8"};
}

}  // namespace rigcal::pipeline
