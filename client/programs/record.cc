#include <CLI/CLI.hpp>
#include <memory>
#include <sstream>

#include "client/import/files/held_folder.h"
#include "client/import/import.h"
#include "client/import/report.h"
#include "client/programs/bag_work.h"
#include "client/programs/interrupt.h"
#include "client/record/recorder.h"
#include "client/record/topic_report.h"
#include "client/ros/ros_place.h"
#include "client/text/table.h"
#include "client/verbs.h"
#include "server/base/files/durable_file.h"
#include "server/base/limits.h"

namespace rigcal::client {
namespace {

namespace fs = std::filesystem;
using recording::BagFile;
using recording::Recorder;
using recording::RecordingOutcome;
using std::chrono::milliseconds;

constexpr milliseconds kRecordTick(100);                     // how long Ctrl-C may go unnoticed
constexpr std::int64_t kShowEvery_ns = 1'000'000'000;        // on a terminal, and as JSON
constexpr std::int64_t kShowInLogEvery_ns = 30'000'000'000;  // elsewhere
constexpr double kRecordNsPerS = 1e9;

struct RecordOptions {
  std::string rig, out, bag;
  double for_s = 0;                       // 0: until it is interrupted
  double every_s = -1, tolerance_s = -1;  // negative: as rig.yaml says
  RosPlace ros;
};

// Without --bag it stands beside the folder, also where that is given as "visit/".
fs::path BagPathOf(const RecordOptions& options) {
  if (!options.bag.empty()) return options.bag;
  fs::path folder = fs::path(options.out).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  return folder.concat(".recording.mcap");
}

// What would be found out after an hour in the field is found out now.
Status CheckPlaces(const RecordOptions& options) {
  std::error_code failed;
  const fs::path bag = BagPathOf(options);
  if (fs::exists(bag, failed))
    return Fail(ErrorCode::kConflict, bag.string() + " is there already, from another recording",
                options.bag.empty() ? "Make its session by `rigcal import " + bag.string() + " --rig " + options.rig +
                                          " --out DIR`, or remove it."
                                    : "Give another path, or remove it.");
  if (options.out.empty() || !fs::exists(options.out, failed) || fs::is_empty(options.out, failed)) return {};
  return Fail(ErrorCode::kConflict, options.out + " is there already", "Give another folder, or remove it.");
}

// Who looks on: a table on a terminal, lines of JSON, or a table now and then.
class OnLooker {
 public:
  OnLooker(const Context& context, Recorder& recorder, recording::LiveTable& table)
      : context_(context), recorder_(recorder), table_(table) {}

  void ShowIfDue() {
    const bool often = context_.json || context_.err_is_terminal;
    const std::int64_t elapsed_ns = recorder_.Elapsed_ns();
    if (elapsed_ns - shown_ns_ < (often ? kShowEvery_ns : kShowInLogEvery_ns)) return;
    shown_ns_ = elapsed_ns;
    const auto topics = recorder_.Look();
    if (context_.json) context_.out << recording::ProgressJson(elapsed_ns, topics) << std::endl;
    std::ostringstream text;
    recording::PrintTopics(topics, text);
    if (context_.err_is_terminal) table_.Show(text.str());
    if (!often) context_.err << text.str() << std::flush;
  }

