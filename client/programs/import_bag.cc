#include <CLI/CLI.hpp>
#include <memory>

#include "client/import/files/held_folder.h"
#include "client/import/import.h"
#include "client/import/report.h"
#include "client/import/rig_map.h"
#include "client/import/survey.h"
#include "client/programs/bag_work.h"
#include "client/verbs.h"
#include "server/base/files/durable_file.h"
#include "server/base/process/thread_rank.h"

namespace rigcal::client {
namespace {

namespace fs = std::filesystem;

struct ImportOptions {
  std::string bag, out, rig, write_rig;
  bool list = false;
  double every_s = -1, tolerance_s = -1;  // negative: as rig.yaml says
};

Result<ExitCode> List(const Context& context, const ImportOptions& options) {
  std::error_code failed;
  if (!options.write_rig.empty() && fs::exists(options.write_rig, failed))
    return Fail(ErrorCode::kConflict, options.write_rig + " is there already", "Give another path, or remove it.");
  RIGCAL_ASSIGN(const importing::BagSurvey survey,
                WithBar(context, [&](const auto& progress) { return importing::SurveyBag(options.bag, progress); }));
  if (!options.write_rig.empty()) RIGCAL_TRY(WriteDurably(options.write_rig, importing::FirstRigYaml(survey)));
  if (context.json)
    context.out << importing::SurveyJson(survey) << std::endl;
  else
    importing::PrintSurvey(survey, context.out);
  if (!options.write_rig.empty() && !context.json)
    context.out << options.write_rig << ": fill in the robot and its boards, and see that each sensor is one.\n";
  return TellDamage(survey.damage, context);
}

Result<ExitCode> Import(const Context& context, const ImportOptions& options) {
  const importing::ImportInput input{options.bag, options.rig, options.out, NanosecondsIfGiven(options.tolerance_s),
                                     NanosecondsIfGiven(options.every_s)};
  RIGCAL_ASSIGN(const importing::HeldFolder held, importing::HeldFolder::Take(options.out));
  RIGCAL_ASSIGN(const importing::ImportOutcome outcome,
                WithBar(context, [&](const auto& progress) { return importing::Import(input, progress); }));
  if (context.json)
    context.out << importing::OutcomeJson(outcome, options.out) << std::endl;
  else
    importing::PrintOutcome(outcome, options.out, context.out);
  return TellMissing(outcome, context);
}

Result<ExitCode> RunImport(const Context& context, const ImportOptions& options) {
  SetThreadRank(ThreadRank::kWorks);  // the robot has more urgent work than this
  if (options.list || !options.write_rig.empty()) return List(context, options);
  if (!options.out.empty() && !options.rig.empty()) return Import(context, options);
  context.err << "rigcal: import needs --list, or --rig with --out.\nSee `rigcal import --help` with examples.\n";
  return ExitCode::kUsage;
}

constexpr const char* kFooter =
    "Reads bags of ROS 2 (MCAP and SQLite, split, compressed or cut off) and of ROS 1; no ROS has to be installed. BAG "
    "is\n"
    "a file or a folder.\n"
    "--list shows what is in it: topics, how many messages, how often, the longest time without any, how far the "
    "drivers'\n"
    "stamps are from the recorder's clock, and what each topic may be to Rigcal. --write-rig writes that as a first\n"
    "rig.yaml. Fill in the robot's id and the boards, take out what is no sensor; it serves every bag of the rig.\n"
    "With --rig and --out, messages whose stamps are within the tolerance become captures of a session folder: "
    "pictures as\n"
    "PNG (JPEG as they came), clouds as PCD with all their fields, poses as poses.csv. What had no partner is counted "
    "and\n"
    "said. Of cameras that run freely the still moments are chosen, and their clocks estimated (docs/bags.md).\n"
    "Cut off, the same command goes on where it was. The same bag gives the same bytes.\n"
    "Exit code: 0 good, 5 something of the bag could not be used (what could is given), or a sensor has nothing of "
    "it,\n"
    "4 nothing could be read, or rig.yaml is refused.\n"
    "Examples:\n"
    "  rigcal import drive.mcap --list --write-rig rig.yaml\n"
    "  rigcal import drive.mcap --rig rig.yaml --out visit-2026-01-31/ --every 2\n"
    "  rigcal check visit-2026-01-31/ && rigcal push visit-2026-01-31/\n"
    "  rigcal push drive.mcap --rig rig.yaml                    both at once, without a folder that stays\n";

}  // namespace

void AddImport(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(kImportVerb.name, kImportVerb.description);
  auto options = std::make_shared<ImportOptions>();
  verb->add_option("BAG", options->bag, "The bag: an .mcap, .db3 or .bag file, or the folder of a split one")
      ->required();
  verb->add_flag("--list", options->list, "Say what is in the bag");
  verb->add_option("--write-rig", options->write_rig, "Write a first rig.yaml of it, to be edited")->type_name("FILE");
  verb->add_option("--rig", options->rig, "Which topic is which sensor (docs/bags.md)")->type_name("FILE");
  verb->add_option("--out", options->out, "The session folder to write")->type_name("DIR");
  verb->add_option("--every", options->every_s,
                   "Seconds from one capture to the next, at least (default: rig.yaml's, else 0)")
      ->type_name("S")
      ->check(CLI::Range(0.0, 86'400.0));
  verb->add_option("--tolerance", options->tolerance_s,
                   "Seconds that stamps of one capture may be apart (default: rig.yaml's, else 0.005)")
      ->type_name("S")
      ->check(CLI::Range(0.0, 1.0));
  verb->footer(kFooter);
  verb->callback([&context, options] {
    const auto code = RunImport(context, *options);
    context.exit_code = code ? *code : Report(code.error(), context);
  });
}

}  // namespace rigcal::client
