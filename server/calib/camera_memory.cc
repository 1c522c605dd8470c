#include "server/calib/camera_memory.h"

#include <algorithm>

namespace rigcal::calib {
namespace {
constexpr std::size_t kEntriesMax = 48;  // more than a robot has cameras and kinds of pairs
}

std::shared_ptr<const CameraMemory::Answer> CameraMemory::Find(const CameraProblem& problem) {
  const std::lock_guard lock(mutex_);
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.problem == problem; });
  if (found == entries_.end()) return nullptr;
  std::rotate(entries_.begin(), found, found + 1);
  return entries_.front().answer;
}

tl::expected<CameraEstimate, Diagnosis> CameraMemory::Estimate(const CameraProblem& problem) {
  if (const auto known = Find(problem)) return *known;
  const auto answer = std::make_shared<const Answer>(EstimateCameraBy(solver_, problem));
  const std::lock_guard lock(mutex_);
  entries_.push_front({problem, answer});
  if (entries_.size() > kEntriesMax) entries_.pop_back();
  return *answer;
}

}  // namespace rigcal::calib