 private:
  const Context& context_;
  Recorder& recorder_;
  recording::LiveTable& table_;
  std::int64_t shown_ns_ = 0;
};

Status RecordUntilEnd(const Context& context, const RecordOptions& options, Recorder& recorder, const BagFile& bag,
                      recording::LiveTable& table) {
  const auto limit_ns = static_cast<std::int64_t>(options.for_s * kRecordNsPerS);
  OnLooker looker(context, recorder, table);
  while (!InterruptWatch::Came() && !bag.Trouble() && (limit_ns == 0 || recorder.Elapsed_ns() < limit_ns)) {
    RIGCAL_TRY(recorder.Step(kRecordTick));
    looker.ShowIfDue();
  }
  return recorder.Step(milliseconds(0));  // what came meanwhile
}

Result<RecordingOutcome> RecordBag(const Context& context, const RecordOptions& options, const importing::RigMap& map) {
  RIGCAL_ASSIGN(const int domain, RosDomainOf(options.ros));
  RIGCAL_ASSIGN(auto participant, OpenRosParticipant(domain, options.ros.tag));
  const fs::path path = BagPathOf(options);
  RIGCAL_ASSIGN(const std::unique_ptr<BagFile> bag, BagFile::Begin(path));
  recording::LiveTable table(context.err);
  const auto say = [&](const std::string& sentence) { table.Say(Plain(sentence)); };
  const auto opened = Recorder::Open(recording::WantedTopics(map), std::move(participant), domain, *bag, say);
  if (!opened) {
    static_cast<void>(bag->End());
    std::error_code failed;
    fs::remove(path, failed);  // nothing is in it, and the next attempt must find its place free
    return Fail(opened.error());
  }
  Recorder& recorder = **opened;
  const InterruptWatch watch;
  context.err << "Recording " << map.sensors.size() << " sensors in ROS domain " << domain << " to " << path.string()
              << (options.for_s > 0 ? "" : "; Ctrl-C ends it") << '.' << std::endl;
  const Status stepped = RecordUntilEnd(context, options, recorder, *bag, table);
  table.Clear();
  RecordingOutcome outcome{path, recorder.Elapsed_ns(), recorder.Look(), bag->End(), false};
  const auto trouble = bag->Trouble();
  if (trouble) Report(*trouble, context.err);
  if (!stepped) Report(stepped.error(), context.err);
  outcome.ended_early = trouble || !stepped;
  return outcome;
}

Status RefuseNothing(const RecordOptions& options, const RecordingOutcome& outcome) {
  if (outcome.totals.messages > 0) return {};
  std::error_code failed;
  fs::remove(outcome.bag, failed);
  if (outcome.ended_early) return Fail(ErrorCode::kStorage, "nothing was recorded", "What ended it is said above.");
  RIGCAL_ASSIGN(const int domain, RosDomainOf(options.ros));
  return Fail(ErrorCode::kUnreachable, "nothing was recorded in ROS domain " + std::to_string(domain),
              "See that the sensors publish the topics of rig.yaml there; what was amiss is said above.");
}

Result<importing::ImportOutcome> ImportHeld(const Context& context, const importing::ImportInput& input) {
  RIGCAL_ASSIGN(const importing::HeldFolder held, importing::HeldFolder::Take(input.out));
  return WithBar(context, [&](const auto& progress) { return importing::Import(input, progress); });
}

// The recording is kept until its session is whole: another tolerance, or a mended rig.yaml, may make more of it.
Result<ExitCode> MakeSession(const Context& context, const RecordOptions& options, const RecordingOutcome& recorded) {
  const auto outcome =
      ImportHeld(context, {recorded.bag, options.rig, options.out, NanosecondsIfGiven(options.tolerance_s),
                           NanosecondsIfGiven(options.every_s)});
  if (outcome && context.json)
    context.out << importing::OutcomeJson(*outcome, options.out) << std::endl;
  else if (outcome)
    importing::PrintOutcome(*outcome, options.out, context.out);
  const ExitCode made = outcome ? TellMissing(*outcome, context) : ExitCode::kRefused;
  std::error_code failed;
  if (made != ExitCode::kGood)
    context.err << "The recording is kept in " << recorded.bag.string() << ": `rigcal import` makes a session of it."
                << std::endl;
  else if (options.bag.empty())
    fs::remove(recorded.bag, failed);
  return outcome ? Result<ExitCode>(made) : Fail(outcome.error());
}

Result<ExitCode> RunRecord(const Context& context, const RecordOptions& options) {
  if (options.out.empty() && options.bag.empty()) {
    context.err << "rigcal: record needs --out, --bag or both.\nSee `rigcal record --help` with examples.\n";
    return ExitCode::kUsage;
  }
  RIGCAL_ASSIGN(const std::string text, ReadFile(options.rig, limits::kSessionYamlBytesMax));
  RIGCAL_ASSIGN(const importing::RigMap map, importing::ReadRigMap(text, fs::path(options.rig).filename().string()));
  RIGCAL_TRY(CheckPlaces(options));
  RIGCAL_ASSIGN(const RecordingOutcome outcome, RecordBag(context, options, map));
  RIGCAL_TRY(RefuseNothing(options, outcome));
  if (context.json)
    context.out << recording::RecordingJson(outcome) << std::endl;
  else
    recording::PrintRecording(outcome, context.out);
  ExitCode code = outcome.IsWhole() ? ExitCode::kGood : ExitCode::kVerdictWarn;
  if (!options.out.empty()) {
    RIGCAL_ASSIGN(const ExitCode made, MakeSession(context, options, outcome));
    if (code == ExitCode::kGood) code = made;
  }
  return outcome.ended_early ? ExitCode::kRefused : code;
}

constexpr const char* kRecordFooter =
    "Subscribes over DDS to the topics that rig.yaml maps to sensors, as a node of ROS 2 would; no ROS has to be "
    "installed. The same\n"
    "rig.yaml serves `rigcal import`, whose --list --write-rig makes a first one of a bag.\n"
    "While it records, each topic's rate, longest gap and last message are shown, and what is amiss is said: a topic "
    "that nobody\n"
    "publishes, one of another type, a publisher that ended, came again or is best effort, messages that were lost, a "
    "full disk.\n"
    "--out makes a session folder when it ends, as `import` does; where something is missing in that, the recording "
    "stays beside it.\n"
    "--bag keeps the recording as an MCAP file. Killed, it leaves a bag that `import` reads as far as it goes.\n"
    "Exit code: 0 good, 5 a sensor has nothing, or something was lost, 3 nothing came, 4 the disk ended it, or "
    "rig.yaml is refused.\n"
    "Examples:\n"
    "  rigcal record rig.yaml --out visit-2026-01-31/                     until Ctrl-C\n"
    "  rigcal record rig.yaml --bag visit.mcap --for 60 --ros-domain 42\n"
    "  rigcal record rig.yaml --out visit/ --every 2 && rigcal check visit/ && rigcal push visit/\n";

}  // namespace

void AddRecord(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(kRecordVerb.name, kRecordVerb.description);
  auto options = std::make_shared<RecordOptions>();
  verb->add_option("RIG", options->rig, "Which topic is which sensor: rig.yaml (docs/bags.md)")->required();
  verb->add_option("--out", options->out, "The session folder to write")->type_name("DIR");
  verb->add_option("--bag", options->bag, "The MCAP file to write, and keep")->type_name("FILE");
  verb->add_option("--for", options->for_s, "Seconds to record (default: until Ctrl-C)")
      ->type_name("S")
      ->check(CLI::Range(0.1, 864'000.0));
  verb->add_option("--every", options->every_s,
                   "Of the session: seconds between captures, at least (default: rig.yaml's, else 0)")
      ->type_name("S")
      ->check(CLI::Range(0.0, 86'400.0));
  verb->add_option("--tolerance", options->tolerance_s,
                   "Of the session: seconds that stamps of one capture may be apart (default: rig.yaml's, else 0.005)")
      ->type_name("S")
      ->check(CLI::Range(0.0, 1.0));
  AddRosPlace(*verb, options->ros);
  verb->footer(kRecordFooter);
  verb->callback([&context, options] {
    const auto code = RunRecord(context, *options);
    context.exit_code = code ? *code : Report(code.error(), context);
  });
}

}  // namespace rigcal::client
