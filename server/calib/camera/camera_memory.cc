#include "server/calib/camera/camera_memory.h"

#include <algorithm>

#include "server/base/limits.h"

namespace rigcal::calib {
namespace {

// Of a problem without views too.
std::size_t StoredViews(const CameraProblem& problem) { return problem.views.size() + 1; }

}  // namespace

std::shared_ptr<const CameraMemory::Answer> CameraMemory::Find(const CameraProblem& problem) {
  const std::lock_guard lock(mutex_);
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.problem == problem; });
  if (found == entries_.end()) return nullptr;
  std::rotate(entries_.begin(), found, found + 1);
  return entries_.front().answer;
}

void CameraMemory::Keep(Entry entry) {
  const std::lock_guard lock(mutex_);
  views_ += StoredViews(entry.problem);
  entries_.push_front(std::move(entry));
  while (views_ > limits::kCameraMemoryViewsMax) {
    views_ -= StoredViews(entries_.back().problem);
    entries_.pop_back();
  }
}

OrDiagnosis<CameraEstimate> CameraMemory::Estimate(const CameraProblem& problem) {
  if (const auto known = Find(problem)) return *known;
  auto answer = std::make_shared<const Answer>(EstimateCameraBy(solver_, problem));
  if (*answer || answer->error().code != "internal") Keep({problem, answer});
  return *answer;
}

}  // namespace rigcal::calib
