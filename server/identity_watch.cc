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
  std::string found = FingerprintOf(folder_);
  const bool is_whole = found == seen_ || at_once_;  // else somebody may be copying
  at_once_ = false;
  seen_ = found;
  if (!is_whole || found == taken_up_ || found == refused_) return false;
  const auto identity = ReadIdentity(folder_, SystemClock().Now());
  if (!identity) {
    refused_ = std::move(found);
    LogError({identity.error().code,
              "the server's identity changed, and that of before stays: " + identity.error().what,
              identity.error().cure});
    return false;
  }
  taken_up_ = std::move(found);
  return true;
}

void IdentityWatch::LookNow() {
  at_once_ = true;
  refused_.clear();
}

void IdentityWatch::WasRefused() { refused_ = std::exchange(taken_up_, ""); }

}  // namespace rigcal
