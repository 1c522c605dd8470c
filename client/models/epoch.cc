#include <CLI/CLI.hpp>
#include <memory>

#include "client/change/order.h"
#include "client/named.h"
#include "client/text/table.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

struct EpochOptions {
  std::vector<std::string> sensors;
  std::string at;
  bool take_back = false;
  OrderOptions order;
};

std::string JoinedWith(const std::string& between, const std::vector<std::string>& words) {
  std::string joined;
  for (const std::string& word : words) joined += (joined.empty() ? "" : between) + word;
  return joined;
}

void PrintEpochDone(const Document& done, std::ostream& out) {
  std::vector<std::string> sensors;
  for (const Document& sensor : done["sensors"].Items()) sensors.push_back(Plain(sensor.Text("?")));
  const bool taken_back = done["taken_back"].Flag(false);
  out << (taken_back ? "The epoch of " : "An epoch of ") << JoinedWith(", ", sensors) << " of "
      << Plain(done["robot"].Text("?")) << (taken_back ? " that began at " : " began at ")
      << done["begins_at"].Text("?") << (taken_back ? " was taken back by " : ", says ")
      << Plain(done["standing"]["who"].Text("?")) << ": " << Plain(done["standing"]["reason"].Text()) << ".\n";
  if (!taken_back) out << "What was measured of " << (sensors.size() == 1 ? "it" : "them") << " before is past.\n";
}

Status GiveEpoch(Context& context, const EpochOptions& options) {
  std::vector<Field> parameters = {
      {"robot", options.order.robot}, {"reason", options.order.reason}, {"who", WhoAsks(options.order.who)}};
  if (!options.sensors.empty()) parameters.emplace_back("sensors", JoinedWith(",", options.sensors));
  if (!options.at.empty()) parameters.emplace_back("at", options.at);
  if (options.take_back) parameters.push_back(Field::Raw("take_back", "true"));
  RIGCAL_ASSIGN(const std::string done, AskOnce(context, "epoch", JsonObject(parameters)));
  OrderToGive order;
  order.verb = "epoch", order.print = PrintEpochDone;
  return FollowOrder(context, order, options.order, done);
}

}  // namespace

void AddEpoch(CLI::App& app, Context& context) {
  CLI::App* verb =
      app.add_subcommand("epoch", "Say that sensors were worked on: what was measured of them before is past");
  auto options = std::make_shared<EpochOptions>();
  verb->add_option("ROBOT", options->order.robot, "The robot's id")->required();
  verb->add_option("--sensor", options->sensors, "Of these sensors alone (default: all of the robot)")
      ->type_name("NAME")
      ->delimiter(',');
  verb->add_option("--reason", options->order.reason, "What was done, for those who come after")
      ->required()
      ->type_name("TEXT");
  CLI::Option* at =
      verb->add_option("--at", options->at, "When: a day or a time, as 2026-01-31T12:00:00Z (default: now)")
          ->type_name("TIME");
  verb->add_flag("--take-back", options->take_back, "It was not so: takes back the newest epoch that was begun by hand")
      ->excludes(at);
  verb->add_option("--by", options->order.who, "Who says so (default: the login name)")
      ->check(Named())
      ->type_name("NAME");
  verb->add_flag("--no-wait", options->order.no_wait, "End when it is safe on the server's disk");
  verb->add_option("--timeout-total", options->order.give_up_s,
                   "Give up after so many seconds without any answer (default 60)")
      ->check(CLI::Range(0.1, 1e7))
      ->type_name("S");
  verb->footer(
      "As `rigcal push --remounted` does it, without a session that says so. What was captured or stored before the "
      "time\n"
      "is past; what is captured from then on counts. Sensors whose serial number or firmware changed need no word.\n" +
      std::string(kVerdictCodes) +
      "Examples:\n"
      "  rigcal epoch mapper-01 --sensor front_left --reason \"new bracket\"\n"
      "  rigcal epoch mapper-01 --reason \"fell off the truck\" --at 2026-01-31\n"
      "  rigcal epoch mapper-01 --sensor front_left --take-back --reason \"it was mapper-02\"\n");
  verb->callback([&context, options] {
    if (const Status done = GiveEpoch(context, *options); !done) context.exit_code = Report(done.error(), context);
  });
}

}  // namespace rigcal::client
