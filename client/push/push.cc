#include "client/push/push.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "client/elsewhere.h"
#include "client/push/bag_path.h"
#include "client/push/new_robot.h"

namespace rigcal::client {
namespace {

constexpr const char* kBagNeedsRig =
    "rigcal: a bag is pushed with --rig FILE, which says which topic is which sensor.\n"
    "`rigcal import BAG --list --write-rig FILE` writes a first one; see `rigcal push --help` with examples.\n";
constexpr const char* kNoBag =
    "rigcal: --rig, --work, --every and --tolerance are for bags, and this is none.\n"
    "See `rigcal push --help` with examples.\n";

bool IsThere(const std::string& path) {
  std::error_code failed;
  return std::filesystem::exists(path, failed);
}

Status RunPush(Context& context, const PushOptions& options, const PushBag& push_bag) {
  const bool is_bag = IsBagPath(options.folder);
  const bool is_misfit = is_bag ? options.bag.rig.empty() : options.bag.IsGiven() && IsThere(options.folder);
  if (is_misfit) {
    context.err << (is_bag ? kBagNeedsRig : kNoBag);
    context.exit_code = ExitCode::kUsage;
    return {};
  }
  return is_bag ? push_bag(context, options) : PushFolder(context, options);
}

void AddBagOptions(CLI::App& verb, BagChoice& bag) {
  verb.add_option("--rig", bag.rig, "Of a bag: which topic is which sensor (docs/bags.md)")->type_name("FILE");
  verb.add_option("--work", bag.work,
                  "Of a bag: where its session folder is while it is pushed (default: beside the bag)")
      ->type_name("DIR");
  verb.add_option("--every", bag.every_s,
                  "Of a bag: seconds from one capture to the next, at least (default: rig.yaml's, else 0)")
      ->type_name("S")
      ->check(CLI::Range(0.0, 86'400.0));
  verb.add_option("--tolerance", bag.tolerance_s,
                  "Of a bag: seconds that stamps of one capture may be apart (default: rig.yaml's, else 0.005)")
      ->type_name("S")
      ->check(CLI::Range(0.0, 1.0));
}

void AddPushOptions(CLI::App& verb, PushOptions& options) {
  verb.add_option("PATH", options.folder, "The session folder (docs/session-format.md), or a bag (docs/bags.md)")
      ->required();
  AddBagOptions(verb, options.bag);
  verb.add_option("--shuffle", options.shuffle_seed,
                  "Send the files in an order drawn from this seed; the result is the same")
      ->type_name("SEED");
  verb.add_option("--remounted", options.remounted,
                  "Sensors that were moved on purpose since the sessions before: what those say of them is past")
      ->type_name("SENSOR[,SENSOR...]")
      ->delimiter(',');
  verb.add_flag("--new-robot", options.new_robot, kNewRobotHelp);
  verb.add_flag("--no-wait", options.no_wait, "End when all is safe on the server's disk");
  verb.add_option("--timeout-total", options.give_up_s, "Give up after so many seconds without any answer (default 60)")
      ->check(CLI::Range(0.1, 1e7))
      ->type_name("S");
}

std::string Footer() {
  return "Break it off and run it again at any time: what is on the server's disk is not sent again.\n"
         "A bag becomes a session folder first, as `rigcal import` makes it, and that folder goes when the push is "
         "done. Broken\n"
         "off, it stays, and the same command goes on there.\n" +
         std::string(kVerdictCodes) +
         "With --no-wait 0, once all is safe; without a result, as of a session without a pair of sensors, 6.\n"
         "Where something of a bag could not be used, 5 in place of 0.\n"
         "Examples:\n"
         "  rigcal push visit-2026-01-31/\n"
         "  rigcal push drive.mcap --rig rig.yaml --every 2\n"
         "  rigcal push visit-2026-01-31/ --no-wait\n"
         "  rigcal push visit-2026-01-31/ --remounted lidar   the lidar was moved since the visit before\n"
         "  rigcal push visit-2026-01-31/ --json > result.json\n";
}

}  // namespace

void AddPushWith(CLI::App& app, Context& context, PushBag push_bag) {
  CLI::App* verb =
      app.add_subcommand("push", "Send a session folder or a bag, wait for its edges and the new calibration");
  auto options = std::make_shared<PushOptions>();
  AddPushOptions(*verb, *options);
  verb->footer(Footer());
  verb->callback([&context, options, push_bag = std::move(push_bag)] {
    if (const Status done = RunPush(context, *options, push_bag); !done)
      context.exit_code = Report(done.error(), context);
  });
}

void AddPush(CLI::App& app, Context& context) {
  AddPushWith(app, context, [](Context& at, const PushOptions&) { return Status(Fail(StartElsewhere(at, "import"))); });
}

}  // namespace rigcal::client
