// Failed edges as their causes look at them, and what their sessions say of the sensors and boards behind them.
#pragma once

#include <array>
#include <initializer_list>
#include <optional>
#include <string_view>
#include <vector>

#include "server/fleet/assess.h"

namespace rigcal::fleet {

// Of each pair without a good edge the failed one of its newest session; past ones do not count. Of the session that
// was captured last also those of pairs that older sessions know: all, where each of its pairs failed; else those of a
// sensor no pair of which is good in it, though it saw enough. In the order of `edges`.
[[nodiscard]] std::vector<const Edge*> FindOpenFailures(const std::vector<Edge>& edges,
                                                        const SessionTimes& captured_at);
// By its first diagnosis.
[[nodiscard]] bool FailedFor(const Edge& edge, std::initializer_list<std::string_view> codes);
// One of its sensors was moved while its session was captured, as it tells by itself.
[[nodiscard]] bool TellsMove(const Edge& edge);
// Too few captures in which both sensors saw something, whatever the method.
[[nodiscard]] bool SawTooLittle(const Edge& edge);

// One sensor of an edge, with the figures that the edge tells of it.
struct EdgeEnd {
  const Edge* edge = nullptr;
  SensorId sensor;
  const char* side = "_a";  // or "_b", as the figures have it
  // Of "files" or "board_tilt", with its unit "" or "_rad".
  [[nodiscard]] std::optional<double> Figure(const std::string& name, const char* unit = "") const;
};
// Frame a's end, then frame b's; valid as long as `edge`.
[[nodiscard]] std::array<EdgeEnd, 2> EndsOf(const Edge& edge);
[[nodiscard]] bool IsEndOf(const Edge& edge, const SensorId& sensor);

// Why a sensor saw nothing in most captures of a pair.
enum class Loss { kNoFile, kUnreadable, kNoBoard };
// In how many captures of a failed pair one of its sensors saw a board, and what became of the others.
struct Sight {
  double captures = 0.0, files = 0.0, unreadable = 0.0, with_board = 0.0;
  // Captures of which the sensor has a file that can be read.
  [[nodiscard]] double readable() const { return files - unreadable; }
  // It saw a board in less than half of them.
  [[nodiscard]] bool IsSeldom() const { return 2 * with_board < captures; }
  // What keeps it from most of them; of equals a missing file, then one that cannot be read.
  [[nodiscard]] Loss LargestLoss() const;
};
// Nothing where the edge does not tell.
[[nodiscard]] std::optional<Sight> SightOf(const EdgeEnd& end);
struct Blind {
  EdgeEnd end;
  Sight sight;
};
// The end that saw a board in fewest captures, if in less than half of them; of equals the one that lacks files.
[[nodiscard]] std::optional<Blind> BlindEndOf(const Edge& edge);

// Those of sessions that something measured is of: what nothing was measured in any more says nothing of the rig.
[[nodiscard]] SessionHeaders WithoutPast(const SessionHeaders& headers, const std::vector<Edge>& edges);
[[nodiscard]] std::vector<const SessionHeader*> NewestFirst(const SessionHeaders& headers);
// As the edge's session lists it; null where that is not known.
[[nodiscard]] const Sensor* SensorOf(const SessionHeaders& headers, const Edge& edge, const SensorId& sensor);
// By that, or by the edge's method where both its sensors are of one kind.
[[nodiscard]] std::optional<SensorKind> KindOf(const SessionHeaders& headers, const Edge& edge, const SensorId& sensor);
// Boards that this sensor may have looked at for this edge; none where that is not known.
[[nodiscard]] std::vector<const Target*> BoardsOf(const SessionHeaders& headers, const EdgeEnd& end);

// The known sensor without uncertainty; null: there is none.
[[nodiscard]] const SensorPose* ReferenceOf(const GraphSolution& solution);

}  // namespace rigcal::fleet
