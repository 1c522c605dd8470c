// The settings of a running rigcald: what it was told at its start, read again on SIGHUP.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/config.h"

namespace rigcal {

// What a configuration changes in one that is in force: the names of options, and of limits as "limit NAME".
struct SettingsChange {
  std::vector<std::string> at_once, at_restart;
};
// Files that options name are compared by name. `before` and `limits_before` are in force.
[[nodiscard]] SettingsChange CompareSettings(const Config& before, const limits::Limits& limits_before,
                                             const Config& read, const limits::Limits& limits_read);
// `before` with those of `read` that may change in a running process.
[[nodiscard]] limits::Limits WithThoseThatMayChange(limits::Limits before, const limits::Limits& read);

// The command line, the environment and the file that --config or RIGCAL_CONFIG names. Main thread only.
class Settings {
 public:
  // Both outlive it.
  Settings(int argc, const char* const* argv) : argc_(argc), argv_(argv) {}

  // At the start: the exit code where the command line ends the process (--help, a wrong option). Whether there is an
  // identity is settled by it: RIGCAL_DDS_IDENTITY is gone afterwards.
  [[nodiscard]] std::optional<int> Read(Config& config);
  // Of all that is told of changes that hold at once; the configuration is one that was checked.
  using Changed = std::function<void(const Config& config, const std::string& public_url)>;
  void TellOfChanges(Changed changed) { changed_ = std::move(changed); }
  // As it was read, and what has changed since.
  [[nodiscard]] const Config& in_force() const { return in_force_; }
  // Read again with the others; null: there is none.
  void KeepUp(std::shared_ptr<http::Certificate> certificate) { certificate_ = std::move(certificate); }
  // What may change holds from here on; the log says what did, and what needs a restart. Where anything is wrong, all
  // stays as it is, and the log says why. The service manager is told meanwhile.
  void ReadAgain();

 private:
  [[nodiscard]] Status Apply();
  [[nodiscard]] Status ReloadCertificate();

  int argc_;
  const char* const* argv_;
  std::string file_;  // that of RIGCAL_CONFIG
  Config in_force_;
  std::shared_ptr<http::Certificate> certificate_;
  Changed changed_ = [](const Config&, const std::string&) {};
};

}  // namespace rigcal
