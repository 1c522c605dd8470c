#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <memory>

#include "client/change/order.h"
#include "client/named.h"
#include "client/text/pose_text.h"
#include "client/text/table.h"
#include "client/verbs.h"
#include "server/base/files/durable_file.h"
#include "server/formats/answers/answers.h"
#include "server/formats/yaml/policy_yaml.h"

namespace rigcal::client {
namespace {

struct PolicyOptions {
  std::string action, what, model;
  bool new_model = false;
  OrderOptions order;
};

std::string InUnit(const Document& value, double scale) {
  if (!value.Number()) return "-";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", *value.Number() * scale);
  return text.data();
}

// "not_needed height, yaw"; of an empty list that all are needed, where a wider policy said less.
std::string NotNeededText(const Document& words) {
  if (words["not_needed"].IsNull()) return "";
  std::string results;
  for (const Document& result : words["not_needed"].Items()) results += (results.empty() ? " " : ", ") + result.Text();
  return results.empty() ? "all of the pose is needed" : "not_needed" + results;
}

// "lidar: tolerance_mm 20, moved_min_mm 3": what is said of one sensor or pair.
std::string SaidText(const std::string& name, const Document& words) {
  std::string text;
  for (const LimitName& one : kLimitNames)
    if (const Document value = words[std::string(one.name) + "_" + one.kept]; value.Number())
      text +=
          (text.empty() ? ": " : ", ") + std::string(one.name) + "_" + one.written + " " + InUnit(value, one.divisor);
  if (const std::string results = NotNeededText(words); !results.empty())
    text += (text.empty() ? ": " : ", ") + results;
  return name + text;
}

// Of every sensor, then what is said of some.
void PrintLimits(const Document& document, std::ostream& out) {
  const Document limits = document["limits"], policy = document["policy"];
  Table table({{"LIMIT"}, {"mm", Align::kRight}, {"deg", Align::kRight}});
  for (const char* name : {"tolerance", "moved_min", "unseen_move", "residual_max"})
    table.Add({name, InUnit(limits[std::string(name) + "_m"], kMmPerM),
               InUnit(limits[std::string(name) + "_rad"], kDegPerRad)});
  table.Print(out);
  out << "max_age " << AgeOf(limits["max_age_ns"]);
  if (limits["captures_min"].Integer()) out << ", captures_min " << CountOf(limits["captures_min"]);
  if (limits["visits_in_full"].Integer()) out << ", visits_in_full " << CountOf(limits["visits_in_full"]);
  out << '\n';
  if (limits["approval"].Text() == "person") out << "Each calibration is approved by a person before robots use it.\n";
  if (limits["approval"].Text() == "automatic" && !limits["approve_warnings"].Flag(true))
    out << "A pass is approved by itself, a warning by a person.\n";
  if (limits["approval"].Text() == "automatic" && !limits["approve_drift"].Flag(true))
    out << "What a session leaves that found drift is approved by a person.\n";
  if (const std::string all = SaidText("all", policy["all"]);
      all.find("px_at_10_m") != std::string::npos || !policy["all"]["not_needed"].IsNull())
    out << Plain(all) << '\n';
  for (const Document& sensor : policy["sensors"].Items())
    out << Plain(SaidText(sensor["id"].Text("?"), sensor)) << '\n';
  for (const Document& pair : policy["pairs"].Items())
    out << Plain(SaidText(pair["a"].Text("?") + " - " + pair["b"].Text("?"), pair)) << '\n';
}

std::string PlaceText(const Document& place) {
  return TextOf(PolicyPlace{PolicyScopeOf(place["scope"].Text()), Plain(place["subject"].Text())});
}

void PrintShown(const Document& document, std::ostream& out) {
  const std::string model = Plain(document["policy"]["rig_model"].Text());
  const bool tells_model = document["scope"].Text() == "robot" && !model.empty();
  out << "Policy of " << PlaceText(document) << (tells_model ? ", rig model " + model : "") << '\n';
  PrintLimits(document, out);
  const std::vector<Document> set = document["set"].Items();
  if (set.empty()) out << "Nobody has set any of it: these are the defaults.\n";
  for (const Document& version : set)
    out << "Of " << PlaceText(version) << ", version " << CountOf(version["version"]) << ", set by "
        << Plain(version["who"].Text("?")) << " on " << DayOf(version["at"]) << ": " << Plain(version["reason"].Text())
        << '\n';
}

void PrintSet(const Document& done, std::ostream& out) {
  const Document set = done["set"];
  const std::int64_t waiting = done["robots_waiting"].Integer().value_or(0);
  out << "The policy of " << PlaceText(set) << " is version " << CountOf(set["version"]) << ", set by "
      << Plain(set["who"].Text("?")) << ".\n";
  if (set["scope"].Text() == "robot") return;
  if (waiting > 0)
    out << waiting << (waiting == 1 ? " robot is" : " robots are")
        << " judged anew when the server has nothing else to do; `rigcal status` tells.\n";
  else
    out << "No robot is to be judged anew by it; it holds for those to come.\n";
}

Result<Policy> ReadPolicyFile(const std::string& file, std::string& text) {
  RIGCAL_ASSIGN(text, ReadFile(file, formats::kPolicyBytesMax));
  return formats::ReadPolicy(text, file);
}

// Without a server.
Status CheckFile(const Context& context, const PolicyOptions& options) {
  std::string text;
  RIGCAL_ASSIGN(const Policy policy, ReadPolicyFile(options.what, text));
  const std::string told = formats::WritePolicyCheck(options.what, policy);
  RIGCAL_ASSIGN(const Document document, Document::Parse(told, options.what));
  if (context.json) {
    context.out << told << std::endl;
    return {};
  }
  context.out << Plain(options.what) << " is good. Over the defaults it says:\n";
  PrintLimits(document, context.out);
  return {};
}

Status SetFile(Context& context, const PolicyOptions& options) {
  std::string text;
  RIGCAL_TRY(ReadPolicyFile(options.what, text));
  std::vector<Field> parameters = {
      {"reason", options.order.reason}, {"text", text}, {"who", WhoAsks(options.order.who)}};
  if (!options.order.robot.empty()) parameters.emplace_back("robot", options.order.robot);
  if (!options.model.empty()) parameters.emplace_back("model", options.model);
  if (options.new_model) parameters.push_back(Field::Raw("new_model", "true"));
  RIGCAL_ASSIGN(const std::string done, AskOnce(context, "set_policy", JsonObject(parameters)));
  OrderToGive order;
  order.verb = "set_policy", order.print = PrintSet;
  return FollowOrder(context, order, options.order, done);
}

ExitCode ShowPolicy(const Context& context, const PolicyOptions& options) {
  const std::string& robot = options.what.empty() ? options.order.robot : options.what;
  std::vector<Field> parameters;
  if (!robot.empty()) parameters.emplace_back("robot", robot);
  if (!options.model.empty()) parameters.emplace_back("model", options.model);
  return Answer(context, {"policy", JsonObject(parameters), PrintShown, {}});
}

void RunPolicy(Context& context, const PolicyOptions& options) {
  if (options.action == "show") {
    context.exit_code = ShowPolicy(context, options);
    return;
  }
  if (options.what.empty()) throw CLI::RequiredError("FILE");
  if (options.action == "set" && options.order.reason.empty()) throw CLI::RequiredError("--reason");
  const Status done = options.action == "check" ? CheckFile(context, options) : SetFile(context, options);
  if (!done) context.exit_code = Report(done.error(), context);
}

}  // namespace

void AddPolicy(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("policy", "Show, check or set the limits that robots are judged by");
  auto options = std::make_shared<PolicyOptions>();
  verb->add_option("ACTION", options->action, "show, check or set")
      ->required()
      ->check(CLI::IsMember(std::vector<std::string>(kPolicyActions.begin(), kPolicyActions.end())));
  verb->add_option("WHAT", options->what, "Of show: the robot (default: the fleet); of check and set: the file");
  CLI::Option* robot = verb->add_option("--robot", options->order.robot, "Of this robot")->type_name("ID");
  CLI::Option* model = verb->add_option("--model", options->model, "Of this rig model, as sessions name it")
                           ->type_name("NAME")
                           ->excludes(robot);
  verb->add_flag("--new-model", options->new_model, "Of set: no session is of the rig model yet, they are to come")
      ->needs(model);
  verb->add_option("--reason", options->order.reason, "Of set: why, for those who come after")->type_name("TEXT");
  verb->add_option("--by", options->order.who, "Of set: who sets it (default: the login name)")
      ->check(Named())
      ->type_name("NAME");
  verb->add_flag("--no-wait", options->order.no_wait, "Of set: end when it is safe on the server's disk");
  verb->add_option("--timeout-total", options->order.give_up_s,
                   "Give up after so many seconds without any answer (default 60)")
      ->check(CLI::Range(0.1, 1e7))
      ->type_name("S");
  verb->footer(
      "A robot's own policy goes before that of its rig model, and that before the fleet's, key by key. `check` needs "
      "no\n"
      "server, and does not know which sensors a robot has; `set` of a robot refuses those that it does not have.\n"
      "`set` of one robot waits for its new verdict. " +
      std::string(kVerdictCodes) +
      "Examples:\n"
      "  rigcal policy show mapper-01\n"
      "  rigcal policy check policy.yaml\n"
      "  rigcal policy set policy.yaml --reason \"after the new mounts\"\n"
      "  rigcal policy set policy.yaml --robot mapper-01 --reason \"it carries people\"\n"
      "  rigcal policy set policy.yaml --model mars-mapper --reason \"a stiffer frame\"\n");
  verb->callback([&context, options] { RunPolicy(context, *options); });
}

}  // namespace rigcal::client
