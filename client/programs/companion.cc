#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <csignal>
#include <memory>
#include <thread>

#include "client/companion/growing_folder.h"
#include "client/companion/shown.h"
#include "client/text/table.h"
#include "client/verbs.h"
#include "server/base/process/thread_rank.h"
#include "server/formats/json/json_values.h"
#include "server/http/allowed_hosts.h"
#include "server/http/public_address.h"

namespace rigcal::client {
namespace {

constexpr std::chrono::milliseconds kListAgain(200);

std::atomic<bool> companion_interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");
void OnCompanionInterrupt(int) { companion_interrupted = true; }

struct CompanionOptions {
  std::string folder, host = "127.0.0.1";
  int port = 8090;
  bool once = false;
};

Result<ExitCode> AdviseOnce(const Context& context, const CompanionOptions& options) {
  companion::GrowingFolder folder(options.folder);
  RIGCAL_TRY(folder.List());
  while (folder.Waiting() > 0) folder.LookAtNext();
  const companion::Standing standing = companion::StandingOf(folder.SoFar());
  if (context.json)
    context.out << companion::StandingJson(standing) << std::endl;
  else
    companion::PrintStanding(standing, context.out);
  return standing.is_enough ? ExitCode::kGood : ExitCode::kVerdictWarn;
}

void TellAddress(const Context& context, const std::string& address) {
  if (context.json)
    context.out << formats::WriteObject([&](formats::JsonWriter& out) { out.Text("address", address); }) << std::endl;
  else
    context.out << "Open " << address << "/ beside the robot; Ctrl-C ends it." << std::endl;
}

void TellWhoSees(const Context& context, const std::string& host) {
  if (http::IsLoopback(host)) return;
  context.err << "Whoever reaches " << Plain(host)
              << " from the network sees the pictures; without --host only this machine does." << std::endl;
}

// What is looked at is shown at once, the rest after it: a folder that is full already is not a blank page for long.
void LookAndShow(companion::GrowingFolder& folder, companion::Shown& shown) {
  const auto began = std::chrono::steady_clock::now();
  while (folder.Waiting() > 0 && !companion_interrupted &&
         std::chrono::steady_clock::now() - began < std::chrono::milliseconds(500))
    folder.LookAtNext();
  shown.Show(companion::StandingOf(folder.SoFar()));
}

void WatchUntilInterrupted(companion::GrowingFolder& folder, companion::Shown& shown) {
  while (!companion_interrupted) {
    const auto is_new = folder.List();
    if (!is_new) shown.ShowTrouble(is_new.error());
    if (is_new && (*is_new || folder.Waiting() > 0)) LookAndShow(folder, shown);
    if (!is_new || folder.Waiting() == 0) std::this_thread::sleep_for(kListAgain);
  }
}

Result<ExitCode> Accompany(const Context& context, const CompanionOptions& options) {
  const http::Options page = {.host = options.host, .port = options.port, .folder = {}};
  companion::Shown shown(options.folder);
  RIGCAL_ASSIGN(const http::Server server, http::Server::Start(page, [&](const std::string& path, const std::string&) {
                  return shown.Answer(path);
                }));
  std::signal(SIGINT, OnCompanionInterrupt);
  std::signal(SIGTERM, OnCompanionInterrupt);
  TellWhoSees(context, options.host);
  TellAddress(context, http::AddressOf(page, server.port(), http::MachineName()));
  companion::GrowingFolder folder(options.folder);
  WatchUntilInterrupted(folder, shown);
  return ExitCode::kGood;
}

Result<ExitCode> RunCompanion(const Context& context, const CompanionOptions& options) {
  if (options.once) {
    SetThreadRank(ThreadRank::kWorks);
    return AdviseOnce(context, options);
  }
  return Accompany(context, options);
}

constexpr const char* kCompanionFooter =
    "Needs no server. Put session.yaml into the folder, start it, and take captures into the folder: each picture is\n"
    "looked at as it comes. The page says per camera whether the board was found, what part of the picture it has\n"
    "been in, how it was tilted, how far away it was, whether it was blurred, which files are missing, and how well\n"
    "the pose would be known; and where to hold the board next, until all is within tolerance: enough.\n"
    "Left, right, up and down are those of the camera's picture; tilted to the right: its right side is nearer.\n"
    "Looked at: cameras before a board that is carried. Clouds are counted; poses of trackers are not looked at: with\n"
    "those, or with a camera that no carried board ties to the rest, it never says enough, but what is not judged.\n"
    "Judged by the default limits, 5 mm and 0.29 deg. After it, `rigcal check` looks at the whole session.\n"
    "A phone reaches it with --host 0.0.0.0: whoever is in that network then sees the pictures.\n"
    "Exit code of --once: 0 enough, 5 take more, or a sensor is not judged here, 4 there is no session.\n"
    "Examples:\n"
    "  rigcal companion visit-2026-01-31/\n"
    "  rigcal companion visit-2026-01-31/ --host 0.0.0.0 --port 8090\n"
    "  rigcal companion visit-2026-01-31/ --once --json > next.json\n";

}  // namespace

void AddCompanion(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(kCompanionVerb.name, kCompanionVerb.description);
  auto options = std::make_shared<CompanionOptions>();
  verb->add_option("DIR", options->folder, "The session folder that is being filled (docs/session-format.md)")
      ->required();
  verb->add_option("--port", options->port, "Where the page is; 0: any free port (default 8090)")
      ->type_name("N")
      ->check(CLI::Range(0, 65535));
  verb->add_option("--host", options->host, "The address that it listens at (default 127.0.0.1: this machine only)")
      ->type_name("ADDRESS");
  verb->add_flag("--once", options->once, "Look at what is there, print the advice, end");
  verb->footer(kCompanionFooter);
  verb->callback([&context, options] {
    const auto code = RunCompanion(context, *options);
    context.exit_code = code ? *code : Report(code.error(), context);
  });
}

}  // namespace rigcal::client
