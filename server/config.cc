#include "server/config.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>

#include "idl/reach.h"
#include "idl/security.h"
#include "server/base/files/durable_file.h"
#include "server/base/log.h"
#include "server/base/process/memory_budget.h"
#include "server/base/version.h"
#include "server/formats/yaml/limits_text.h"
#include "server/http/allowed_hosts.h"
#include "server/http/public_address.h"
#include "server/sites/centre_link.h"

namespace rigcal {
namespace {

std::string LimitNames() {
  std::string names;
  for (const limits::Setting& one : limits::Settings()) names += (names.empty() ? "" : ", ") + std::string(one.name);
  return names;
}

// Half of what the process may have: intake, graphs, answers and the system's cache live in the rest.
std::int64_t DecodedBytesOfThisMachine() {
  constexpr std::int64_t kLeast = 64 << 20;
  return std::clamp(MemoryOfProcess() / 2, kLeast, limits::kDecodedBytes);
}

void AddHttpOptions(CLI::App& app, Config& config) {
  app.add_option("--http", config.http, "HOST:PORT of the reports; port 0 takes a free one")->capture_default_str();
  app.add_flag("--http-open", config.http_open,
               "Everybody who reaches --http may read, as long as there is no user (rigcal user): needed where that is "
               "no loopback "
               "address and there is no TLS or no user");
  app.add_option(
         "--http-name", config.http_names,
         "Another name that browsers ask for this server by, besides its addresses, this machine's name and that of "
         "--public-url; may be repeated")
      ->allow_extra_args(false)
      ->type_name("NAME");
  app.add_option("--http-proxy", config.http_proxy,
                 "Address in digits of a proxy in front: the last entry of its X-Forwarded-For is who asks, whose "
                 "wrong passwords are counted. "
                 "Of nobody else that header is believed")
      ->type_name("ADDRESS");
  app.add_option("--http-cert", config.http_cert,
                 "PEM file of the server's certificate and those that vouch for it: the reports are served over TLS "
                 "(https) only. Read "
                 "anew on SIGHUP")
      ->type_name("FILE");
  app.add_option("--http-key", config.http_key, "PEM file of the certificate's key, without a pass phrase")
      ->type_name("FILE");
  app.add_option("--public-url", config.public_url,
                 "The address of the reports that robots and people are told, where it is not that of --http: behind a "
                 "proxy, say. Not given: of --http, and this machine's name where it listens on every address")
      ->type_name("URL");
}

void AddCentreOptions(CLI::App& app, Config& config) {
  app.add_option("--centre", config.centre,
                 "Address of another rigcald: this one is a site's, and sends on there what robots push here "
                 "(docs/operations.md)")
      ->type_name("URL");
  app.add_option("--centre-token-file", config.centre_token,
                 "File with the token that the centre made for this site (rigcal token new NAME --role site)")
      ->type_name("FILE");
  app.add_option("--centre-ca", config.centre_ca,
                 "PEM file of who vouches for the centre's certificate, where that is nobody whom this machine trusts")
      ->type_name("FILE");
}

void AddStoreOptions(CLI::App& app, Config& config) {
  app.add_option("--data", config.data, "Data folder; made if it is not there")->capture_default_str();
  app.add_option("--store", config.store,
                 "Where the rows are: sqlite:FOLDER, or postgresql://USER@HOST/DATABASE with files in --data "
                 "(docs/operations.md). Not "
                 "given: all in --data")
      ->envname("RIGCAL_STORE")
      ->type_name("PLACE");
  app.add_option("--blobs", config.blobs,
                 "Where received files are durable: s3://BUCKET/PREFIX. --data has a copy of those that this machine "
                 "used. Keys, region and address come from the environment, as AWS's tools have them "
                 "(docs/operations.md). Not given: in --data")
      ->envname("RIGCAL_BLOBS")
      ->type_name("PLACE");
}

void AddWorkOptions(CLI::App& app, Config& config) {
  app.add_flag("--worker", config.worker)->group("");  // each process starts its own
  app.add_option("--threads", config.threads,
                 "Threads that calibrate; 0, with --store postgresql://...: rigcal-worker does it all")
      ->capture_default_str()
      ->check(CLI::Range(0, 64));
  app.add_option("--limits", config.limits_file, "YAML file of limits, NAME: VALUE (docs/limits.md)")
      ->envname("RIGCAL_LIMITS")
      ->type_name("FILE");
  app.add_option("--limit", config.limits, "One limit, over the file's; may be repeated: " + LimitNames())
      ->allow_extra_args(false)
      ->type_name("NAME=VALUE");
}

void AddLogOptions(CLI::App& app, Config& config) {
  app.set_config(
         "--config", config.file,
         "File of these options, NAME=VALUE a line or NAME=[VALUE,VALUE]; the command line wins. Of rigcald read "
         "anew on SIGHUP (docs/operations.md)")
      ->type_name("FILE");
  app.allow_config_extras(CLI::config_extras_mode::error);  // a name that is misspelt there
  app.add_flag("--verbose", config.verbose, "Log every event");
  app.add_option(
         "--log", config.log,
         "How events are written on standard error: text, or one JSON object a line with the ids they are about")
      ->capture_default_str()
      ->check(CLI::IsMember({"text", "json"}));
}

}  // namespace

std::filesystem::path DefaultData() {
  if (const char* home = std::getenv("HOME")) return std::filesystem::path(home) / ".local/share/rigcal";
  return "rigcal-data";
}

void AddOptions(CLI::App& app, Config& config) {
  app.set_version_flag("--version", "rigcald " + std::string(Version()));
  AddStoreOptions(app, config);
  AddHttpOptions(app, config);
  app.add_option("--domain", config.participant.domain, "DDS domain")->capture_default_str()->check(CLI::Range(0, 230));
  app.add_option("--tag", config.participant.tag, "DDS discovery tag: only peers with the same tag meet");
  app.add_option("--dds-identity", config.participant.identity,
                 "Folder of the server's identity (rigcal identity init): then only who has an identity of the same "
                 "authority is met over DDS, and all of it is encrypted")
      ->envname("RIGCAL_DDS_IDENTITY")
      ->type_name("DIR");
  app.add_flag("--standby", config.standby,
               "While another rigcald serves on the domain and tag, wait, and take over when it is gone");
  AddWorkOptions(app, config);
  app.add_option("--webhook", config.webhooks,
                 "Address that is told of changes (docs/alerts.md): statuses of robots, approvals, rollbacks, failed "
                 "sessions; may be repeated")
      ->allow_extra_args(false)
      ->type_name("URL");
  app.add_option(
         "--webhook-secret-file", config.webhook_secrets,
         "File with the secret that alerts are signed with: one for all receivers, or one for each in their order")
      ->allow_extra_args(false)
      ->type_name("FILE");
  AddCentreOptions(app, config);
  AddLogOptions(app, config);
  app.footer(
      "One rigcald serves on a DDS domain and tag: a second one ends with exit code 4 and names the first, or waits. "
      "Of\n"
      "several that share a store on PostgreSQL one speaks DDS there; the others serve HTTP and calibrate meanwhile.\n"
      "Examples:\n  rigcald\n  rigcald --data /srv/rigcal --http 0.0.0.0:8420 --http-open\n  rigcald --domain 7 --http "
      "127.0.0.1:0\n  rigcald --http 0.0.0.0:8420 --http-open --public-url https://rigs.example.org\n  rigcald "
      "--http-cert /etc/rigcal/rigs.pem --http-key /etc/rigcal/rigs.key\n  rigcald --data /srv/rigcal-2 "
      "--standby\n  rigcald --dds-identity /etc/rigcal/dds\n  rigcald --limit open_sessions=16 --limit "
      "intake_bytes=256MiB\n  rigcald --webhook "
      "https://alerts.example.org/rigcal "
      "--webhook-secret-file /etc/rigcal/webhook-secret\n  rigcald --data /srv/rigcal --blobs s3://rigs/site-1\n"
      "  rigcald --centre https://rigs.example.org --centre-token-file /etc/rigcal/centre-token");
}

void AddWorkerOptions(CLI::App& app, Config& config) {
  app.set_version_flag("--version", "rigcal-worker " + std::string(Version()));
  AddStoreOptions(app, config);
  AddWorkOptions(app, config);
  AddLogOptions(app, config);
  app.footer(
      "Several may run, on any machine that reaches the database and the folder of --data, or the bucket of --blobs. "
      "One "
      "robot is worked on by "
      "one process at a "
      "time; what one that dies or stands still had under way is done by another after 10 s.\n"
      "Example:\n  rigcal-worker --store postgresql://rigcal@db.example.org/rigcal --data /srv/rigcal --threads 4");
}

Status CheckThreads(const Config& config) {
  if (config.threads > 0 || !config.place.server.empty()) return {};
  return Fail(
      ErrorCode::kInvalidInput,
      "--threads 0: nobody would calibrate, as this process alone has the store at " + config.place.folder.string(),
      "Give --threads 1 or more, or a store on PostgreSQL (--store postgresql://...) and a rigcal-worker.");
}

Status SettlePlace(Config& config) {
  RIGCAL_ASSIGN(config.place, storage::StorePlaceOf(config.store, config.data));
  config.data = config.place.folder;
  config.place.bucket = config.blobs;
  if (!config.store.empty()) setenv("RIGCAL_STORE", config.store.c_str(), 1);
  if (!config.blobs.empty()) setenv("RIGCAL_BLOBS", config.blobs.c_str(), 1);
  return {};
}

Result<limits::Limits> LimitsOf(const Config& config) {
  limits::Limits limits;
  limits.decoded_bytes = DecodedBytesOfThisMachine();
  if (!config.limits_file.empty()) {
    RIGCAL_ASSIGN(const std::string text, ReadFile(config.limits_file, limits::kSessionYamlBytesMax));
    RIGCAL_ASSIGN(limits, formats::ReadLimits(text, config.limits_file.string(), limits));
  }
  for (const std::string& one : config.limits) {
    RIGCAL_ASSIGN(limits, formats::WithLimit(limits, one));
  }
  RIGCAL_TRY(formats::CheckTogether(limits));
  return limits;
}

Status EnforceLimits(const Config& config) {
  RIGCAL_ASSIGN(const limits::Limits limits, LimitsOf(config));
  limits::Enforce(limits);
  if (const std::string changed = formats::ChangedLimits(limits); !changed.empty()) LogInfo("limits: " + changed);
  return {};
}

namespace {

constexpr const char* kOpenDds =
    "Anyone who reaches this server over DDS can push as any robot and give orders under any name: it has no identity.";

Status CheckReach(const Config& config, const std::string& host) {
  if (http::IsLoopback(host) || config.http_open || !config.http_cert.empty()) return {};
  return Fail(ErrorCode::kInvalidInput,
              "--http " + config.http +
                  " would let everybody on the network read all calibrations and pictures, without a login",
              "Add --http-open if they may; else give --http-cert and --http-key and make users (`rigcal user add`), "
              "or keep 127.0.0.1, "
              "behind a proxy that asks who it is (docs/security.md).");
}

Result<std::shared_ptr<http::Certificate>> CertificateOf(const Config& config) {
  if (config.http_cert.empty() && config.http_key.empty()) return std::shared_ptr<http::Certificate>();
  if (!config.http_cert.empty() && !config.http_key.empty())
    return http::Certificate::Load(config.http_cert, config.http_key);
  return Fail(ErrorCode::kInvalidInput,
              std::string(config.http_key.empty() ? "--http-cert" : "--http-key") + " stands alone",
              "Give --http-cert FILE and --http-key FILE together, or neither.");
}

}  // namespace

Result<http::Options> HttpOptions(const Config& config) {
  http::Options options;
  const std::size_t colon = config.http.rfind(':');
  const std::string port = colon == std::string::npos ? "" : config.http.substr(colon + 1);
  if (port.empty() || port.size() > 5 || port.find_first_not_of("0123456789") != std::string::npos ||
      std::stoi(port) > 65535)
    return Fail(ErrorCode::kInvalidInput, "--http '" + config.http + "' is not HOST:PORT",
                "Write, for instance, 127.0.0.1:8420.");
  options.host = config.http.substr(0, colon);
  options.port = std::stoi(port);
  options.folder = config.data / "reports";
  RIGCAL_TRY(CheckReach(config, options.host));
  options.is_open = !http::IsLoopback(options.host);
  RIGCAL_ASSIGN(options.certificate, CertificateOf(config));
  for (const std::string& name : config.http_names) RIGCAL_TRY(http::CheckHostName(name));
  options.names = NamesOf(config);
  options.proxy = config.http_proxy;
  if (wire::IdentityFolder(config.participant.identity).empty() && wire::ReachesOthers()) options.note = kOpenDds;
  return options;
}

std::vector<std::string> NamesOf(const Config& config) {
  std::vector<std::string> names = config.http_names;
  if (!config.public_url.empty()) names.push_back(config.public_url);
  return names;
}

bool AlwaysNeedsLogin(const Config& config, const http::Options& options) {
  return !http::IsLoopback(options.host) && !config.http_open;
}

Status CheckUsers(const Config& config, const http::Options& options, bool has_users) {
  if (has_users || !AlwaysNeedsLogin(config, options)) return {};
  return Fail(ErrorCode::kInvalidInput, "--http " + config.http + " is for those who log in, and there is no user",
              "Make one with `rigcal user add NAME --role admin --data " + config.data.string() +
                  "`, or add --http-open if everybody on the network may read.");
}

void WarnOfReach(const http::Options& options, const std::string& address, bool has_users) {
  if (options.is_open && !has_users)
    LogWarn("anyone on the network can read all reports at " + address + ": there is no login");
  if (options.is_open && has_users && !options.certificate)
    LogWarn("passwords and tokens cross the network readable: give --http-cert and --http-key");
  if (!options.note.empty())
    LogWarn(
        "over DDS nobody logs in: whoever is on its network pushes as any robot and gives orders under any name, which "
        "the audit marks as not verified once there are users. Make identities (`rigcal identity`, --dds-identity), "
        "set RIGCAL_DDS_LOCAL=1 where all robots and people are on this machine, or keep DDS on a network of its own");
}

Result<std::string> PublicUrl(const Config& config) {
  return config.public_url.empty() ? Result<std::string>(std::string()) : http::ReadPublicUrl(config.public_url);
}

Result<std::vector<webhook::Receiver>> ReceiversOf(const Config& config) {
  constexpr std::size_t kSecretBytesMax = 4096;
  const std::size_t files = config.webhook_secrets.size(), receivers = config.webhooks.size();
  if (receivers == 0 ? files != 0 : files != 1 && files != receivers)
    return Fail(ErrorCode::kInvalidInput,
                std::to_string(receivers) + " of --webhook and " + std::to_string(files) +
                    " of --webhook-secret-file do not go together",
                "Give one file with a secret for all receivers, or one for each.");
  std::vector<webhook::Receiver> read;
  for (std::size_t i = 0; i < receivers; ++i) {
    RIGCAL_ASSIGN(std::string secret, ReadFile(config.webhook_secrets[files == 1 ? 0 : i], kSecretBytesMax));
    while (!secret.empty() && (secret.back() == '\n' || secret.back() == '\r')) secret.pop_back();
    read.push_back({config.webhooks[i], std::move(secret)});
    RIGCAL_TRY(webhook::CheckReceiver(read.back()));
  }
  return read;
}

std::vector<std::string> WorkerCommand(const Config& config) {
  std::vector<std::string> command = {"rigcal-worker", "--worker", "--data", config.data.string()};
  if (config.verbose) command.emplace_back("--verbose");
  command.push_back("--log=" + config.log);
  for (const limits::Setting& setting : limits::Settings())
    command.push_back("--limit=" + std::string(setting.name) + "=" + std::to_string(limits::InForce().*setting.value));
  return command;
}

namespace {

Status CheckPrivate(const std::filesystem::path& file) {
  std::error_code code;
  const auto permissions = std::filesystem::status(file, code).permissions();
  using std::filesystem::perms;
  if (code || (permissions & (perms::group_all | perms::others_all)) == perms::none) return {};
  return Fail(ErrorCode::kInvalidInput, "others on this machine can read " + file.string(),
              "`chmod 600 " + file.string() + "`, and make another token if somebody may have read it.");
}

}  // namespace

Result<sites::CentreAddress> CentreOf(const Config& config) {
  constexpr std::size_t kTokenBytesMax = 4096;
  sites::CentreAddress centre{config.centre, "", config.centre_ca};
  const bool has_others = !config.centre_token.empty() || !config.centre_ca.empty();
  if (centre.url.empty() && has_others)
    return Fail(ErrorCode::kInvalidInput, "--centre-token-file and --centre-ca are of --centre, which is not given",
                "Give the centre's address with --centre, or leave them out.");
  if (centre.url.empty()) return centre;
  if (centre.url.back() == '/') centre.url.pop_back();
  if (config.centre_token.empty())
    return Fail(ErrorCode::kInvalidInput, "--centre " + config.centre + " has no --centre-token-file",
                "Make a token at the centre, `rigcal token new NAME --role site`, and give its file.");
  RIGCAL_TRY(CheckPrivate(config.centre_token));
  RIGCAL_ASSIGN(centre.token, ReadFile(config.centre_token, kTokenBytesMax));
  while (!centre.token.empty() && (centre.token.back() == '\n' || centre.token.back() == '\r')) centre.token.pop_back();
  if (!centre.ca.empty()) RIGCAL_TRY(ReadFile(centre.ca, std::size_t{1} << 20));
  RIGCAL_TRY(sites::CheckCentre(centre));
  return centre;
}

}  // namespace rigcal
