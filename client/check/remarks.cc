#include <algorithm>

#include "client/check/advice.h"
#include "client/check/capture_names.h"
#include "client/check/words.h"
#include "client/text/table.h"
#include "server/calib/core/wording.h"
#include "server/model/edges/unit_doubt.h"

namespace rigcal::check {
namespace {

using client::Fixed;
using Remarks = std::vector<std::string>;

constexpr std::size_t kAlikeMax = 10;  // remarks of one kind and sensor

std::string ThingOf(SensorKind kind) { return kind == SensorKind::kTracker ? "poses" : "files"; }

void AddMissing(const Findings& findings, const SensorFiles& files, Remarks& remarks) {
  if (files.kind == SensorKind::kPoseStream || files.files == 0) return;
  if (!CapturesLacking(findings, files).empty()) return;  // its advice says it
  const std::vector<CaptureId> own = CapturesOfItsPasses(findings, files, findings.captures);
  const std::string text = MissingText(ThingOf(files.kind), files.present, own);
  if (!text.empty()) remarks.push_back(files.sensor.str() + " has " + text + ".");
}

// What others recorded without it, so that nobody looks for its files there.
void AddOtherPasses(const Findings& findings, const SensorFiles& files, Remarks& remarks) {
  if (files.kind == SensorKind::kPoseStream || files.files == 0) return;
  std::vector<std::string> thirds;
  std::vector<CaptureId> captures;
  for (const SensorId& third : InTurnWith(findings, files)) {
    const std::vector<CaptureId>& present = FilesOf(findings, third)->present;
    captures.insert(captures.end(), present.begin(), present.end());
    thirds.push_back(third.str());
  }
  if (thirds.empty()) return;
  remarks.push_back(files.sensor.str() + " has no " + ThingOf(files.kind) + " for " +
                    Stretches(InOrder(std::move(captures)), findings.captures) + ", which " + NamesText(thirds) +
                    " recorded without it: taken as another pass, nothing is missing there.");
}

// What a cloud is refused with names the file itself.
std::string TroubleText(const FileTrouble& trouble) {
  const bool is_named = trouble.why.find(trouble.path) != std::string::npos;
  const std::string text = is_named ? trouble.why : trouble.path + ": " + trouble.why;
  return text.back() == '.' ? text : text + ".";
}

void AddTroubles(const std::vector<FileTrouble>& troubles, Remarks& remarks) {
  for (std::size_t i = 0; i < std::min(kAlikeMax, troubles.size()); ++i) remarks.push_back(TroubleText(troubles[i]));
  if (troubles.size() > kAlikeMax)
    remarks.push_back("... and " + std::to_string(troubles.size() - kAlikeMax) + " more files like these.");
}

// Of a camera without any board its advice says it.
void AddWithoutBoard(const CameraFound& camera, const std::vector<CaptureId>& all, Remarks& remarks) {
  if (camera.with_board.empty() || camera.without_board.empty()) return;
  remarks.push_back(camera.camera.str() + ": no board in " + Stretches(InOrder(camera.without_board), all) + " (" +
                    camera.why_not + ").");
}

void AddResized(const CameraFound& camera, const std::vector<CaptureId>& all, Remarks& remarks) {
  if (camera.resized.empty()) return;
  remarks.push_back(camera.camera.str() + ": the pictures of " + Stretches(InOrder(camera.resized), all) +
                    " are not of " + std::to_string(camera.width_px) + " x " + std::to_string(camera.height_px) +
                    " pixels like the others: take all pictures of one camera at one size.");
}

void AddBlurred(const CameraFound& camera, Remarks& remarks) {
  if (camera.blurred.empty()) return;
  std::vector<std::string> names;
  for (const BlurredPicture& picture : camera.blurred)
    names.push_back(picture.capture.str() + " (" + Fixed(picture.edge_px, 1) + " px)");
  remarks.push_back(camera.camera.str() + ": blurred at the edges of the board: " + NamesText(names) +
                    "; its usual edge is " + Fixed(camera.edge_px, 1) + " px wide.");
}

void AddGaps(const StreamFound& stream, Remarks& remarks) {
  if (stream.gaps == 0) return;
  remarks.push_back(stream.stream.str() + " has " + calib::CountText(stream.gaps, "gap") + " without a pose in its " +
                    Fixed(stream.seconds, 0) + " s, the longest of " + Fixed(stream.longest_gap_s, 1) +
                    " s: nothing is known there.");
}

void AddSame(const Findings& findings, Remarks& remarks) {
  for (std::size_t i = 0; i < std::min(kAlikeMax, findings.same_files.size()); ++i)
    remarks.push_back(NamesText(findings.same_files[i]) +
                      " are one and the same file: copy each sensor's own, or take the capture again.");
  if (findings.same_files.size() > kAlikeMax)
    remarks.push_back("... and " + std::to_string(findings.same_files.size() - kAlikeMax) +
                      " more files that are copies.");
}

}  // namespace

std::vector<std::string> RemarksOf(const Findings& findings) {
  Remarks remarks;
  for (const SensorFiles& files : findings.sensors) {
    AddMissing(findings, files, remarks);
    AddOtherPasses(findings, files, remarks);
    AddTroubles(files.unreadable, remarks);
    if (!IsInPair(findings, files.sensor))
      remarks.push_back(files.sensor.str() + " is in no pair of sensors that is calibrated.");
    const auto camera = findings.cameras.find(files.sensor);
    if (camera == findings.cameras.end()) continue;
    AddWithoutBoard(camera->second, findings.captures, remarks);
    AddResized(camera->second, findings.captures, remarks);
    AddBlurred(camera->second, remarks);
  }
  for (const LidarFound& lidar : findings.lidars) AddTroubles(lidar.odd, remarks);
  for (const StreamFound& stream : findings.streams) AddGaps(stream, remarks);
  AddSame(findings, remarks);
  for (const auto& [file, doubt] : findings.unit_doubts) remarks.push_back(file + ": " + doubt + " " + kTakenInMetres);
  return remarks;
}

}  // namespace rigcal::check
