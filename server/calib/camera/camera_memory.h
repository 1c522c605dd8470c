// What EstimateCamera said of the newest problems: a camera takes part in many pairs of a session, with the same views
// in all pairs of a kind.
#pragma once

#include <deque>
#include <memory>
#include <mutex>

#include "server/calib/camera/intrinsics.h"

namespace rigcal::calib {

// May be asked from several threads; two that ask the same at once both solve it. Answers are those of the solver; one
// that failed for want of memory, say, is not kept. Holds limits::kCameraMemoryViewsMax views.
class CameraMemory {
 public:
  // What it does not know it asks of `solver`; an empty one stands for EstimateCamera.
  explicit CameraMemory(CameraSolver solver = {}) : solver_(std::move(solver)) {}
  [[nodiscard]] OrDiagnosis<CameraEstimate> Estimate(const CameraProblem& problem);

 private:
  using Answer = OrDiagnosis<CameraEstimate>;
  struct Entry {
    CameraProblem problem;
    std::shared_ptr<const Answer> answer;
  };
  [[nodiscard]] std::shared_ptr<const Answer> Find(const CameraProblem& problem);
  void Keep(Entry entry);

  CameraSolver solver_;
  std::mutex mutex_;
  std::deque<Entry> entries_;  // most recently used first
  std::size_t views_ = 0;      // of all entries
};

}  // namespace rigcal::calib
