#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "server/report/page.h"
#include "server/report/robot_pages.h"
#include "server/report/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kCapturesMax = 1000;
constexpr std::size_t kOpenUses = 6;  // of a capture; more are folded

using Place = std::pair<CaptureId, SensorId>;

// The first picture of each: several edges may show the same one.
std::map<Place, const Evidence*> PicturesOf(const std::vector<Edge>& edges) {
  std::map<Place, const Evidence*> pictures;
  for (const Edge& edge : edges)
    for (const Evidence& evidence : edge.evidence)
      if (evidence.suffix == "jpg" || evidence.suffix == "png")
        pictures.emplace(Place{evidence.capture, evidence.sensor}, &evidence);
  return pictures;
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

void FillCell(Dictionary& cell, const SensorId& sensor, const Evidence* picture, bool has_file) {
  if (picture) {
    Dictionary* shown = cell.AddSectionDictionary("PICTURE");
    shown->SetValue("FILE", picture->digest.str() + "." + picture->suffix);
    shown->SetValue("ALT", picture->title.empty() ? sensor.str() : picture->title);
    return;
  }
  ShowValue(cell, "BLANK", "TEXT", has_file ? "nothing drawn" : "no file");
}

// What each pair of sensors did with the capture.
void FillUses(Dictionary& row, const std::vector<Edge>& edges, const CaptureId& capture) {
  std::size_t used = 0, all = 0;
  for (const Edge& edge : edges)
    for (const CaptureResidual& residual : edge.captures) {
      if (residual.capture != capture) continue;
      used += residual.used ? 1 : 0, ++all;
      Dictionary* use = row.AddSectionDictionary("USE");
      use->SetValue("LEVEL", residual.used ? "pass" : "unknown");
      use->SetValue("WORD", residual.used ? "used" : "not used");
      use->SetValue("FROM", edge.frame_a.str());
      use->SetValue("TO", edge.frame_b.str());
      if (!residual.note.empty()) ShowValue(*use, "NOTE", "TEXT", residual.note);
    }
  row.SetValue("USED", std::to_string(used) + " of " + Count(all, "pair", "pairs"));
  if (all <= kOpenUses) row.ShowSection("OPEN");
}

void FillCaptures(Dictionary& page, const SessionInput& input) {
  const auto pictures = PicturesOf(input.edges);
  const auto with_poses = WithPosesOf(input.manifest);
  const auto captures = CapturesOf(input.manifest, with_poses);
  FillPoses(page, with_poses);
  if (captures.empty()) return;
  Dictionary* sheet = page.AddSectionDictionary("SHEET");
  for (const Sensor& sensor : input.manifest.header.sensors)
    if (!with_poses.contains(sensor.id)) ShowValue(*sheet, "SENSOR", "NAME", sensor.id.str() + " (" + NameOf(sensor.kind) + ")");
  std::size_t shown = 0;
  for (const auto& [capture, sensors] : captures) {
    if (shown++ == kCapturesMax) break;
    Dictionary* row = sheet->AddSectionDictionary("CAPTURE");
    row->SetValue("NAME", capture.str());
    for (const Sensor& sensor : input.manifest.header.sensors) {
      if (with_poses.contains(sensor.id)) continue;
      const auto picture = pictures.find({capture, sensor.id});
      FillCell(*row->AddSectionDictionary("CELL"), sensor.id, picture == pictures.end() ? nullptr : picture->second,
               sensors.contains(sensor.id));
    }
    FillUses(*row, input.edges, capture);
  }
  if (captures.size() > kCapturesMax) ShowValue(page, "MORE", "COUNT", std::to_string(captures.size() - kCapturesMax));
}

std::vector<const Edge*> Sorted(const std::vector<Edge>& edges) {
  std::vector<const Edge*> sorted;
  for (const Edge& edge : edges) sorted.push_back(&edge);
  std::sort(sorted.begin(), sorted.end(), [](const Edge* x, const Edge* y) {
    const auto key = [](const Edge* edge) {
      return std::make_tuple(edge->state != EdgeState::kFailed, edge->frame_a, edge->frame_b, edge->id);
    };
    return key(x) < key(y);
  });
  return sorted;
}

void FillEdges(Dictionary& page, const std::vector<const Edge*>& edges) {
  for (const Edge* one : edges) {
    const Edge& edge = *one;
    Dictionary* row = page.AddSectionDictionary("EDGE");
    const bool good = edge.state == EdgeState::kGood;
    row->SetValue("FROM", edge.frame_a.str());
    row->SetValue("TO", edge.frame_b.str());
    row->SetValue("METHOD", edge.method);
    row->SetValue("LEVEL", good ? "pass" : "fail");
    row->SetValue("STATE", good ? "good" : "failed");
    if (!edge.diagnoses.empty()) row->SetValue("WHY", edge.diagnoses.front().what);
  }
}

}  // namespace

Result<std::string> RenderSession(const SessionInput& input) {
  Dictionary page("session");
  const std::string short_id = ShortDigest(input.row.id.str());
  FillHead(page, input.robot.str() + ", session " + short_id, "../../../../");
  page.SetValue("ROBOT", input.robot.str());
  page.SetValue("SHORT", short_id);
  page.SetValue("ID", input.row.id.str());
  page.SetValue("TIME", TimeText(input.row.captured_at));
  page.SetValue("FILES", std::to_string(input.row.files_held) + " of " +
                             Count(static_cast<std::size_t>(input.row.files), "file", "files"));
  if (!input.row.operator_name.empty()) ShowValue(page, "OPERATOR", "NAME", input.row.operator_name);
  if (input.row.pairs_waiting > 0) ShowValue(page, "WAITING", "COUNT", std::to_string(input.row.pairs_waiting));
  for (const auto& [name, value] : input.manifest.header.conditions) {
    Dictionary* condition = page.AddSectionDictionary("CONDITION");
    condition->SetValue("NAME", name);
    condition->SetValue("VALUE", value);
  }
  FillEdges(page, Sorted(input.edges));
  FillCaptures(page, input);
  return Expand("session.tpl", page);
}

}  // namespace rigcal::report
