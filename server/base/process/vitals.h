// Which parts of a running program do their work. Each says that it went round, that it rests, or what keeps it from
// its work; whoever asks is told. Any thread.
#pragma once

#include <chrono>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/base/stamp.h"

namespace rigcal {

struct PartState {
  std::string name;
  std::optional<Error> problem;  // nothing: it does its work
  Stamp since;                   // when the problem began
  std::int64_t failures = 0;     // since the start
  bool stands_still = false;     // the problem is that it did not go round: only a restart may help
};

class Part {
 public:
  using Time = std::chrono::steady_clock::time_point;
  // It goes round at least every `within` unless it rests; counted from now.
  Part(std::string name, std::chrono::milliseconds within, const Clock& clock);

  void Turn();             // went round in order: a failure is over
  void Rest();             // in order, and waits for work as long as it takes
  void Fail(Error error);  // did not do its work, and will try again; logged once per kind of failure
  // As of `now`: the failure that it reported, or that it stands still because it went round too long ago.
  [[nodiscard]] PartState State(Time now) const;

 private:
  void Recover();

  const std::string name_;
  const std::chrono::milliseconds within_;
  const Clock& clock_;
  mutable std::mutex mutex_;
  Time turned_at_;
  Stamp turned_stamp_;
  bool resting_ = false;
  std::int64_t failures_ = 0, failures_in_row_ = 0;
  std::optional<Error> problem_;
  Stamp since_;
};

class Vitals {
 public:
  // `clock` tells since when a problem lasts; it outlives this.
  explicit Vitals(const Clock& clock) : clock_(clock) {}
  // The part lives as long as this; one of that name that is there goes on, in order: its owner was opened again.
  [[nodiscard]] Part& Expect(const std::string& name, std::chrono::milliseconds within);
  [[nodiscard]] std::vector<PartState> States(Part::Time now = std::chrono::steady_clock::now()) const;

 private:
  const Clock& clock_;
  mutable std::mutex mutex_;
  std::deque<Part> parts_;
};

}  // namespace rigcal
