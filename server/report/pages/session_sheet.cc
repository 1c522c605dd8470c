#include "server/report/pages/session_sheet.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kCapturesMax = 1000;
constexpr std::size_t kOpenUses = 6;  // of a capture; more are folded

using Place = std::pair<CaptureId, SensorId>;

// What each pair of sensors did with a capture, in the order of the edges.
using Asked = std::vector<std::pair<const Edge*, const CaptureResidual*>>;

std::map<CaptureId, Asked> AskedOf(const std::vector<Edge>& edges) {
  std::map<CaptureId, Asked> asked;
  for (const Edge& edge : edges)
    for (const CaptureResidual& residual : edge.captures) asked[residual.capture].emplace_back(&edge, &residual);
  return asked;
}

// The first picture of each: several edges may show the same one.
std::map<Place, const Evidence*> PicturesOf(const std::vector<Edge>& edges) {
  std::map<Place, const Evidence*> pictures;
  for (const Edge& edge : edges)
    for (const Evidence& evidence : edge.evidence)
      if (evidence.suffix == "jpg" || evidence.suffix == "png")
        pictures.emplace(Place{evidence.capture, evidence.sensor}, &evidence);
  return pictures;
}

// A capture of a sensor counts if a good edge used it; else the first reason that is about this capture alone says why
// not.
struct Use {
  bool used = false, asked = false, by_good = false;
  std::string why_not;
};

std::map<Place, Use> UsesOf(const std::vector<Edge>& edges) {
  std::map<Place, Use> uses;
  for (const Edge& edge : edges)
    for (const CaptureResidual& residual : edge.captures)
      for (const SensorId& sensor : {edge.frame_a, edge.frame_b}) {
        Use& use = uses[{residual.capture, sensor}];
        use.asked = true;
        const bool good = edge.state == EdgeState::kGood;
        use.by_good = use.by_good || good;
        use.used = use.used || (residual.used && good);
        if (good && !residual.used && use.why_not.empty()) use.why_not = residual.note;
      }
  return uses;
}

// A tracker's or a pose stream's poses are one file of the whole session: no capture has a file of them.
std::set<SensorId> WithPosesOf(const Manifest& manifest) {
  std::set<SensorId> sensors;
  for (const Sensor& sensor : manifest.header.sensors)
    if (sensor.kind == SensorKind::kTracker || sensor.kind == SensorKind::kPoseStream) sensors.insert(sensor.id);
  return sensors;
}

std::map<CaptureId, std::set<SensorId>> CapturesOf(const Manifest& manifest, const std::set<SensorId>& with_poses) {
  std::map<CaptureId, std::set<SensorId>> captures;
  for (const Payload& payload : manifest.payloads)
    if (!payload.capture.empty() && !with_poses.contains(payload.sensor))
      captures[payload.capture].insert(payload.sensor);
  return captures;
}

void FillPoses(Dictionary& page, const std::set<SensorId>& with_poses) {
  if (with_poses.empty()) return;
  std::string names;
  for (const SensorId& sensor : with_poses) names += (names.empty() ? "" : ", ") + sensor.str();
  ShowValue(page, "POSES", "NAMES", names);
}

// "left / 003: 54 corners" -> "54 corners": row and column say the rest.
std::string FoundText(const Evidence& picture) {
  const std::string prefix = picture.sensor.str() + " / " + picture.capture.str() + ": ";
  return picture.title.rfind(prefix, 0) == 0 ? picture.title.substr(prefix.size()) : picture.title;
}

void FillVerdictOfCell(Dictionary& cell, const Use& use) {
  if (!use.asked) return;
  if (use.used) return cell.ShowSection("USED");
  ShowValue(cell, "UNUSED", "WHY",
            !use.why_not.empty() ? use.why_not
            : use.by_good        ? "no reason was kept"
                                 : "none of its pairs could be solved");
}

class Sheet {
 public:
  explicit Sheet(const SessionInput& input)
      : input_(input), pictures_(PicturesOf(input.edges)), uses_(UsesOf(input.edges)) {}

