// What failures of pairs have in common, and what else is wrong with a rig as a whole: each cause once, however many
// pairs it fails, with one thing to do.
#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "server/fleet/findings/failures.h"
#include "server/fleet/findings/findings.h"
#include "server/model/robots/rig_model.h"

namespace rigcal::fleet {

enum class CauseKind {
  kExchanged,         // two sensors sit where the drawing has the other, and others bear it out
  kFilesMissing,      // a sensor without files of most captures
  kFilesUnreadable,   // a sensor most of whose files cannot be read
  kPositionsUnit,     // a tracker whose positions look like millimetres
  kBoardCounts,       // a board that no camera finds in any picture
  kBoardSize,         // a board that cameras together with lidars or trackers see larger or smaller than given
  kLensModel,         // a camera that another lens model fits
  kMovedWithin,       // sensors of which one was moved while the session was captured, as their pair by itself tells
  kBoardTilt,         // boards that all face one way
  kBoardPlaces,       // boards in a part of the picture only
  kBoardUnseen,       // a sensor that sees a board in almost none of its files, and that nothing ties in its session
  kShortSession,      // a session of a few captures
  kFarFromNominal,    // sensors that are not where the drawing has them; or two that sit where it has the other, for
                      // which it may be to blame as well
  kNominalUnit,       // sensors that are drawn a thousand times as far away as they are
  kNotMeasured,       // sensors that no edge names
  kSensorMissing,     // sensors of the rig model that nothing of the robot names
  kSensorKind,        // a sensor that is of another kind in the rig model
  kPairMissing,       // pairs that the rig model requires, without a good edge
  kOffRigModel,       // a sensor farther from where the rig model has it than its tolerance
  kReferenceNotDrawn  // the rig model has places, but none of the robot's reference
};

struct RootCause {
  CauseKind kind = CauseKind::kNotMeasured;
  std::vector<SensorId> sensors;    // that it is about
  std::vector<TargetId> boards;     // likewise
  std::vector<CaptureId> captures;  // likewise: the first whose file cannot be read; the two between which it moved
  std::vector<EdgeId> edges;        // that it explains, of FindOpenFailures(); none: it failed no pair
  Finding said;
  std::string command;                 // to copy when it is done; empty: none
  std::vector<SensorId> doubted = {};  // have poses that are not to be relied on: taken for each other, or mis-scaled
  std::string effect = {};             // half a sentence: what these poses suffer by it; empty: it is plain
  std::string trait = {};              // tells it from others of its kind about the same: "larger"; a word, or empty
};

// Sensors that are exchanged first, then by the number of edges that a cause explains. An edge has one cause, but where
// lenses of both its cameras are to blame. `headers`: of the sessions of the edges; without them boards have no names,
// and nothing is held against a drawing. `expected`: of the robot's rig model; of sensors that are `retired` nobody
// asks.
[[nodiscard]] std::vector<RootCause> FindRootCauses(const std::vector<Edge>& edges, const GraphSolution& solution,
                                                    const SessionHeaders& headers, const SessionTimes& captured_at,
                                                    const ExpectedRig& expected = {},
                                                    const std::set<SensorId>& retired = {});
// What is done about these is the same, whichever sensors they failed: no sensor is to blame.
[[nodiscard]] bool IsOfTheSession(CauseKind kind);
// The sentence and the action, with the command.
[[nodiscard]] Finding FindingOf(const RootCause& cause);
// Edges that it explains are of the session that was captured last; without times of any too.
[[nodiscard]] bool IsOfNewestVisit(const RootCause& cause, const std::vector<Edge>& edges,
                                   const SessionTimes& captured_at);
[[nodiscard]] std::set<EdgeId> ExplainedBy(const std::vector<RootCause>& causes);

// What the causes are looked for in. `open` has the failures that no cause found so far explains.
struct CauseSearch {
  const std::vector<Edge>& edges;
  const GraphSolution& solution;
  const SessionHeaders& headers;
  const SessionTimes& captured_at;
  const ExpectedRig& expected;
  const std::set<SensorId>& retired;
  std::vector<const Edge*> open = {};
  std::vector<RootCause> causes = {};

  // Takes those of which `is_so` out of `open`.
  template <typename IsSo>
  std::vector<const Edge*> Take(const IsSo& is_so) {
    const auto taken = std::stable_partition(open.begin(), open.end(), [&](const Edge* edge) { return !is_so(*edge); });
    std::vector<const Edge*> explained(taken, open.end());
    open.erase(taken, open.end());
    return explained;
  }
};
// In the same order.
[[nodiscard]] std::vector<EdgeId> IdsOf(const std::vector<const Edge*>& edges);

// One per kind of cause, in the order in which they are asked: what is certain before what it may look like.
void FindFileCauses(CauseSearch& search);      // kFilesMissing, kFilesUnreadable
void FindPositionsUnits(CauseSearch& search);  // kPositionsUnit
void FindNominalUnits(CauseSearch& search);    // kNominalUnit
void FindBoardCounts(CauseSearch& search);     // kBoardCounts
void FindExchanged(CauseSearch& search);       // kExchanged, kFarFromNominal of two
void FindBoardSizes(CauseSearch& search);      // kBoardSize
void FindLensModels(CauseSearch& search);      // kLensModel
void FindMovedPairs(CauseSearch& search);      // kMovedWithin
void FindAlikeBoards(CauseSearch& search);     // kBoardTilt, kBoardPlaces
void FindUnseenBoards(CauseSearch& search);    // kBoardUnseen
void FindShortSessions(CauseSearch& search);   // kShortSession
void FindFarFromNominal(CauseSearch& search);  // kFarFromNominal; after FindNominalUnits and FindExchanged
void FindNotMeasured(CauseSearch& search);     // kNotMeasured

constexpr const char* kPushAgain = "rigcal push FOLDER";
constexpr const char* kCheckFirst = "rigcal check FOLDER";
constexpr int kCapturesMore = 8;  // that are asked for where boards were too few or too much alike

}  // namespace rigcal::fleet
