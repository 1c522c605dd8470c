#include "server/identity_watch.h"

#include <utility>

#include "server/base/log.h"

namespace rigcal {
namespace {

constexpr std::chrono::seconds kLookAgain{1};

}  // namespace

IdentityWatch::IdentityWatch(std::filesystem::path folder) : folder_(std::move(folder)) {
  if (folder_.empty()) return;
  taken_up_ = FingerprintOf(folder_);
  list_ = RevokedListIn(folder_);
}

Status IdentityWatch::CheckIsNotOlder(const std::optional<RevokedList>& found) const {
  if (!list_ || !found || list_->authority_pem != found->authority_pem || list_->made_at <= found->made_at) return {};
  return Fail(ErrorCode::kInvalidInput,
              (folder_ / identity_files::kRevoked).string() + " was made at " + ToIso(found->made_at) +
                  ", before the list in force, of " + ToIso(list_->made_at),
              "Take revoked.crl there anew from the authority's folder `server`.");
}

Status IdentityWatch::CheckMayBeRead() const { return list_ ? CheckIsNotOlder(RevokedListIn(folder_)) : Status(); }

// The log has it once.
void IdentityWatch::WasNoGood(const Error& error, const std::string& so) {
  WasRefused();
  if (std::exchange(no_good_, seen_) == seen_) return;
  LogError(
      {error.code, "the server's identity changed, and that of before stays" + so + ": " + error.what, error.cure});
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
  if (!identity) return WasNoGood(identity.error(), ", so who was revoked since is still let in"), false;
  next_list_ = RevokedListIn(folder_);
  if (const Status newer = CheckIsNotOlder(next_list_); !newer) return WasNoGood(newer.error(), ""), false;
  return true;
}

void IdentityWatch::LookNow() {
  at_once_ = true;
  refused_.clear();
  no_good_.clear();
}

void IdentityWatch::TakenUp() {
  taken_up_ = seen_;
  list_ = next_list_;
  refused_.clear();
  no_good_.clear();
}

void IdentityWatch::WasRefused() {
  refused_ = seen_;
  next_try_ = std::chrono::steady_clock::now() + kTryAgain;
}

}  // namespace rigcal
