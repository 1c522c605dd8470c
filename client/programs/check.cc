#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "client/check/look.h"
#include "client/check/report.h"
#include "client/text/progress.h"
#include "client/verbs.h"
#include "client/wire/transfer.h"
#include "server/base/process/thread_rank.h"
#include "server/model/edges/admission.h"

namespace rigcal::client {
namespace {

struct CheckOptions {
  std::string folder;
};

// A bar of its own for each part of the work.
class Bar {
 public:
  Bar(const Context& context, std::string label, Progress::Unit unit)
      : progress_(context.err, context.err_is_terminal, std::move(label), SteadyNow_ns(), unit) {}
  ~Bar() { progress_.Clear(); }
  Bar(const Bar&) = delete;
  Bar& operator=(const Bar&) = delete;
  void Show(std::int64_t done, std::int64_t total) { progress_.Show({done, total, ""}, SteadyNow_ns()); }

 private:
  Progress progress_;
};

Result<check::SessionSeen> LookAt(const Context& context, const std::string& folder) {
  std::optional<Bar> bar(std::in_place, context, "Reading", Progress::Unit::kBytes);
  bool looks = false;
  return check::Look(folder, {[&](std::int64_t done, std::int64_t total) { bar->Show(done, total); },
                              [&](std::int64_t done, std::int64_t total) {
                                if (!looks) bar.emplace(context, "Looking", Progress::Unit::kFiles);
                                looks = true;
                                bar->Show(done, total);
                              }});
}

// As the server will by its own clock.
void RefuseFuture(check::SessionSeen& session) {
  const Status past = CheckCapturedAt(session.manifest.header, SystemClock().Now(), "this machine");
  if (!past) session.refusals.push_back(past.error());
}

check::Findings FindIn(const Context& context, const check::SessionSeen& session) {
  Bar bar(context, "Estimating", Progress::Unit::kEdges);
  return check::FindAll(session, [&](std::int64_t done, std::int64_t total) { bar.Show(done, total); });
}

Result<ExitCode> RunCheck(const Context& context, const CheckOptions& options) {
  SetThreadRank(ThreadRank::kWorks);  // the robot has more urgent work than this
  RIGCAL_ASSIGN(check::SessionSeen session, LookAt(context, options.folder));
  RefuseFuture(session);
  const check::Findings findings = FindIn(context, session);
  const check::Judgement judgement = check::JudgeFindings(findings);
  for (const Error& refusal : findings.refusals) Report(refusal, context.err);
  if (context.json)
    context.out << check::ReportJson(findings, judgement) << std::endl;
  else
    check::PrintReport(findings, judgement, context.out);
  if (!findings.refusals.empty()) return ExitCode::kRefused;
  return judgement.IsEnough() ? ExitCode::kGood : ExitCode::kVerdictWarn;
}

}  // namespace

void AddCheck(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(kCheckVerb.name, kCheckVerb.description);
  auto options = std::make_shared<CheckOptions>();
  verb->add_option("DIR", options->folder, "The session folder (docs/session-format.md)")->required();
  verb->footer(
      "Needs no server. Run it before you push, or before you leave the robot: it says what to take more of.\n"
      "Looked at: session.yaml and the files as `push` does; in every picture the board, how much of the picture it\n"
      "covered over the session, how it was tilted (left: its left side is nearer to the camera; up: its upper side),\n"
      "how far away it was, and how sharp its edges are; clouds and tables of poses, whether they can be read; the "
      "same\n"
      "file twice. Pairs of cameras, cameras with trackers, and pose streams are calibrated as the server will do it,\n"
      "and have its sigma and its sentences.\n"
      "Not looked at: boards in clouds, and how clouds lie on each other. Pairs with a lidar are only counted: "
      "captures\n"
      "with a cloud and, of a camera, the board in its picture.\n"
      "Judged by the default limits, 5 mm and 0.29 deg, for no server is asked: its policy may want more\n"
      "(`rigcal policy show ROBOT`).\n"
      "Exit code: 0 enough, 5 take more or mend something, 4 what `push` would refuse.\n"
      "Examples:\n"
      "  rigcal check visit-2026-01-31/\n"
      "  rigcal check visit-2026-01-31/ && rigcal push visit-2026-01-31/\n"
      "  rigcal check visit-2026-01-31/ --json > check.json\n");
  verb->callback([&context, options] {
    const auto code = RunCheck(context, *options);
    context.exit_code = code ? *code : Report(code.error(), context);
  });
}

}  // namespace rigcal::client
