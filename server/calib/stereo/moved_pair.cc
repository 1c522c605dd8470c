#include "server/calib/stereo/moved_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "server/calib/camera/given_intrinsics.h"
#include "server/calib/camera/intrinsics.h"
#include "server/calib/core/capture_blocks.h"
#include "server/calib/core/selection.h"
#include "server/calib/stereo/stereo_work.h"

namespace rigcal::calib {
namespace {

constexpr std::size_t kCoarseTimes = 8;
constexpr double kBetterRatio = 0.5, kSurelyApart = 100.0;  // squared sigmas

// False: the views do not tell it.
bool HoldLens(const CameraProblem& views, Sensor& camera) {
  if (HoldsIntrinsics(camera)) return true;
  const auto alone = EstimateCamera(views);
  if (!alone) return false;
  camera.intrinsics = alone->intrinsics;
  camera.intrinsics_sigma.reset();
  return true;
}

// Those that enter the pair: not one that repeats another.
std::vector<std::size_t> SeenByBothInTime(const StereoProblem& problem) {
  std::vector<std::size_t> both = Select(problem).used;
  std::erase_if(both, [&](std::size_t idx) { return !BothSee(problem.captures[idx], problem.board); });
  std::stable_sort(both.begin(), both.end(), [&](std::size_t x, std::size_t y) {
    return TakenBefore{}(problem.captures[x].capture, problem.captures[y].capture);
  });
  return both;
}

// Some captures of the pair in time, by one pose.
struct Part {
  double capped_px2 = std::numeric_limits<double>::infinity();  // sum over captures of min(rms, limit)^2
  std::optional<StereoEstimate> estimate;
};

class MoveSearch {
 public:
  MoveSearch(StereoProblem held, double limit_px) : held_(std::move(held)), limit_px_(limit_px) {
    const std::vector<std::size_t> both = SeenByBothInTime(held_);
    const std::size_t count = std::min(both.size(), kSearchedCapturesMax);
    for (std::size_t k = 0; k < count; ++k) searched_.push_back(both[k * both.size() / count]);
  }

  // By one pose for all.
  [[nodiscard]] double RmsOfAll_px() const {
    return std::sqrt(PartOf(0, searched_.size()).capped_px2 / static_cast<double>(searched_.size()));
  }

  [[nodiscard]] std::optional<PairMove> Run() const {
    const std::size_t count = searched_.size();
    if (count < 2 * kPartCapturesMin) return std::nullopt;
    const std::size_t at = BestTime();
    const Part whole = PartOf(0, count), before = PartOf(0, at), after = PartOf(at, count);
    for (const Part* part : {&before, &after})
      if (!part->estimate || part->estimate->T_a_board.size() < kPartCapturesMin) return std::nullopt;
    const double of_parts_px2 = before.capped_px2 + after.capped_px2;
    if (!(of_parts_px2 <= kBetterRatio * kBetterRatio * whole.capped_px2)) return std::nullopt;
    const Se3 D = before.estimate->T_a_b.Inverse() * after.estimate->T_a_b;
    const Matrix6d Ad = Adjoint(D.Inverse());
    const Matrix6d C = Ad * before.estimate->C_model * Ad.transpose() + after.estimate->C_model;
    const Vector6d step = D.Log();
    if (!(step.dot(C.ldlt().solve(step)) >= kSurelyApart)) return std::nullopt;
    return PairMove{searched_[at - 1], searched_[at], step, std::sqrt(of_parts_px2 / static_cast<double>(count))};
  }

 private:
  // Of those searched, [begin, end).
  [[nodiscard]] Part PartOf(std::size_t begin, std::size_t end) const {
    StereoProblem problem = held_;
    problem.captures.clear();
    std::vector<std::size_t> part(searched_.begin() + static_cast<std::ptrdiff_t>(begin),
                                  searched_.begin() + static_cast<std::ptrdiff_t>(end));
    std::sort(part.begin(), part.end());
    for (const std::size_t idx : part) problem.captures.push_back(held_.captures[idx]);
    auto estimate = EstimateOrDiagnose(problem, nullptr, nullptr);
    if (!estimate) return {static_cast<double>(end - begin) * limit_px_ * limit_px_, std::nullopt};
    double capped_px2 = 0;
    for (const CaptureResidual& one : estimate->residuals)
      capped_px2 += std::pow(one.used ? std::min(one.rms, limit_px_) : limit_px_, 2);
    return {capped_px2, std::move(*estimate)};
  }

  [[nodiscard]] double Cost(std::size_t at) const {
    return PartOf(0, at).capped_px2 + PartOf(at, searched_.size()).capped_px2;
  }

  // The first capture after the move: coarse times first, then ever nearer to the best.
  [[nodiscard]] std::size_t BestTime() const {
    const std::size_t first = kPartCapturesMin, last = searched_.size() - kPartCapturesMin;
    std::pair<double, std::size_t> best{std::numeric_limits<double>::infinity(), first};
    const auto look = [&](std::size_t at) {
      if (at >= first && at <= last) best = std::min(best, {Cost(at), at});
    };
    const std::size_t step = std::max<std::size_t>(1, (last - first) / kCoarseTimes);
    for (std::size_t at = first; at <= last; at += step) look(at);
    look(last);
    for (std::size_t nearer = (step + 1) / 2; step > 1; nearer = (nearer + 1) / 2) {
      const std::size_t middle = best.second;
      look(middle - nearer);
      look(middle + nearer);
      if (nearer == 1 && best.second == middle) break;
    }
    return best.second;
  }

  StereoProblem held_;
  double limit_px_;
  std::vector<std::size_t> searched_;  // indices into captures
};

std::optional<StereoProblem> WithLensesHeld(StereoProblem problem) {
  const CameraProblem a = CameraOf(problem, &StereoCapture::a), b = CameraOf(problem, &StereoCapture::b);
  if (!HoldLens(a, problem.camera_a) || !HoldLens(b, problem.camera_b)) return std::nullopt;
  return problem;
}

// A lens that is given wrong bends what is near otherwise than what is far, at whatever time that was captured.
bool IsOfGivenLenses(StereoProblem problem, const PairMove& move, double limit_px) {
  if (!problem.camera_a.intrinsics && !problem.camera_b.intrinsics) return false;
  for (Sensor* camera : {&problem.camera_a, &problem.camera_b}) {
    if (camera->intrinsics) camera->camera_model = camera->intrinsics->model;
    camera->intrinsics.reset();
    camera->intrinsics_sigma.reset();
  }
  const auto own = WithLensesHeld(std::move(problem));
  return own && kBetterRatio * MoveSearch(*own, limit_px).RmsOfAll_px() <= move.rms_px;
}

}  // namespace

std::optional<PairMove> FindPairMove(const StereoProblem& problem, double limit_px) {
  const auto held = WithLensesHeld(problem);
  if (!held) return std::nullopt;
  const auto move = MoveSearch(*held, limit_px).Run();
  return move && !IsOfGivenLenses(problem, *move, limit_px) ? move : std::nullopt;
}

}  // namespace rigcal::calib
