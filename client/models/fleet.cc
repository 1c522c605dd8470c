#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>

#include "client/text/table.h"
#include "client/verbs.h"
#include "server/model/approval/policy.h"

namespace rigcal::client {
namespace {

// Of metres or radians: what arithmetic leaves over, where zero is the median itself.
constexpr double kLeftOver = 1e-12;

// A number of an axis in mm or deg: the member's name ends in the unit in which it is kept.
std::string AxisNumber(const Document& axis, const std::string& name) {
  const Document metres = axis[name + "_m"], radians = axis[name + "_rad"];
  const auto value = metres.Number() ? metres.Number() : radians.Number();
  if (!value) return "-";
  if (std::abs(*value) < kLeftOver) return "0";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", *value * (metres.Number() ? 1000.0 : kDegreesOfRadian));
  return text.data();
}

void PrintSensorSpread(const Document& sensor, std::ostream& out) {
  const bool drawn = !sensor["T_ref_nominal"].IsNull();
  out << '\n'
      << Plain(sensor["id"].Text("?")) << " on " << CountOf(sensor["robots"]) << " robots, from "
      << (drawn ? "its nominal pose" : "the median of all, as nothing is drawn") << '\n';
  Table table({{"AXIS"},
               {""},
               {"MEDIAN", Align::kRight},
               {"SPREAD", Align::kRight},
               {"LEAST", Align::kRight},
               {"MOST", Align::kRight}});
  for (const Document& axis : sensor["axes"].Items()) {
    const bool turns = axis["median_m"].IsNull();
    table.Add({axis["axis"].Text("?"), turns ? "deg" : "mm", AxisNumber(axis, "median"), AxisNumber(axis, "spread"),
               AxisNumber(axis, "min"), AxisNumber(axis, "max")});
  }
  table.Print(out);
}

void PrintSentences(const Document& sentences, std::ostream& out) {
  for (const Document& sentence : sentences.Items()) out << Plain(sentence.Text()) << '\n';
}

void PrintPopulation(const Document& document, std::ostream& out) {
  out << "Rig model " << Plain(document["rig_model"].Text("?")) << ", " << CountOf(document["robots"])
      << " robots with a calibration in use";
  if (!document["reference"].IsNull()) out << ", told in the frame of " << Plain(document["reference"].Text());
  out << '\n';
  if (!document["why_not"].IsNull()) out << Plain(document["why_not"].Text()) << '\n';
  PrintSentences(document["off_the_drawing"], out);
  PrintSentences(document["outlier_texts"], out);
  if (document["why_not"].IsNull() && document["outlier_texts"].Items().empty())
    out << "No robot stands out by more than chance.\n";
  for (const Document& sensor : document["sensors"].Items()) PrintSensorSpread(sensor, out);
  for (const Document& sensor : document["too_few"].Items())
    out << Plain(sensor["id"].Text("?")) << ": its pose is known on " << CountOf(sensor["robots"]) << " robots only\n";
  for (const Document& robot : document["left_out"].Items())
    out << "left out: " << Plain(robot["robot"].Text("?")) << ", " << Plain(robot["why"].Text()) << '\n';
}

}  // namespace

void AddFleet(CLI::App& app, Context& context) {
  CLI::App* verb =
      app.add_subcommand("fleet", "Tell how the sensors of a rig model sit on its robots, and which robots stand out");
  auto model = std::make_shared<std::string>();
  verb->add_option("MODEL", *model, "The rig model, as sessions name it")->required();
  verb->footer(
      "Of the calibrations that are in use, of five robots or more. Places are told against the nominal poses (`rigcal "
      "model set`),\n"
      "or against the median of all. SPREAD is 1 sigma, robust: robots that stand out do not widen it.\n"
      "Examples:\n"
      "  rigcal fleet mars-mapper\n"
      "  rigcal fleet mars-mapper --json\n");
  verb->callback([&context, model] {
    context.exit_code = Answer(context, {"population", JsonObject({{"model", *model}}), PrintPopulation, {}});
  });
}

}  // namespace rigcal::client
