#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <memory>

#include "client/boards/text.h"
#include "client/positive.h"
#include "client/text/approval_text.h"
#include "client/text/cause_list.h"
#include "client/text/edge_table.h"
#include "client/text/insight_table.h"
#include "client/text/part_text.h"
#include "client/text/pose_text.h"
#include "client/text/standing_text.h"
#include "client/text/table.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

// "0.100 0.200 0.300 (limit 5)": of a server that says what they are held against.
std::string WithLimit(const std::string& sigmas, const Document& limit, double scale) {
  if (!limit.Number()) return sigmas;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), " (limit %.3g)", *limit.Number() * scale);
  return sigmas + text.data();
}

void PrintPoses(const Document& revision, std::ostream& out) {
  out << "\nPoses in " << Plain(revision["reference"].Text("?")) << '\n';
  Table table({{"SENSOR"},
               {"p mm", Align::kRight},
               {"rpy deg", Align::kRight},
               {"sigma mm", Align::kRight},
               {"sigma deg", Align::kRight}});
  for (const Document& sensor : revision["sensors"].Items()) {
    const Document pose = sensor["T_ref_sensor"];
    const bool known = sensor["known"].Flag(), in_part = IsInPart(sensor);
    table.Add(
        {sensor["id"].Text("?"),
         known     ? Triple(pose["p_m"], kMmPerM, 2)
         : in_part ? OpenText(sensor)
                   : "unknown",
         known     ? RpyText(pose, 3)
         : in_part ? PartRpyText(sensor, 3)
                   : "",
         known ? WithLimit(Triple(sensor["sigma_m"], kMmPerM, 3), sensor["tolerance_m"], kMmPerM) : "",
         known ? WithLimit(Triple(sensor["sigma_rad"], kDegPerRad, 4), sensor["tolerance_rad"], kDegPerRad) : ""});
  }
  table.Print(out);
  PrintParts(revision, out);
  for (const Document& gone : revision["retired_sensors"].Items())
    out << RetiredSensorText(revision["robot"].Text("?"), gone) << '\n';
}

// Of a server that tells it.
void PrintAsFound(const Document& as_found, std::ostream& out) {
  const std::string text = as_found["text"].Text();
  if (!text.empty()) out << Plain(text) << '\n';
}

void PrintShow(const Document& document, bool whole, std::ostream& out) {
  const Document revision = document["document"];
  const Cures cures = revision["causes"].size() == 0 ? Cures::kTold : Cures::kLeftToTheCause;
  out << Plain(document["robot"].Text("?")) << ", revision " << CountOf(document["revision"]) << ", calibrated "
      << DayOf(document["calibrated_at"]) << ", solved " << AgeOf(document["age_ns"]) << " ago\n";
  PrintDrive(document, out);
  PrintVerdict(revision["verdict"], document, out);
  PrintApproval(document, out);
  PrintCauses(revision["causes"], out);
  PrintAsFound(document["as_found"], out);
  PrintBoardRemarks(document["board_remarks"], out);
  PrintGlobalError(revision, out);
  PrintDiagnoses(revision["diagnoses"], out, cures);
  PrintPoses(revision, out);
  out << "\nEdges\n";
  if (whole)
    PrintEdges(revision["edges"].Items(), out, EdgeIds::kHidden, cures);
  else
    PrintEdgesByCause(revision["causes"], revision["edges"].Items(), out);
  PrintInfluence(revision, out);
  PrintLoops(revision, out);
}

struct ShowOptions {
  std::string robot;
  int revision = 0;
  bool whole = false;
};

ExitCode RunShow(const Context& context, const ShowOptions& options) {
  std::vector<Field> parameters = {{"robot", options.robot}};
  if (options.revision > 0) parameters.emplace_back("revision", std::int64_t{options.revision});
  if (options.whole && context.json) parameters.push_back(Field::Raw("whole", "true"));
  const auto print = [&](const Document& document, std::ostream& out) { PrintShow(document, options.whole, out); };
  return Answer(context, {"show", JsonObject(parameters), print, [](const Document& document) {
                            if (document.Has("superseded_by"))
                              return ExitCode::kVerdictUnknown;  // whatever it said then
                            return Judge(document["document"]["verdict"], document);
                          }});
}

}  // namespace

void AddShow(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(
      "show", "Show a robot's calibration: verdict, causes, what was found, poses with sigma, edges, loops");
  auto options = std::make_shared<ShowOptions>();
  verb->add_option("ROBOT", options->robot, "The robot's id")->required();
  verb->add_option("--revision", options->revision, "A numbered revision (default: the newest)")
      ->check(Positive())
      ->type_name("N");
  verb->add_flag(
      "--whole", options->whole,
      "Each failed pair with its own reason; with --json: every edge with its captures, evidence, information "
      "and covariance");
  verb->footer(std::string(kVerdictCodes) +
               "Examples:\n"
               "  rigcal show mapper-01\n"
               "  rigcal show mapper-01 --revision 3\n"
               "  rigcal show mapper-01 --whole --json > mapper-01.json\n");
  verb->callback([&context, options] { context.exit_code = RunShow(context, *options); });
}

}  // namespace rigcal::client
