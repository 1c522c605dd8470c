#include "server/pipeline/pages/compared_lenses.h"

#include <optional>
#include <set>

#include "server/calib/camera/projection_maps.h"
#include "server/pipeline/edges/camera_fits.h"
#include "server/pipeline/sessions/refined_lenses.h"

namespace rigcal::pipeline {
namespace {

constexpr std::size_t kLensesReadMax = 100;  // of each revision

using ChoiceOfCamera = std::map<SensorId, report::FitChoice>;

ChoiceOfCamera FitsChosen(const report::SolvedRevision& solved, const std::map<SessionId, Stamp>& captured_at) {
  ChoiceOfCamera chosen;
  for (const report::FitChoice& choice : report::ChooseFits(*solved.revision, captured_at))
    chosen.emplace(choice.camera, choice);
  return chosen;
}

std::string InRevision(const char* what, const report::SolvedRevision& solved) {
  return std::string(what) + " revision " + std::to_string(solved.number);
}

// One camera of one revision; else why it cannot be compared.
struct ChosenLens {
  std::optional<CameraFit> fit;
  std::string why_not;
};

ChosenLens LensOf(storage::Store& store, const report::SolvedRevision& solved, const report::FitChoice& choice) {
  auto fits = LoadFits(store, {choice});
  if (!fits) return {std::nullopt, fits.error().what};
  std::vector<report::CameraReport>& loaded = *fits;
  if (loaded.empty()) return {std::nullopt, InRevision("the disk has lost what was kept of it in", solved)};
  if (loaded.front().fit.source == IntrinsicsSource::kNone)
    return {std::nullopt, InRevision("it was not solved in", solved)};
  const auto taken = TakeRefinedLenses(store, *solved.revision, loaded);
  if (!taken) return {std::nullopt, taken.error().what};
  return {std::move(loaded.front().fit), ""};
}

bool IsSameLens(const CameraFit& x, const CameraFit& y) {
  return x.intrinsics == y.intrinsics && x.width_px == y.width_px && x.height_px == y.height_px;
}

void CompareLens(storage::Store& store, const report::SolvedRevision& before, const report::FitChoice& chosen_before,
                 const report::SolvedRevision& now, const report::FitChoice& chosen_now,
                 report::ComparedLenses& lenses) {
  const SensorId& camera = chosen_now.camera;
  const ChosenLens old_lens = LensOf(store, before, chosen_before), new_lens = LensOf(store, now, chosen_now);
  for (const ChosenLens* lens : {&old_lens, &new_lens})
    if (!lens->fit) {
      lenses.not_compared.emplace_back(camera, lens->why_not);
      return;
    }
  if (IsSameLens(*old_lens.fit, *new_lens.fit)) return lenses.same.push_back(camera);
  auto change = calib::ChangeOfLens(*old_lens.fit, *new_lens.fit);
  if (change)
    lenses.changes.push_back(std::move(*change));
  else
    lenses.not_compared.emplace_back(camera, "its pictures are of another size");
}

}  // namespace

report::ComparedLenses CompareLenses(storage::Store& store, const report::SolvedRevision& before,
                                     const report::SolvedRevision& now, const std::map<SessionId, Stamp>& captured_at) {
  const ChoiceOfCamera old_fits = FitsChosen(before, captured_at), new_fits = FitsChosen(now, captured_at);
  std::set<SensorId> cameras;
  for (const ChoiceOfCamera* fits : {&old_fits, &new_fits})
    for (const auto& [camera, choice] : *fits) cameras.insert(camera);
  report::ComparedLenses lenses;
  std::size_t compared = 0;
  for (const SensorId& camera : cameras) {
    const auto old_fit = old_fits.find(camera), new_fit = new_fits.find(camera);
    if (old_fit == old_fits.end() || new_fit == new_fits.end())
      lenses.not_compared.emplace_back(
          camera, InRevision("nothing was kept of it in", old_fit == old_fits.end() ? before : now));
    else if (++compared > kLensesReadMax)
      lenses.not_compared.emplace_back(camera, "a page compares " + std::to_string(kLensesReadMax) + " cameras");
    else
      CompareLens(store, before, old_fit->second, now, new_fit->second, lenses);
  }
  return lenses;
}

}  // namespace rigcal::pipeline
