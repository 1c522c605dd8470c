// What is refused of a session folder.
#pragma once

#include <vector>

#include "server/model/sessions/session.h"

namespace rigcal::formats {

// The first refusal ends a reading. A survey keeps each and goes on without what it is about.
class Refusals {
 public:
  // Null: the first refusal ends the reading; else they are kept there.
  explicit Refusals(std::vector<Error>* kept) : kept_(kept) {}
  // An error: the reading ends.
  [[nodiscard]] Status Take(Error error) const {
    if (kept_ == nullptr) return Fail(std::move(error));
    kept_->push_back(std::move(error));
    return {};
  }
  [[nodiscard]] bool Any() const { return kept_ != nullptr && !kept_->empty(); }

 private:
  std::vector<Error>* kept_;
};

// `outcomes` of the payloads, side by side: those that are refused are left away.
[[nodiscard]] Status KeepGood(const std::vector<Status>& outcomes, const Refusals& refusals,
                              std::vector<Payload>& payloads);

}  // namespace rigcal::formats
