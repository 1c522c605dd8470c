#include "server/fleet/causes/told_causes.h"

#include <algorithm>
#include <cctype>

#include "server/fleet/causes/cause_findings.h"

namespace rigcal::fleet {
namespace {

// The words of docs/api.md, for good: documents and lists of robots keep them.
const char* KindWord(CauseKind kind) {
  switch (kind) {
    case CauseKind::kExchanged:
      return "exchanged";
    case CauseKind::kFilesMissing:
      return "files_missing";
    case CauseKind::kFilesUnreadable:
      return "files_unreadable";
    case CauseKind::kPositionsUnit:
      return "positions_unit";
    case CauseKind::kBoardCounts:
      return "board_counts";
    case CauseKind::kBoardSize:
      return "board_size";
    case CauseKind::kLensModel:
      return "lens_model";
    case CauseKind::kMovedWithin:
      return "moved_within";
    case CauseKind::kBoardTilt:
      return "board_tilt";
    case CauseKind::kBoardPlaces:
      return "board_places";
    case CauseKind::kBoardUnseen:
      return "board_unseen";
    case CauseKind::kShortSession:
      return "short_session";
    case CauseKind::kFarFromNominal:
      return "far_from_nominal";
    case CauseKind::kNominalUnit:
      return "nominal_unit";
    case CauseKind::kSensorMissing:
      return "sensor_missing";
    case CauseKind::kSensorKind:
      return "sensor_kind";
    case CauseKind::kPairMissing:
      return "pair_missing";
    case CauseKind::kOffRigModel:
      return "off_rig_model";
    case CauseKind::kReferenceNotDrawn:
      return "reference_not_drawn";
    case CauseKind::kNotMeasured:
      break;
  }
  return "not_measured";
}

// A sensor's name stays as it is written.
std::string SentenceFrom(std::string text, const std::vector<SensorId>& sensors) {
  const std::string first = text.substr(0, text.find_first_of(" ,"));
  const bool is_name =
      std::any_of(sensors.begin(), sensors.end(), [&](const SensorId& sensor) { return sensor.str() == first; });
  if (!text.empty() && !is_name)
    text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  return text + ".";
}

template <typename AnId>
void AddNames(const std::vector<AnId>& ids, std::string& key) {
  constexpr std::size_t kNamesInKeyMax = 4;
  for (std::size_t i = 0; i < std::min(ids.size(), kNamesInKeyMax); ++i) key += " " + ids[i].str();
  if (ids.size() > kNamesInKeyMax) key += " +" + std::to_string(ids.size() - kNamesInKeyMax);
}

bool IsOfBoards(CauseKind kind) { return kind == CauseKind::kBoardCounts || kind == CauseKind::kBoardSize; }

std::string KeyOfCause(const RootCause& cause) {
  std::string key = KindWord(cause.kind);
  if (IsOfBoards(cause.kind)) AddNames(cause.boards, key);
  if (!IsOfBoards(cause.kind) && !IsOfTheSession(cause.kind)) AddNames(cause.sensors, key);
  return cause.trait.empty() ? key : key + " " + cause.trait;
}

std::string KeyOfFailure(const Edge& edge) {
  const auto& [first, second] = std::minmax(edge.frame_a, edge.frame_b);
  return std::string(kFailedPairKey) + " " + first.str() + " " + second.str();
}

Cause ToldCause(const RootCause& cause) {
  return {KindWord(cause.kind),
          KeyOfCause(cause),
          cause.sensors,
          cause.boards,
          cause.captures,
          cause.edges,
          SentenceFrom(cause.said.why, cause.sensors),
          SentenceFrom(cause.said.what_to_do, cause.sensors),
          cause.command};
}

}  // namespace

std::vector<Cause> ToldCauses(const std::vector<RootCause>& causes) {
  std::vector<Cause> told;
  told.reserve(causes.size());
  for (const RootCause& cause : causes) told.push_back(ToldCause(cause));
  return told;
}

std::vector<std::string> CauseKeysOf(const std::vector<RootCause>& causes, const std::vector<Edge>& edges,
                                     const SessionTimes& captured_at) {
  std::vector<std::string> keys;
  std::set<std::string> known;
  const auto add = [&](std::string key) {
    if (known.insert(key).second) keys.push_back(std::move(key));
  };
  for (const RootCause& cause : causes) add(KeyOfCause(cause));
  for (const Edge* edge : UnexplainedFailures(edges, captured_at, causes)) add(KeyOfFailure(*edge));
  if (keys.size() <= kCauseKeysMax) return keys;
  keys.resize(kCauseKeysMax);
  keys.back() = kMoreCausesKey;
  return keys;
}

}  // namespace rigcal::fleet