  void FillCell(Dictionary& cell, const Place& place, bool has_file) const {
    if (const auto picture = pictures_.find(place); picture != pictures_.end()) {
      Dictionary* shown = cell.AddSectionDictionary("PICTURE");
      const Evidence& evidence = *picture->second;
      shown->SetValue("FILE", evidence.digest.str() + "." + evidence.suffix);
      shown->SetValue("ALT", evidence.title.empty() ? place.second.str() : evidence.title);
      shown->SetValue("FOUND", FoundText(evidence));
      return FillVerdictOfCell(*shown, UseOf(place));
    }
    if (!has_file) return ShowValue(cell, "BLANK", "TEXT", "no file");
    if (const auto why = input_.unreadable.find(place); why != input_.unreadable.end())
      return ShowValue(cell, "UNREADABLE", "WHY", why->second);
    ShowValue(cell, "BLANK", "TEXT",
              !input_.row.closed || input_.row.pairs_waiting > 0 ? "not looked at yet" : "nothing drawn");
  }

 private:
  Use UseOf(const Place& place) const {
    const auto found = uses_.find(place);
    return found == uses_.end() ? Use{} : found->second;
  }

  const SessionInput& input_;
  std::map<Place, const Evidence*> pictures_;
  std::map<Place, Use> uses_;
};

void FillUse(Dictionary& row, const Edge& edge, const CaptureResidual& residual) {
  Dictionary* use = row.AddSectionDictionary("USE");
  use->SetValue("LEVEL", residual.used ? "pass" : "unknown");
  use->SetValue("WORD", residual.used ? "used" : "not used");
  use->SetValue("FROM", edge.frame_a.str());
  use->SetValue("TO", edge.frame_b.str());
  if (!residual.note.empty()) ShowValue(*use, "NOTE", "TEXT", residual.note);
}

// Those that did not use it first.
void FillUses(Dictionary& capture_row, const Asked& asked) {
  Dictionary& row = *capture_row.AddSectionDictionary("USES");
  std::size_t used = 0;
  for (const bool of_used : {false, true})
    for (const auto& [edge, residual] : asked) {
      if (residual->used != of_used) continue;
      used += of_used ? 1 : 0;
      FillUse(row, *edge, *residual);
    }
  row.SetValue("USED", std::to_string(used) + " of " + Count(asked.size(), "pair", "pairs"));
  if (asked.size() <= kOpenUses) row.ShowSection("OPEN");
}

}  // namespace

void FillSheet(Dictionary& page, const SessionInput& input) {
  const auto with_poses = WithPosesOf(input.manifest);
  const auto captures = CapturesOf(input.manifest, with_poses);
  FillPoses(page, with_poses);
  if (captures.empty()) return;
  const Sheet cells(input);
  const std::map<CaptureId, Asked> asked = AskedOf(input.edges);
  Dictionary* sheet = page.AddSectionDictionary("SHEET");
  for (const Sensor& sensor : input.manifest.header.sensors)
    if (!with_poses.contains(sensor.id))
      ShowValue(*sheet, "SENSOR", "NAME", sensor.id.str() + " (" + NameOf(sensor.kind) + ")");
  std::size_t shown = 0;
  for (const auto& [capture, sensors] : captures) {
    if (shown++ == kCapturesMax) break;
    Dictionary* row = sheet->AddSectionDictionary("CAPTURE");
    row->SetValue("NAME", capture.str());
    for (const Sensor& sensor : input.manifest.header.sensors)
      if (!with_poses.contains(sensor.id))
        cells.FillCell(*row->AddSectionDictionary("CELL"), {capture, sensor.id}, sensors.contains(sensor.id));
    if (const auto of_capture = asked.find(capture); of_capture != asked.end()) FillUses(*row, of_capture->second);
  }
  if (captures.size() > kCapturesMax) ShowValue(page, "MORE", "COUNT", std::to_string(captures.size() - kCapturesMax));
}

}  // namespace rigcal::report
