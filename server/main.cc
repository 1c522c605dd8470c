// rigcald: reads the configuration, opens the four owners of state (DDS, store, runner, HTTP), wires them, waits for a signal.
#include <sys/file.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <future>
#include <iostream>
#include <mutex>

#include "server/base/log.h"
#include "server/base/version.h"
#include "server/dds/service.h"
#include "server/formats/answers.h"
#include "server/http/server.h"
#include "server/pipeline/answer.h"
#include "server/pipeline/runner.h"
#include "server/pipeline/startup.h"

namespace rigcal {
namespace {

struct Config {
  std::filesystem::path data;
  std::string http = "127.0.0.1:8420";
  wire::ParticipantOptions participant;
  int threads = 2;
  bool verbose = false;
};

std::filesystem::path DefaultData() {
  if (const char* home = std::getenv("HOME")) return std::filesystem::path(home) / ".local/share/rigcal";
  return "rigcal-data";
}

void AddOptions(CLI::App& app, Config& config) {
  app.set_version_flag("--version", "rigcald " + std::string(Version()));
  app.add_option("--data", config.data, "Data folder; made if it is not there")->capture_default_str();
  app.add_option("--http", config.http, "HOST:PORT of the reports; port 0 takes a free one")->capture_default_str();
  app.add_option("--domain", config.participant.domain, "DDS domain")->capture_default_str()->check(CLI::Range(0, 230));
  app.add_option("--tag", config.participant.tag, "DDS discovery tag: only peers with the same tag meet");
  app.add_option("--threads", config.threads, "Threads that calibrate")->capture_default_str()->check(CLI::Range(1, 64));
  app.add_flag("--verbose", config.verbose, "Log every event");
  app.footer("Examples:\n  rigcald\n  rigcald --data /srv/rigcal --http 0.0.0.0:8420\n  rigcald --domain 7 --http 127.0.0.1:0");
}

Result<http::Options> HttpOptions(const Config& config) {
  http::Options options;
  const std::size_t colon = config.http.rfind(':');
  const std::string port = colon == std::string::npos ? "" : config.http.substr(colon + 1);
  if (port.empty() || port.size() > 5 || port.find_first_not_of("0123456789") != std::string::npos || std::stoi(port) > 65535)
    return Fail(ErrorCode::kInvalidInput, "--http '" + config.http + "' is not HOST:PORT", "Write, for instance, 127.0.0.1:8420.");
  options.host = config.http.substr(0, colon);
  options.port = std::stoi(port);
  options.folder = config.data / "reports";
  return options;
}

// One rigcald per data folder: held until the process ends, also by kill -9.
Status LockFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const int file = open((folder / "lock").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644);
  if (error || file < 0)
    return Fail(ErrorCode::kStorage, "the data folder " + folder.string() + " cannot be written", "Give another with --data, or mend its permissions.");
  if (flock(file, LOCK_EX | LOCK_NB) == 0) return {};
  return Fail(ErrorCode::kConflict, "another rigcald uses the data folder " + folder.string(), "Stop it, or give another folder with --data.");
}

// Lets the DDS thread wake a runner that is opened after it.
struct WakeRelay {
  std::mutex mutex;
  pipeline::Runner* runner = nullptr;
  void Wake() {
    const std::lock_guard lock(mutex);
    if (runner != nullptr) runner->Wake();
  }
  void Set(pipeline::Runner* next) {
    const std::lock_guard lock(mutex);
    runner = next;
  }
};

pipeline::Announcer AnnouncerTo(dds::Service& service) {
  pipeline::Announcer announcer;
  announcer.event = [&service](const RobotId& robot, const std::string& kind, const std::string& subject, const std::string& json) {
    service.Announce({robot, kind, subject, SystemClock().Now(), json});
  };
  announcer.calibration = [&service](const Revision& revision, const SensorId& reference, const std::vector<SensorPose>& poses,
                                     std::int64_t edges) {
    service.Publish(revision.robot, revision.number, reference, poses, revision.verdict, edges, 0, revision.created_at);
  };
  return announcer;
}

// `address` is known once the server has its port; a request that is faster waits for it.
http::Answer PagesOf(const std::filesystem::path& folder, Stamp started_at, const std::shared_future<std::string>& address) {
  return [folder, started_at, address](const std::string& path, const std::string& query) -> Result<http::Page> {
    thread_local Result<storage::Store> store = storage::Store::Open(folder);
    if (!store) store = storage::Store::Open(folder);
    if (!store) return Fail(store.error());
    RIGCAL_ASSIGN(auto page, pipeline::AnswerPage({*store, SystemClock(), started_at, address.get()}, path, query));
    return http::Page{std::move(page.body), std::move(page.content_type)};
  };
}

Status Serve(const Config& config, const sigset_t& signals) {
  RIGCAL_TRY(LockFolder(config.data));
  RIGCAL_ASSIGN(const http::Options http_options, HttpOptions(config));
  RIGCAL_ASSIGN(storage::Store query_store, storage::Store::Open(config.data));
  const Stamp started_at = SystemClock().Now();
  std::promise<std::string> address_promise;
  const std::shared_future<std::string> address_future = address_promise.get_future().share();
  RIGCAL_ASSIGN(const http::Server http, http::Server::Start(http_options, PagesOf(config.data, started_at, address_future)));
  const std::string address = "http://" + http_options.host + ":" + std::to_string(http.port());
  address_promise.set_value(address);

  WakeRelay relay;
  dds::Callbacks callbacks;
  callbacks.answer = [&](const std::string& verb, const std::string& json) {
    return pipeline::Answer({query_store, SystemClock(), started_at, address}, verb, json);
  };
  callbacks.work_arrived = [&relay](const RobotId&) { relay.Wake(); };
  RIGCAL_ASSIGN(dds::Service service, dds::Service::Start({config.participant, config.data, &SystemClock()}, callbacks));
  const pipeline::Announcer announcer = AnnouncerTo(service);
  RIGCAL_ASSIGN(storage::Store start_store, storage::Store::Open(config.data));
  RIGCAL_TRY(pipeline::AnnounceStored(start_store, announcer));
  RIGCAL_ASSIGN(pipeline::Runner runner, pipeline::Runner::Start({config.data, &SystemClock(), config.threads}, announcer));
  relay.Set(&runner);

  std::cout << "rigcald " << Version() << " is ready: reports at " << address << "/ , data in " << config.data.string() << std::endl;
  int signal = 0;
  sigwait(&signals, &signal);
  LogInfo("stopping");
  relay.Set(nullptr);
  return {};
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) {
  rigcal::Config config;
  config.data = rigcal::DefaultData();
  CLI::App app("The Rigcal calibration service: takes capture sessions and edges over DDS, serves reports over HTTP.", "rigcald");
  rigcal::AddOptions(app, config);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  rigcal::SetLogLevel(config.verbose ? rigcal::LogLevel::kDebug : rigcal::LogLevel::kInfo);

  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // before any thread is made: they all inherit it
  std::signal(SIGPIPE, SIG_IGN);
  const rigcal::Status served = rigcal::Serve(config, signals);
  if (served) return 0;
  rigcal::LogError(served.error());
  return 1;
}
