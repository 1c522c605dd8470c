#include <algorithm>

#include "client/check/advice.h"
#include "client/check/words.h"
#include "client/text/table.h"
#include "server/calib/core/wording.h"

namespace rigcal::check {
namespace {

using calib::CountText;
using client::Fixed;

// Of a focal length, 1 sigma: 5 mm at a metre, the default tolerance of a sensor (policy.h).
constexpr double kFocalSigmaMax_ratio = 0.005;
// Fewer of the fields of the picture with a corner: the lens is told in its middle only.
constexpr double kCoveredMin_ratio = 0.5;

std::string HeldText(const SensorFiles& files, const CameraFound* camera) {
  if (camera == nullptr)
    return files.kind == SensorKind::kLidar ? CountText(files.usable, "cloud") + " that can be read"
                                            : CountText(files.usable, "pose");
  if (files.usable > 0)
    return "the board is in " + std::to_string(files.usable) + " of " + CountText(files.files, "picture");
  return "no board in " + CountText(files.files, "picture") +
         (camera->why_not.empty() ? "" : " (" + camera->why_not + ")");
}

std::optional<Advice> WhyShort(const Findings& findings, const SensorFiles& files) {
  const CapturesNeeded needed = NeededOf(findings, files.sensor);
  if (files.usable >= needed.enough) return std::nullopt;
  const auto camera = findings.cameras.find(files.sensor);
  const std::size_t more = CapturesMore(findings, files.usable);
  return Advice{{files.sensor.str()},
                HeldText(files, camera == findings.cameras.end() ? nullptr : &camera->second) + ", " +
                    std::to_string(files.usable + more) + " are wanted: take " + std::to_string(more) + " more" +
                    (camera == findings.cameras.end() ? "" : " with the board in view"),
                files.usable < needed.least ? Urgency::kNoAnswer : Urgency::kFew,
                more};
}

std::string TiltText(const CameraFound& camera) {
  const std::string sides = OpenSides(camera.ring);
  std::string text =
      sides.empty() ? "tilt the board by 20 to 45 degrees in more captures" : "tilt the board 30 degrees " + sides;
  if (camera.distances && camera.distances->far_widths < kSameDistance_ratio * camera.distances->near_widths)
    text += ", and hold it nearer and farther";
  return text;
}

std::size_t TiltedMore(const CameraFound& camera) { return std::max(kTiltedViewsMin, CapturesToClose(camera.ring)); }

// The pictures leave the lens open.
Advice LensProblem(const CameraFound& camera) {
  const Diagnosis& problem = *camera.lens_problem;
  if (problem.code == "no_tilt")
    return {{camera.camera.str()},
            "its boards stand too much alike to tell its focal length: " + TiltText(camera),
            Urgency::kNoAnswer,
            TiltedMore(camera)};
  return {{camera.camera.str()}, SentenceOf(problem), Urgency::kNoAnswer, 0};
}

// Of a lens that is to be estimated, and can be.
std::optional<Advice> LensOpen(const CameraFound& camera) {
  std::vector<std::string> cures;
  std::size_t more = 0;
  if (camera.focal_sigma_ratio && !(*camera.focal_sigma_ratio <= kFocalSigmaMax_ratio)) {
    cures.push_back("its focal length is known to " + Fixed(100 * *camera.focal_sigma_ratio, 1) +
                    " % only: " + TiltText(camera));
    more = TiltedMore(camera);
  }
  const std::vector<std::string> sides =
      camera.fills_picture ? EmptySides(camera.coverage) : std::vector<std::string>();
  if (!sides.empty()) cures.push_back("hold the board near the " + Enumerated(sides) + " edge of its picture");
  if (camera.fills_picture && sides.empty() && camera.coverage.share_ratio < kCoveredMin_ratio)
    cures.push_back("hold the board in every part of its picture, of which corners cover " +
                    Fixed(100 * camera.coverage.share_ratio, 0) + " %");
  if (cures.empty()) return std::nullopt;
  std::string text;
  for (const std::string& cure : cures) text += (text.empty() ? "" : "; ") + cure;
  return Advice{{camera.camera.str()}, text, Urgency::kRough, std::max({more, sides.size(), std::size_t{1}})};
}

std::optional<Advice> WhyBlurred(const Findings& findings, const CameraFound& camera) {
  const std::size_t sharp = camera.with_board.size() - std::min(camera.with_board.size(), camera.blurred.size());
  if (sharp >= NeededOf(findings, camera.camera).enough) return std::nullopt;
  const std::size_t more = CapturesMore(findings, sharp);
  return Advice{{camera.camera.str()},
                std::to_string(camera.blurred.size()) + " of " + CountText(camera.with_board.size(), "picture") +
                    " of the board are blurred: hold board and robot still, with more light or a shorter "
                    "exposure, and take " +
                    std::to_string(more) + " more",
                Urgency::kRough,
                more};
}

// Two cameras may tell what one alone does not.
bool HasGoodEdgesOnly(const Findings& findings, const SensorId& sensor) {
  return std::all_of(findings.pairs.begin(), findings.pairs.end(), [&](const PairFound& pair) {
    if (pair.pair.a != sensor && pair.pair.b != sensor) return true;
    return pair.edge && pair.edge->state == EdgeState::kGood;
  });
}

}  // namespace

std::vector<Advice> LensAdvice(const Findings& findings, const CameraFound& camera) {
  if (camera.lens_problem) return {LensProblem(camera)};
  std::vector<Advice> advice;
  if (camera.estimates_lens)
    if (auto open = LensOpen(camera)) advice.push_back(std::move(*open));
  if (auto blurred = WhyBlurred(findings, camera)) advice.push_back(std::move(*blurred));
  return advice;
}

std::vector<Advice> SensorAdvice(const Findings& findings) {
  std::vector<Advice> all;
  const std::optional<Advice> unfound = UnfoundBoards(findings);
  if (unfound) all.push_back(*unfound);
  for (const SensorFiles& files : findings.sensors) {
    if (!IsInPair(findings, files.sensor)) continue;
    const auto of_files = FileAdvice(findings, files);
    if (of_files) all.push_back(*of_files);
    if (unfound && std::find(unfound->of.begin(), unfound->of.end(), files.sensor.str()) != unfound->of.end()) continue;
    if (!of_files || !FilesWouldBeEnough(findings, files))
      if (auto why_short = WhyShort(findings, files)) {
        all.push_back(std::move(*why_short));
        continue;
      }
    const auto camera = findings.cameras.find(files.sensor);
    if (camera == findings.cameras.end() || (of_files && !camera->second.lens_problem)) continue;
    if (camera->second.lens_problem && HasGoodEdgesOnly(findings, files.sensor)) continue;
    const std::vector<Advice> of_lens = LensAdvice(findings, camera->second);
    all.insert(all.end(), of_lens.begin(), of_lens.end());
  }
  return all;
}

}  // namespace rigcal::check
