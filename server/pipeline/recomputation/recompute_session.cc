#include "server/pipeline/recomputation/recompute_session.h"

#include "server/formats/boards/square_sizes.h"
#include "server/pipeline/edges/lost_payloads.h"
#include "server/pipeline/sessions/session_refinement.h"
#include "storage/sessions/session_estimates.h"
#include "storage/sessions/sessions.h"
#include "storage/work/attempts.h"

namespace rigcal::pipeline {
namespace {

using storage::RecomputationItem;

// What came of it, before it is stored.
struct ComputedAnew {
  SessionAnew how = SessionAnew::kSame;
  std::string why;
  std::optional<SessionEstimate> estimate;
  std::optional<Manifest> manifest;  // that `lost` points into
  std::vector<LostFile> lost;
};

// The store failed. Where files of the session are lost that is why, and it is kept; else it is tried again.
Result<ComputedAnew> KeptFor(const Error& error, storage::Store& store, const RecomputationItem& item) {
  ComputedAnew kept{SessionAnew::kKept, "", {}, {}, {}};
  RIGCAL_ASSIGN(kept.manifest, storage::LoadManifest(store, item.session));
  if (!kept.manifest) return Fail(error);
  std::vector<const Payload*> payloads;
  for (const Payload& payload : kept.manifest->payloads) payloads.push_back(&payload);
  RIGCAL_ASSIGN(kept.lost, FindLost(store, payloads));
  if (kept.lost.empty()) return Fail(error);
  kept.why = TellLost(item.robot, kept.lost).what + ". Push the session again, then ask once more.";
  return kept;
}

Result<ComputedAnew> ComputeAnew(storage::Store& store, const RecomputationItem& item, calib::CameraMemory& cameras) {
  RIGCAL_ASSIGN(const bool is_there,
                storage::HasSessionEstimate(store, item.session, storage::EstimatorNamed(item.estimator, item.sizes)));
  if (is_there) return ComputedAnew{};
  RIGCAL_ASSIGN(const SquareSizes sizes, formats::ReadSquareSizes(item.sizes));
  auto estimate = EstimateStored(store, item.session, sizes, cameras);
  if (!estimate)
    return estimate.error().code == ErrorCode::kStorage ? KeptFor(estimate.error(), store, item)
                                                        : Fail(estimate.error());
  if (*estimate) return ComputedAnew{SessionAnew::kComputed, "", std::move(*estimate), {}, {}};
  return ComputedAnew{
      SessionAnew::kKept, "Its pairs are not all calibrated, or wait for files that were lost.", {}, {}, {}};
}

}  // namespace

Status RecomputeSession(storage::Store& store, const RecomputationItem& item, const Clock& clock,
                        calib::CameraMemory& cameras) {
  RIGCAL_ASSIGN(const ComputedAnew done, ComputeAnew(store, item, cameras));
  return store.Write([&]() -> Status {
    const Stamp now = clock.Now();
    if (done.estimate)
      RIGCAL_TRY(storage::AppendSessionEstimate(store, *done.estimate,
                                                storage::EstimatorNamed(item.estimator, item.sizes), now));
    RIGCAL_TRY(AppendLost(store, done.lost, std::nullopt, now));
    RIGCAL_TRY(storage::EndAttempt(store, storage::WorkOfRecomputation(item), storage::AttemptEnd::kDone, "", now));
    return storage::FinishRecomputedSession(store, item, done.how, done.why, now);
  });
}

}  // namespace rigcal::pipeline
