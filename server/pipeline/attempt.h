// Work that may end the process is begun so often and no more: each attempt is on disk and in the log before it begins.
#pragma once

#include <string>

#include "server/base/process/guarded.h"
#include "server/base/stamp.h"
#include "storage/work/attempts.h"

namespace rigcal::pipeline {

constexpr int kAttemptsMax = 3;
// Of a report: what decodes is left out once it has failed so often; then so often again without it, and no more.
constexpr int kPublishAttemptsMax = 2 * kAttemptsMax;

// Of the store or of ours (no memory, say): nothing is known of the data then, and the work is done again.
[[nodiscard]] bool IsOurFault(const Error& error);

// `said`: what a reader of the log calls it; `before`: attempts so far that count.
[[nodiscard]] Status BeginAttempt(storage::Store& store, const Clock& clock, const std::string& work,
                                  const std::string& said, int before);
// A disk that is full, a database that is held, or a bucket out of reach is not the work's doing: that does not count.
void EndAttempt(storage::Store& store, const Clock& clock, const std::string& work, const Error& error);

// One attempt; what a library throws is its failure. Who succeeds ends it as done in the transaction of its result.
template <typename Body>
auto Attempted(storage::Store& store, const Clock& clock, const std::string& work, const std::string& said, int before,
               const Body& body) -> decltype(body()) {
  RIGCAL_TRY(BeginAttempt(store, clock, work, said, before));
  auto result = Guarded(body);
  if (!result) EndAttempt(store, clock, work, result.error());
  return result;
}

// "the server died 3 times while it ...", or why it failed; `doing`: "calibrated left and right of session ...".
[[nodiscard]] std::string WhyGivenUp(const storage::Attempts& attempts, const std::string& doing);

}  // namespace rigcal::pipeline
