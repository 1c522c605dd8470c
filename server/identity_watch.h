// Whether the files of this server's identity are others than those that it took up: somebody was revoked, or it was
// made anew.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

namespace rigcal {

// One thread.
class IdentityWatch {
 public:
  // What is in `folder` now was taken up; empty: the server has no identity.
  explicit IdentityWatch(std::filesystem::path folder);

  // Once for each change: the files were left alone for a second, and are good. What is not good is in the log, once,
  // and what was taken up stays. To be called often.
  [[nodiscard]] bool HasNext();
  // The next call looks at once, also at what was no good before.
  void LookNow();
  // What HasNext told of could not be taken up.
  void WasRefused();

 private:
  std::filesystem::path folder_;
  std::string taken_up_, seen_, refused_;  // fingerprints
  std::chrono::steady_clock::time_point next_look_;
  bool at_once_ = false;
};

}  // namespace rigcal
