#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <memory>

#include "client/change/order.h"
#include "client/named.h"
#include "client/text/table.h"
#include "client/verbs.h"
#include "server/base/files/durable_file.h"
#include "server/formats/rig_models/rig_model_answers.h"
#include "server/formats/rig_models/rig_model_yaml.h"

namespace rigcal::client {
namespace {

constexpr double kMmOfMetre = 1000.0;

struct ModelOptions {
  std::string action, what;
  bool new_model = false;
  OrderOptions order;
};

std::string ShortNumber(const Document& value, double scale) {
  if (!value.Number()) return "-";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", *value.Number() * scale);
  return text.data();
}

std::string PlaceOfSensor(const Document& pose) {
  const std::vector<Document> p_m = pose["p_m"].Items();
  if (p_m.size() != 3) return "-";
  return ShortNumber(p_m[0], kMmOfMetre) + " " + ShortNumber(p_m[1], kMmOfMetre) + " " +
         ShortNumber(p_m[2], kMmOfMetre);
}

void PrintModel(const Document& model, std::ostream& out) {
  out << "Rig model " << Plain(model["rig_model"].Text("?")) << ", places in the frame of "
      << Plain(model["reference"].Text("?")) << "\n";
  Table table({{"SENSOR"}, {"TYPE"}, {"x y z, mm", Align::kRight}, {"+-mm", Align::kRight}, {"+-deg", Align::kRight}});
  for (const Document& sensor : model["sensors"].Items())
    table.Add({sensor["id"].Text("?"), sensor["type"].Text("?"), PlaceOfSensor(sensor["T_ref_sensor"]),
               ShortNumber(sensor["tolerance_m"], kMmOfMetre), ShortNumber(sensor["tolerance_rad"], kDegreesOfRadian)});
  table.Print(out);
  for (const Document& pair : model["required_pairs"].Items())
    if (const std::vector<Document> ends = pair.Items(); ends.size() == 2)
      out << "required: " << Plain(ends[0].Text("?")) << " - " << Plain(ends[1].Text("?")) << '\n';
}

void PrintModelShown(const Document& document, std::ostream& out) {
  PrintModel(document["model"], out);
  const Document set = document["set"];
  out << "Version " << CountOf(set["version"]) << ", set by " << Plain(set["who"].Text("?")) << " on "
      << DayOf(set["at"]) << ": " << Plain(set["reason"].Text()) << "\nRobots of it: " << CountOf(document["robots"])
      << ". `rigcal fleet` tells how they scatter.\n";
}

void PrintModelList(const Document& document, std::ostream& out) {
  const std::vector<Document> rows = document["rig_models"].Items();
  if (rows.empty()) out << "No rig model is known yet: a session names its own as rig_model in session.yaml.\n";
  if (rows.empty()) return;
  Table table({{"RIG MODEL"}, {"VERSION", Align::kRight}, {"ROBOTS", Align::kRight}});
  for (const Document& row : rows)
    table.Add({Plain(row["rig_model"].Text("?")), row["version"].Integer() ? CountOf(row["version"]) : "not set",
               CountOf(row["robots"])});
  table.Print(out);
}

void PrintModelSet(const Document& done, std::ostream& out) {
  const Document set = done["set"];
  const std::int64_t waiting = done["robots_waiting"].Integer().value_or(0);
  out << "Rig model " << Plain(set["rig_model"].Text("?")) << " is version " << CountOf(set["version"]) << ", set by "
      << Plain(set["who"].Text("?")) << ".\n";
  if (waiting > 0)
    out << waiting << (waiting == 1 ? " robot is" : " robots are")
        << " judged anew when the server has nothing else to do; `rigcal status` tells.\n";
  else
    out << "No robot is to be judged anew by it; it holds for those to come.\n";
}

Result<RigModel> ReadModelFile(const std::string& file, std::string& text) {
  RIGCAL_ASSIGN(text, ReadFile(file, formats::kRigModelBytesMax));
  return formats::ReadRigModel(text, file);
}

// Without a server.
Status CheckModelFile(const Context& context, const ModelOptions& options) {
  std::string text;
  RIGCAL_ASSIGN(const RigModel model, ReadModelFile(options.what, text));
  const std::string told = formats::WriteRigModelCheck(options.what, model);
  RIGCAL_ASSIGN(const Document document, Document::Parse(told, options.what));
  if (context.json) {
    context.out << told << std::endl;
    return {};
  }
  context.out << Plain(options.what) << " is good.\n";
  PrintModel(document["model"], context.out);
  return {};
}

Status SetModelFile(Context& context, const ModelOptions& options) {
  std::string text;
  RIGCAL_TRY(ReadModelFile(options.what, text));
  std::vector<Field> parameters = {
      {"reason", options.order.reason}, {"text", text}, {"who", WhoAsks(options.order.who)}};
  if (options.new_model) parameters.push_back(Field::Raw("new_model", "true"));
  RIGCAL_ASSIGN(const std::string done, AskOnce(context, "set_rig_model", JsonObject(parameters)));
  OrderToGive order;
  order.verb = "set_rig_model", order.print = PrintModelSet;
  return FollowOrder(context, order, options.order, done);
}

void RunModel(Context& context, const ModelOptions& options) {
  if (options.action == "list") {
    context.exit_code = Answer(context, {"rig_models", JsonObject({}), PrintModelList, {}});
    return;
  }
  if (options.what.empty()) throw CLI::RequiredError(options.action == "show" ? "NAME" : "FILE");
  if (options.action == "show") {
    context.exit_code = Answer(context, {"rig_model", JsonObject({{"model", options.what}}), PrintModelShown, {}});
    return;
  }
  if (options.action == "set" && options.order.reason.empty()) throw CLI::RequiredError("--reason");
  const Status done = options.action == "check" ? CheckModelFile(context, options) : SetModelFile(context, options);
  if (!done) context.exit_code = Report(done.error(), context);
}

}  // namespace

void AddModel(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(
      "model", "Show, list, check or set rig models: which sensors a kind of machine has, and where");
  auto options = std::make_shared<ModelOptions>();
  verb->add_option("ACTION", options->action, "show, list, check or set")
      ->required()
      ->check(CLI::IsMember(std::vector<std::string>(kModelActions.begin(), kModelActions.end())));
  verb->add_option("WHAT", options->what, "Of show: the rig model; of check and set: the file");
  verb->add_flag("--new-model", options->new_model, "Of set: no session is of the rig model yet, they are to come");
  verb->add_option("--reason", options->order.reason, "Of set: why, for those who come after")->type_name("TEXT");
  verb->add_option("--by", options->order.who, "Of set: who sets it (default: the login name)")
      ->check(Named())
      ->type_name("NAME");
  verb->footer(
      "A robot is of the rig model that its newest session names. What it lacks of it, and poses farther from the "
      "nominal ones\n"
      "than the tolerance, are told by its verdict. `check` needs no server.\n"
      "Examples:\n"
      "  rigcal model check mars-mapper.yaml\n"
      "  rigcal model set mars-mapper.yaml --reason \"drawing 7\"\n"
      "  rigcal model show mars-mapper\n"
      "  rigcal model list\n");
  verb->callback([&context, options] { RunModel(context, *options); });
}

}  // namespace rigcal::client
