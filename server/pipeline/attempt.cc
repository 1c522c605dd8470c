#include "server/pipeline/attempt.h"

#include "server/base/log.h"

namespace rigcal::pipeline {
namespace {

// Of the disk, the database or the bucket.
bool IsOutside(const Error& error) {
  return error.code == ErrorCode::kStorage || error.code == ErrorCode::kBusy || error.code == ErrorCode::kUnreachable;
}

std::string Times(int count) { return count == 1 ? "once" : std::to_string(count) + " times"; }

}  // namespace

bool IsOurFault(const Error& error) { return IsOutside(error) || error.code == ErrorCode::kInternal; }

Status BeginAttempt(storage::Store& store, const Clock& clock, const std::string& work, const std::string& said,
                    int before) {
  RIGCAL_TRY(storage::BeginAttempt(store, work, clock.Now()));
  LogInfo(work + ": " + said + ", attempt " + std::to_string(before + 1) + " of " + std::to_string(kAttemptsMax));
  return {};
}

void EndAttempt(storage::Store& store, const Clock& clock, const std::string& work, const Error& error) {
  const bool outside = IsOutside(error);
  const auto end = outside ? storage::AttemptEnd::kGivenBack : storage::AttemptEnd::kFailed;
  const Status ended = storage::EndAttempt(store, work, end, outside ? "" : error.what, clock.Now());
  if (!ended) LogError(ended.error());
}

std::string WhyGivenUp(const storage::Attempts& attempts, const std::string& doing) {
  std::string why;
  if (attempts.cut_off > 0)
    why = "the server died " + Times(attempts.cut_off) + " while it " + doing +
          ": of too much memory, for which the system kills, or of a fault of its own";
  if (attempts.failed > 0)
    why += (why.empty() ? "" : "; ") + std::string("it failed ") + Times(attempts.failed) + " when it " + doing + ": " +
           attempts.newest_why;
  return why;
}

}  // namespace rigcal::pipeline
