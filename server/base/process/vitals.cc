#include "server/base/process/vitals.h"

#include <utility>

#include "server/base/log.h"
#include "server/base/process/guarded.h"

namespace rigcal {

Part::Part(std::string name, std::chrono::milliseconds within, const Clock& clock)
    : name_(std::move(name)),
      within_(within),
      clock_(clock),
      turned_at_(std::chrono::steady_clock::now()),
      turned_stamp_(clock.Now()) {}

void Part::Recover() {
  turned_at_ = std::chrono::steady_clock::now();
  turned_stamp_ = clock_.Now();
  if (!problem_) return;
  OnceThereIsMemory([&] {
    LogInfo("the part '" + name_ + "' works again, after " + std::to_string(failures_in_row_) + " failures");
  });
  problem_.reset();
  failures_in_row_ = 0;
}

void Part::Turn() {
  const std::lock_guard lock(mutex_);
  resting_ = false;
  Recover();
}

void Part::Rest() {
  const std::lock_guard lock(mutex_);
  resting_ = true;
  Recover();
}

void Part::Fail(Error error) {
  const std::lock_guard lock(mutex_);
  resting_ = false;
  turned_at_ = std::chrono::steady_clock::now();
  ++failures_;
  ++failures_in_row_;
  if (!problem_) since_ = clock_.Now();
  if (!problem_ || problem_->what != error.what)
    OnceThereIsMemory([&] { LogError({error.code, "the part '" + name_ + "': " + error.what, error.cure}); });
  problem_ = std::move(error);
}

PartState Part::State(Time now) const {
  const std::lock_guard lock(mutex_);
  PartState state{name_, problem_, since_, failures_};
  if (problem_ || resting_ || now - turned_at_ <= within_) return state;
  state.problem = Error{ErrorCode::kInternal, "the part '" + name_ + "' of the server stands still",
                        "Restart rigcald, and report this with its log."};
  state.since = turned_stamp_;
  state.stands_still = true;
  return state;
}

Part& Vitals::Expect(const std::string& name, std::chrono::milliseconds within) {
  const std::lock_guard lock(mutex_);
  for (Part& part : parts_) {
    if (part.State(Part::Time()).name != name) continue;
    part.Turn();
    return part;
  }
  return parts_.emplace_back(name, within, clock_);
}

std::vector<PartState> Vitals::States(Part::Time now) const {
  const std::lock_guard lock(mutex_);
  std::vector<PartState> states;
  for (const Part& part : parts_) states.push_back(part.State(now));
  return states;
}

}  // namespace rigcal
