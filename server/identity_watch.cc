#include "server/identity_watch.h"

#include <utility>

#include "server/base/identity/identity_folder.h"
#include "server/base/log.h"

namespace rigcal {
namespace {

constexpr std::chrono::seconds kLookAgain{1};

}  // namespace

IdentityWatch::IdentityWatch(std::filesystem::path folder) : folder_(std::move(folder)) {
  if (!folder_.empty()) taken_up_ = FingerprintOf(folder_);
}

bool IdentityWatch::HasNext() {
  const auto now = std::chrono::steady_clock::now();
  if (folder_.empty() || (now < next_look_ && !at_once_)) return false;
  next_look_ = now + kLookAgain;
  const std::string found = FingerprintOf(folder_);
  const bool is_whole = found == seen_ || at_once_;  // else somebody may be copying
  at_once_ = false;
  seen_ = found;
  if (!is_whole || found == taken_up_ || (found == refused_ && now < next_try_)) return false;
  const auto identity = ReadIdentity(folder_, SystemClock().Now());
  if (identity) return true;
  WasRefused();
  if (std::exchange(no_good_, found) == found) return false;
  LogError({identity.error().code,
            "the server's identity changed, and that of before stays, so who was revoked since is still let in: " +
                identity.error().what,
            identity.error().cure});
  return false;
}

void IdentityWatch::LookNow() {
  at_once_ = true;
  refused_.clear();
  no_good_.clear();
}

void IdentityWatch::TakenUp() {
  taken_up_ = seen_;
  refused_.clear();
  no_good_.clear();
}

void IdentityWatch::WasRefused() {
  refused_ = seen_;
  next_try_ = std::chrono::steady_clock::now() + kTryAgain;
}

}  // namespace rigcal
