// What speaks against a revision, one finding per kind: sentences without a final stop.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "server/fleet/assess.h"
#include "server/model/verdict_basis.h"

namespace rigcal::fleet {

struct Finding {
  std::string why;
  std::string what_to_do;
  std::vector<SensorId> accused = {};  // whom it is about by name; empty: nobody more than another
  DecidingFigure figure = {};          // that makes it a finding; empty: none
  std::int64_t captures = 0;           // that what_to_do asks for at least; 0: it does not say how many
  bool captures_are_of_pairs = false;  // of each pair; else in which one sensor sees something
};
// Sensors that all of these pairs have: both of a single pair, one, or none.
[[nodiscard]] std::vector<SensorId> SharedBy(const std::vector<std::pair<SensorId, SensorId>>& pairs);

// The edge that contradicts the others most, and by how much. What is off by so little that it does not matter
// (effect.h) contradicts nothing.
struct Contradiction {
  const Edge* edge = nullptr;
  Vector6d e = Vector6d::Zero();
};
// Nothing where no residual is beyond its limit.
[[nodiscard]] std::optional<Contradiction> MostContradicting(const std::vector<Edge>& edges,
                                                             const GraphSolution& solution, const Policy& policy);
// Edges of more than one session meet at these sensors: only then may one of them have been moved in between.
[[nodiscard]] bool MeetSessionsAt(const std::set<SensorId>& sensors, const std::vector<Edge>& edges);
// An edge that the others contradict by `e`.
[[nodiscard]] Finding DoNotFit(const Edge& edge, const Vector6d& e, const std::vector<Edge>& edges,
                               const Policy& policy);
// Sensors that had two poses during the newest session in which one had, by more than the policy's least move.
[[nodiscard]] std::optional<Finding> FindMovedWithin(const std::vector<SessionEstimate>& estimates,
                                                     const Policy& policy, const SessionTimes& captured_at);
// Sensors that in the newest session of each contradict all others in their last captures, and lidars that saw no board
// any more from one capture on: they may sit elsewhere since. With those whose poses are in doubt for it, which are all
// where it is the reference.
struct LateDoubts {
  std::vector<Finding> findings;
  std::vector<SensorId> sensors;
};
[[nodiscard]] LateDoubts FindLateDoubts(const std::vector<SessionEstimate>& estimates, const SessionTimes& captured_at);
// Boards that were moved during the newest session that was refined, though its pairs take them to stand still.
[[nodiscard]] std::optional<Finding> FindMovedBoards(const std::vector<SessionEstimate>& estimates,
                                                     const SessionTimes& captured_at);
// What to do where a sensor was not moved and an older session alone says otherwise: follows "Yes: ...".
[[nodiscard]] std::string CureOfOddSession(const SessionId& session, const SessionTimes& captured_at);
// Sensors that sat elsewhere from one session on, by more than the policy's least move.
[[nodiscard]] std::optional<Finding> FindMovedBetween(const GraphSolution& solution, const Policy& policy,
                                                      const SessionTimes& captured_at);
// Sensors that sat elsewhere in one session than in another by more than the policy's tolerance, though a loose mount
// may explain it (FusedSessions::apart), the worst first.
[[nodiscard]] std::optional<Finding> FindApart(const GraphSolution& solution, const Policy& policy,
                                               const SessionTimes& captured_at);
// The worst of those between the least move and the tolerance, of sensors of two visits; without a stop, empty of none.
[[nodiscard]] std::string ApartRemark(const GraphSolution& solution, const Policy& policy,
                                      const SessionTimes& captured_at);
// Who these two, and FindMovedBetween of the session named, tell to have sat elsewhere than in another session.
[[nodiscard]] std::vector<SensorMovedBetween> ToldElsewhere(const GraphSolution& solution, const Policy& policy,
                                                            const SessionId& newest);
// "moved right", "lens_changed left": by which lists of robots count the sensors of FindMovedWithin, or where it finds
// none of FindMovedBetween; each once.
[[nodiscard]] std::vector<std::string> KeysOfMoves(const std::vector<SessionEstimate>& estimates,
                                                   const GraphSolution& solution, const Policy& policy);
// The first of those moves, within a session or between two, that are no more than that; without a stop, empty of none.
[[nodiscard]] std::string SmallMoves(const std::vector<SessionEstimate>& estimates, const GraphSolution& solution,
                                     const Policy& policy, const SessionTimes& captured_at);
// What pairs contradict each other in, less where all of them are of sessions that were refined as a whole: whether one
// rig is behind these is asked of all that their sensors saw at once, and what their pairs say enters no pose. What is
// off by more than the policy's plain limits stays all the same, but where a board moved that its pairs took to stand
// still, or given intrinsics are known to be wrong.
[[nodiscard]] GraphSolution WithoutRefinedPairs(const std::vector<Edge>& edges, const GraphSolution& solution,
                                                const Policy& policy, const std::vector<SessionEstimate>& estimates);
// The largest that pairs disagree in beyond the policy's limits, though it counts for nothing (WithoutRefinedPairs):
// without a stop, empty where there is none. Where there is, edges do not agree.
[[nodiscard]] std::string ExcusedDisagreement(const std::vector<Edge>& edges, const GraphSolution& solution,
                                              const Policy& policy, bool pairs_disagree);
// Cameras whose pictures are bent beyond their model, the worst first, each by the newest session that it took part in:
// those that make a pose less certain by half or more, or, where edges disagree for it, all.
[[nodiscard]] std::optional<Finding> FindLensMisfits(const std::vector<SessionEstimate>& estimates,
                                                     bool edges_disagree);
// Likewise of accused sensors, whatever it adds: it may be what is behind a loop or a contradiction.
[[nodiscard]] std::optional<Finding> FindLensBehind(const std::vector<SessionEstimate>& estimates,
                                                    const std::set<SensorId>& accused);
// Cameras whose given intrinsics are not those of their lens, by a tenth of the policy's tolerance of angles or more,
// each by the newest session that it took part in.
// `is_beyond`: by more than the policy's tolerance of angles, so that whoever projects with them is wrong by as much.
struct WrongIntrinsics {
  Finding finding;
  bool is_beyond = false;
};
[[nodiscard]] std::optional<WrongIntrinsics> FindWrongIntrinsics(const std::vector<SessionEstimate>& estimates,
                                                                 const Policy& policy);
// Sensors of which a move beyond the policy's tolerance could have stayed unseen, by the newest session that tells of
// each.
[[nodiscard]] std::optional<Finding> FindUnseenMoves(const std::vector<SessionEstimate>& estimates,
                                                     const Policy& policy, const SessionTimes& captured_at);
// What cameras saw in single captures of the newest session that contradicts what was seen besides, as a picture of
// another instant does: it counts for next to nothing, so no pose suffers. Of a lidar a board among other surfaces is
// left out in sound sessions, too: no news.
[[nodiscard]] std::optional<Finding> FindHeldBack(const GraphSolution& solution, const SessionHeaders& headers);
// Lidars that the newest session finds to measure too long or too short at a slant, boards that are bent or that lenses
// make look so, and clocks of trackers that are off: taken out, so no more than news.
[[nodiscard]] std::string TakenOutRemark(const std::vector<SessionEstimate>& estimates);
// The newest session, where it says enough to be refined as a whole and could not be.
[[nodiscard]] std::optional<Finding> FindUnrefined(const std::vector<SessionEstimate>& estimates,
                                                   const SessionTimes& captured_at);
// The smallest move that every one of the sensors' newest sessions would have shown, as a sentence that names the known
// sensors of which no session tells; of a newest session that could not be refined as a whole, that nothing is known
// of moves. Empty where there is no session.
[[nodiscard]] std::string SmallestMoveNoticed(const std::vector<SessionEstimate>& estimates,
                                              const GraphSolution& solution);
// A sensor whose edges fall into two groups; no side is chosen.
[[nodiscard]] std::optional<Finding> FindTwoPoses(const std::vector<Edge>& edges, const GraphSolution& solution,
                                                  const Policy& policy, const SessionTimes& captured_at);
// Edges that the robust optimum rejects, the worst first; a loop that alone does not close is named whole.
[[nodiscard]] std::optional<Finding> FindSuspectEdges(const std::vector<Edge>& edges, const GraphSolution& solution,
                                                      const Policy& policy);
// Edges in loops that check them in no direction. Bridges are left to FindUncheckedSensors.
[[nodiscard]] std::optional<Finding> FindUncheckedEdges(const std::vector<Edge>& edges, const GraphSolution& solution,
                                                        const Policy& policy);
// Edges that are checked in some directions, or so roughly that an error of their tolerance would not have shown,
// though they agree: of which half or axis (check_gaps.h), and how well the others tell it. Where one weak edge is
// behind all of it, that is named. What an edge does not say to its own tolerance is left to FindUncertainSensors.
[[nodiscard]] std::vector<Finding> FindHardlyChecked(const std::vector<Edge>& edges, const GraphSolution& solution,
                                                     const Policy& policy, const OtherPaths& others);
// Each of those edges, with all that is not checked of it, as a page says it beside the edge.
[[nodiscard]] std::vector<HardlyChecked> EdgesHardlyChecked(const std::vector<Edge>& edges,
                                                            const GraphSolution& solution, const Policy& policy,
                                                            const OtherPaths& others);
// Edges that something checks, but whose covariance comes from too few captures for a test of their residual.
[[nodiscard]] std::optional<Finding> FindUntestable(const std::vector<Edge>& edges, const GraphSolution& solution,
                                                    const Policy& policy);
// Independent edges of known information whose weighted cost is beyond chi-square for its degrees of freedom. Where
// information was estimated, or captures are shared, the cost is no chi-square.
[[nodiscard]] bool IsCostBeyondChance(const std::vector<Edge>& edges, const GraphSolution& solution,
                                      const Policy& policy);
// Loops that do not close, also where each edge alone hides it, by the cost where it is chi-square and something is off
// by enough to matter; else the loop that is furthest beyond the limit of its own test.
[[nodiscard]] std::optional<Finding> FindOpenLoops(const std::vector<Edge>& edges, const GraphSolution& solution,
                                                   const Policy& policy);
// Half a sentence where only edges were tested, one by one, and no loop; empty where loops were.
[[nodiscard]] std::string UntestedLoops(const std::vector<Edge>& edges, const GraphSolution& solution);
[[nodiscard]] std::optional<Finding> FindNoEdges(const std::vector<Edge>& edges);
[[nodiscard]] std::optional<Finding> FindUnsettled(const GraphSolution& solution);
// Sensors without a pose: what is known of those that are tied to the reference but for some directions; who is not
// tied at all, but for those that `explained` has.
[[nodiscard]] std::vector<Finding> FindUnknownSensors(const std::vector<Edge>& edges, const GraphSolution& solution,
                                                      const SessionHeaders& headers,
                                                      const std::set<SensorId>& explained);
// Known sensors that fewer than five captures, of all their good pairs and sessions, tie to the reference or to sensors
// that more do: what so few scatter tells nothing of how well a pose is known.
[[nodiscard]] std::vector<SensorId> SensorsOfFewCaptures(const std::vector<Edge>& edges, const GraphSolution& solution);
// Of these.
[[nodiscard]] Finding FewCapturesBehind(const std::vector<SensorId>& sensors, const std::vector<Edge>& edges);
// Of these, each of a pair of its own.
[[nodiscard]] std::optional<Finding> FindFailedEdges(const std::vector<const Edge*>& failures);
// Pairs that were measured in an earlier epoch of one of their sensors, as before it was remounted, and not since.
[[nodiscard]] std::optional<Finding> FindPastPairs(const std::vector<Edge>& edges);
// Pairs that were measured from fewer captures than the policy wants, as far as their edges say how many: those that
// were pushed by the degrees of freedom, or the blocks, of their covariance.
[[nodiscard]] std::optional<Finding> FindFewCaptures(const std::vector<Edge>& edges, const Policy& policy);
// Known sensors that are less certain than the policy wants, the worst first.
[[nodiscard]] std::vector<SensorId> UncertainSensors(const GraphSolution& solution, const Policy& policy);
// "top and right (28 mm, limit 5 mm)": these, and by how much the worst is; empty: there are none.
[[nodiscard]] std::string UncertainText(const GraphSolution& solution, const Policy& policy);
[[nodiscard]] std::optional<Finding> FindUncertainSensors(const GraphSolution& solution, const Policy& policy);
// Pairs that the policy names with a tolerance, and whose T_a_b is less certain (any axis, 1 sigma).
[[nodiscard]] std::optional<Finding> FindUncertainPairs(const Policy& policy, const PairCovariances& covariances);
// Sensors that hang on a single edge (a bridge of the graph): nothing checks them. All of them, if there is no loop.
[[nodiscard]] std::optional<Finding> FindUncheckedSensors(const std::vector<Edge>& edges,
                                                          const GraphSolution& solution);

}  // namespace rigcal::fleet
