// Whether the files of this server's identity are others than those that it took up: somebody was revoked, or it was
// made anew.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

#include "server/base/identity/identity_folder.h"

namespace rigcal {

// One thread.
class IdentityWatch {
 public:
  // What is in `folder` now was taken up; empty: the server has no identity.
  explicit IdentityWatch(std::filesystem::path folder);

  // The files are others than those taken up, were left alone for a second, and are good: TakenUp or WasRefused is to
  // be called then. A list of the revoked is no good that the same authority made before the one taken up: who was
  // revoked since would be let in again. What is not good is in the log, once, is looked at again every kTryAgain, and
  // what was taken up stays. To be called often.
  [[nodiscard]] bool HasNext();
  // The next call looks at once, also at what was no good before.
  void LookNow();
  // To be asked before the files are read anew, whatever HasNext told: fails where the list there now is older than the
  // one taken up, as HasNext has it. What reads them then would let in who was revoked since.
  [[nodiscard]] Status CheckMayBeRead() const;
  // What HasNext told of was taken up.
  void TakenUp();
  // What HasNext told of could not be taken up: it is told of again after kTryAgain.
  void WasRefused();

  static constexpr std::chrono::seconds kTryAgain{30};

 private:
  [[nodiscard]] Status CheckIsNotOlder(const std::optional<RevokedList>& found) const;
  void WasNoGood(const Error& error, const std::string& so);

  std::filesystem::path folder_;
  std::optional<RevokedList> list_, next_list_;      // taken up; of what HasNext looked at
  std::string taken_up_, seen_, refused_, no_good_;  // fingerprints; the last one is in the log
  std::chrono::steady_clock::time_point next_look_, next_try_;
  bool at_once_ = false;
};

}  // namespace rigcal
