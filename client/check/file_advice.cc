// What is wrong with the files of sensors, and with boards that no camera found: captures more are no cure of these.
#include <algorithm>
#include <map>
#include <set>

#include "client/check/advice.h"
#include "client/check/capture_names.h"
#include "client/check/words.h"
#include "server/calib/core/wording.h"
#include "server/model/edges/captures_wanted.h"
#include "server/model/sensors/unfound_boards.h"

namespace rigcal::check {
namespace {

using calib::CountText;

std::string PlaceOf(const SensorFiles& files) {
  const bool is_table = files.kind == SensorKind::kTracker || files.kind == SensorKind::kPoseStream;
  return files.sensor.str() + (is_table ? "/poses.csv" : "/");
}

std::string FileWordOf(SensorKind kind) {
  if (kind == SensorKind::kCamera) return "picture";
  return kind == SensorKind::kLidar ? "cloud" : "pose";
}

std::string NoFilesText(const SensorFiles& files) {
  const bool is_table = files.kind == SensorKind::kTracker || files.kind == SensorKind::kPoseStream;
  return is_table ? "no poses: put them into " + PlaceOf(files) + ", or take it out of session.yaml"
                  : "no files: put its " + FileWordOf(files.kind) + "s into " + PlaceOf(files) +
                        ", or take it out of session.yaml";
}

// Of a pair: those that one of both has a file of.
std::vector<CaptureId> CapturesOf(const SensorFiles& a, const SensorFiles& b) {
  std::vector<CaptureId> captures = a.present;
  captures.insert(captures.end(), b.present.begin(), b.present.end());
  return InOrder(std::move(captures));
}

std::size_t CountHeld(const std::vector<CaptureId>& some, const std::vector<CaptureId>& all) {
  const std::set<CaptureId> held(all.begin(), all.end());
  return static_cast<std::size_t>(
      std::count_if(some.begin(), some.end(), [&](const CaptureId& capture) { return held.contains(capture); }));
}

bool IsInTurn(const SensorFiles& files, const SensorFiles& third) {
  return RecordedInTurn(static_cast<double>(files.present.size()), static_cast<double>(third.present.size()),
                        static_cast<double>(CountHeld(third.present, files.present)));
}

// The server warns of the same, or fails the pair.
bool IsLacking(const SensorFiles& files, const SensorFiles& other, const std::vector<CaptureId>& captures) {
  const auto count = static_cast<double>(captures.size()), held = static_cast<double>(files.present.size());
  return LacksFiles(held, count) &&
         !RecordedApart(held, static_cast<double>(CountHeld(other.present, captures)), count);
}

// Copying that broke off looks the same as a pass that the sensor took no part in.
bool IsOneStretch(const std::vector<CaptureId>& some, const std::vector<CaptureId>& all) {
  if (some.empty()) return false;
  const auto first = std::find(all.begin(), all.end(), some.front());
  return static_cast<std::size_t>(all.end() - first) >= some.size() && std::equal(some.begin(), some.end(), first);
}

Urgency UrgencyOf(const Findings& findings, const SensorFiles& files) {
  return files.usable < NeededOf(findings, files.sensor).least ? Urgency::kNoAnswer : Urgency::kFew;
}

Advice Missing(const Findings& findings, const SensorFiles& files, const std::vector<CaptureId>& lacking_of) {
  const std::string things = files.kind == SensorKind::kTracker ? "poses" : "files";
  const bool may_be_pass = IsOneStretch(files.present, lacking_of);
  return {{files.sensor.str()},
          MissingText(things, files.present, lacking_of) + "; " +
              (may_be_pass ? "unless it took no part in these, as in another pass, copy " : "copy ") +
              (things == "poses" ? "them" : "these files") + " into " + PlaceOf(files) +
              ", or take these captures again",
          UrgencyOf(findings, files),
          0,
          lacking_of.size() - std::min(lacking_of.size(), files.present.size())};
}

// Copied again, they may be enough; where none can be read nothing else helps.
bool IsForUnreadable(const Findings& findings, const SensorFiles& files) {
  const std::size_t unreadable = files.unreadable.size(), enough = NeededOf(findings, files.sensor).enough;
  if (unreadable == 0 || files.usable >= enough) return false;
  return unreadable == files.files ||
         (files.usable + unreadable >= enough && 2 * unreadable >= files.files - files.usable);
}

Advice Unreadable(const Findings& findings, const SensorFiles& files) {
  return {{files.sensor.str()},
          std::to_string(files.unreadable.size()) + " of " + CountText(files.files, FileWordOf(files.kind)) +
              " cannot be read: copy them again from where they were recorded, or take these captures again",
          UrgencyOf(findings, files),
          0,
          files.unreadable.size()};
}

// A board, and whether a picture of any camera shows it.
struct Looks {
  const Target* board = nullptr;
  bool found = false, looked = false;
};

std::map<TargetId, Looks> LooksOf(const Findings& findings) {
  std::map<TargetId, Looks> looks;
  for (const auto& [id, camera] : findings.cameras)
    for (const BoardCount& one : camera.boards) {
      Looks& of_board = looks[one.board.id];
      of_board.board = &one.board;
      of_board.found |= one.pictures > 0;
      of_board.looked |= camera.without_board.size() >= static_cast<std::size_t>(kPicturesToMissBoard);
    }
  return looks;
}

bool SeesNone(const CameraFound& camera, const std::map<TargetId, Looks>& looks) {
  return !camera.boards.empty() && !camera.without_board.empty() &&
         std::all_of(camera.boards.begin(), camera.boards.end(), [&](const BoardCount& one) {
           const Looks& of_board = looks.at(one.board.id);
           return of_board.looked && !of_board.found;
         });
}

}  // namespace

std::vector<SensorId> InTurnWith(const Findings& findings, const SensorFiles& files) {
  std::vector<SensorId> thirds;
  for (const SensorFiles& third : findings.sensors)
    if (third.sensor != files.sensor && IsInTurn(files, third)) thirds.push_back(third.sensor);
  return thirds;
}

std::vector<CaptureId> CapturesOfItsPasses(const Findings& findings, const SensorFiles& files,
                                           std::vector<CaptureId> captures) {
  std::set<CaptureId> in_turn;
  for (const SensorId& third : InTurnWith(findings, files)) {
    const std::vector<CaptureId>& present = FilesOf(findings, third)->present;
    in_turn.insert(present.begin(), present.end());
  }
  std::erase_if(captures, [&](const CaptureId& capture) { return in_turn.contains(capture); });
  return captures;
}

std::vector<CaptureId> CapturesLacking(const Findings& findings, const SensorFiles& files) {
  std::vector<CaptureId> worst;
  for (const PairFound& pair : findings.pairs) {
    if (pair.needed.enough == 0 || (pair.pair.a != files.sensor && pair.pair.b != files.sensor)) continue;
    const SensorFiles* other = FilesOf(findings, pair.pair.a == files.sensor ? pair.pair.b : pair.pair.a);
    if (other == nullptr) continue;
    std::vector<CaptureId> captures = CapturesOfItsPasses(findings, files, CapturesOf(files, *other));
    if (IsLacking(files, *other, captures) && captures.size() > worst.size()) worst = std::move(captures);
  }
  return worst;
}

bool FilesWouldBeEnough(const Findings& findings, const SensorFiles& files) {
  const std::size_t captures = CapturesLacking(findings, files).size();
  if (files.files == 0 || captures == 0) return true;
  const std::size_t lacking = captures - std::min(captures, files.present.size());
  return files.usable + lacking + files.unreadable.size() >= NeededOf(findings, files.sensor).enough;
}

std::optional<Advice> FileAdvice(const Findings& findings, const SensorFiles& files) {
  if (files.files == 0) return Advice{{files.sensor.str()}, NoFilesText(files), Urgency::kNoAnswer, 0};
  if (const auto captures = CapturesLacking(findings, files); !captures.empty())
    return Missing(findings, files, captures);
  if (IsForUnreadable(findings, files)) return Unreadable(findings, files);
  return std::nullopt;
}

std::optional<Advice> UnfoundBoards(const Findings& findings) {
  const std::map<TargetId, Looks> looks = LooksOf(findings);
  Advice advice;
  std::set<TargetId> unfound;
  std::size_t pictures = 0;
  for (const SensorFiles& files : findings.sensors) {
    const auto camera = findings.cameras.find(files.sensor);
    if (camera == findings.cameras.end() || !IsInPair(findings, files.sensor) || !SeesNone(camera->second, looks))
      continue;
    advice.of.push_back(files.sensor.str());
    pictures += camera->second.without_board.size();
    for (const BoardCount& one : camera->second.boards) unfound.insert(one.board.id);
  }
  if (advice.of.empty()) return std::nullopt;
  std::vector<const Target*> boards;
  for (const TargetId& id : unfound) boards.push_back(looks.at(id).board);
  advice.text = DescribedBoards(boards) + " was not found in any of the " + CountText(pictures, "picture") + ". " +
                CureOfUnfoundBoards(boards);
  advice.urgency = Urgency::kNoAnswer;
  return advice;
}

}  // namespace rigcal::check
