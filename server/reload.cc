#include "server/reload.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdlib>

#include "idl/security.h"
#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/process/service_manager.h"

namespace rigcal {
namespace {

struct Option {
  const char* name;
  bool (*is_same)(const Config& a, const Config& b);
};

template <auto Member>
constexpr Option Named(const char* name) {
  return {name, [](const Config& a, const Config& b) { return a.*Member == b.*Member; }};
}

constexpr std::array kAtOnce = {Named<&Config::verbose>("--verbose"), Named<&Config::public_url>("--public-url"),
                                Named<&Config::http_names>("--http-name")};

constexpr std::array kAtRestart = {
    Named<&Config::data>("--data"),
    Named<&Config::store>("--store"),
    Named<&Config::blobs>("--blobs"),
    Named<&Config::http>("--http"),
    Named<&Config::http_open>("--http-open"),
    Named<&Config::http_proxy>("--http-proxy"),
    Named<&Config::http_cert>("--http-cert"),
    Named<&Config::http_key>("--http-key"),
    Option{"--domain", [](const Config& a, const Config& b) { return a.participant.domain == b.participant.domain; }},
    Option{"--tag", [](const Config& a, const Config& b) { return a.participant.tag == b.participant.tag; }},
    Named<&Config::standby>("--standby"),
    Named<&Config::threads>("--threads"),
    Named<&Config::log>("--log"),
    Named<&Config::webhooks>("--webhook"),
    Named<&Config::webhook_secrets>("--webhook-secret-file"),
};

// The others are built into queues, threads and the processes that calibrate.
constexpr std::array kLimitsAtOnce = {&limits::Limits::payload_bytes,        &limits::Limits::session_bytes,
                                      &limits::Limits::payloads_per_session, &limits::Limits::sensors_per_session,
                                      &limits::Limits::open_sessions,        &limits::Limits::reports_of_robot};

bool MayChange(std::int64_t limits::Limits::*limit) {
  return std::find(kLimitsAtOnce.begin(), kLimitsAtOnce.end(), limit) != kLimitsAtOnce.end();
}

std::string Listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

// A wrong option ends it by an exception of CLI11.
void Parse(CLI::App& app, Config& config, int argc, const char* const* argv) {
  config.data = DefaultData();
  AddOptions(app, config);
  app.parse(argc, argv);
}

constexpr const char* kDescription =
    "The Rigcal calibration service: takes capture sessions and edges over DDS, serves reports over HTTP.";

Result<Config> ReadConfig(int argc, const char* const* argv, const std::string& file) {
  Config config;
  config.file = file;
  CLI::App app(kDescription, "rigcald");
  try {
    Parse(app, config, argc, argv);
  } catch (const CLI::ParseError& error) {
    return Fail(ErrorCode::kInvalidInput, error.what(), "Write the file of --config as `rigcald --help` says.");
  }
  return config;
}

}  // namespace

SettingsChange CompareSettings(const Config& before, const limits::Limits& limits_before, const Config& read,
                               const limits::Limits& limits_read) {
  SettingsChange change;
  for (const Option& option : kAtOnce)
    if (!option.is_same(before, read)) change.at_once.emplace_back(option.name);
  for (const Option& option : kAtRestart)
    if (!option.is_same(before, read)) change.at_restart.emplace_back(option.name);
  for (const limits::Setting& one : limits::Settings()) {
    if (limits_before.*one.value == limits_read.*one.value) continue;
    auto& names = MayChange(one.value) ? change.at_once : change.at_restart;
    names.push_back("limit " + std::string(one.name) + " = " + std::to_string(limits_read.*one.value));
  }
  return change;
}

limits::Limits WithThoseThatMayChange(limits::Limits before, const limits::Limits& read) {
  for (const auto limit : kLimitsAtOnce) before.*limit = read.*limit;
  return before;
}

// Processes that this one starts must not read a file that was changed meanwhile: they are told all of it.
std::optional<int> Settings::Read(Config& config) {
  if (const char* file = std::getenv("RIGCAL_CONFIG")) file_ = file;
  unsetenv("RIGCAL_CONFIG");
  config.file = file_;
  CLI::App app(kDescription, "rigcald");
  try {
    Parse(app, config, argc_, argv_);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  // What the command line says goes before the environment.
  if (app.count("--domain") > 0) setenv("RIGCAL_DOMAIN", std::to_string(config.participant.domain).c_str(), 1);
  // Once, for as long as it runs: one that began with an identity never speaks without, whatever becomes of the folder.
  config.participant.identity = wire::IdentityFolder(config.participant.identity);
  unsetenv("RIGCAL_DDS_IDENTITY");
  in_force_ = config;
  return std::nullopt;
}

Status Settings::Apply() {
  RIGCAL_ASSIGN(Config read, ReadConfig(argc_, argv_, file_));
  RIGCAL_ASSIGN(const limits::Limits limits, LimitsOf(read));
  RIGCAL_ASSIGN(const std::string public_url, PublicUrl(read));
  for (const Status& one : {HttpOptions(read).map([](const auto&) {}), ReceiversOf(read).map([](const auto&) {})})
    RIGCAL_TRY(one);
  const SettingsChange change = CompareSettings(in_force_, limits::InForce(), read, limits);
  in_force_.verbose = read.verbose;
  in_force_.public_url = read.public_url;
  in_force_.http_names = read.http_names;
  SetLogLevel(read.verbose ? LogLevel::kDebug : LogLevel::kInfo);
  limits::Enforce(WithThoseThatMayChange(limits::InForce(), limits));
  changed_(in_force_, public_url);
  LogInfo("the settings were read anew: " +
          (change.at_once.empty() ? std::string("nothing changed") : "changed " + Listed(change.at_once)));
  if (!change.at_restart.empty()) LogWarn("these settings need a restart: " + Listed(change.at_restart));
  return {};
}

Status Settings::ReloadCertificate() {
  if (certificate_ == nullptr) return {};
  const Status read = certificate_->Reload();
  if (!read)
    return Fail(read.error().code, read.error().what + ", so the certificate of before is still shown",
                read.error().cure);
  LogInfo("the certificate was read anew: connections from now on see it");
  return {};
}

void Settings::ReadAgain() {
  TellServiceManager("RELOADING=1");
  const Status applied = Guarded([this]() -> Status {
    RIGCAL_TRY(ReloadCertificate());
    return Apply();
  });
  if (!applied)
    LogError({applied.error().code, "settings were read anew, and those of before stay: " + applied.error().what,
              applied.error().cure});
  TellServiceManager("READY=1");
}

}  // namespace rigcal
