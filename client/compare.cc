#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>

#include "client/pose_comparison.h"
#include "client/pose_text.h"
#include "client/positive.h"
#include "client/table.h"
#include "client/verbs.h"
#include "server/formats/json_values.h"
#include "server/model/unit_doubt.h"

namespace rigcal::client {
namespace {

struct CompareOptions {
  std::string robot, poses_file;
  int revision = 0, with_revision = 0;
  double sigmas_max = 0.0;
};

struct Comparison {
  std::string robot, reference, other;
  std::int64_t revision = 0;
  std::vector<PoseDifference> differences;
};

Result<Document> AskRevision(const Context& context, const std::string& robot, int revision) {
  std::vector<Field> parameters = {{"robot", robot}};
  if (revision > 0) parameters.emplace_back("revision", std::int64_t{revision});
  RIGCAL_ASSIGN(const std::string text, AskOnce(context, "show", JsonObject(parameters)));
  return Document::Parse(text, "the server's answer to 'show'");
}

std::string UnitDoubtOf(const KnownPoses& poses) {
  std::map<std::string, Eigen::Vector3d> p_m;
  for (const auto& [sensor, pose] : poses) p_m[sensor] = pose.T_ref_sensor.p_m;
  return UnitDoubt(p_m);
}

Result<Comparison> Compared(const Context& context, const CompareOptions& options) {
  RIGCAL_ASSIGN(const Document answer, AskRevision(context, options.robot, options.revision));
  const Document document = answer["document"];
  KnownPoses others;
  Comparison comparison{
      options.robot, document["reference"].Text(), options.poses_file, answer["revision"].Integer().value_or(0), {}};
  if (options.poses_file.empty()) {
    RIGCAL_ASSIGN(const Document other, AskRevision(context, options.robot, options.with_revision));
    others = PosesOfRevision(other["document"]);
    comparison.other = "revision " + std::to_string(options.with_revision);
  } else {
    RIGCAL_ASSIGN(others, PosesOfFile(options.poses_file));
    SayUnitDoubt(options.poses_file, UnitDoubtOf(others), context.err);
  }
  RIGCAL_ASSIGN(comparison.differences, ComparePoses(PosesOfRevision(document), others, comparison.reference));
  return comparison;
}

// Root mean square over the sensors of the length of one half of e.
double Rms(const std::vector<PoseDifference>& differences, int start) {
  double sum = 0;
  for (const PoseDifference& difference : differences) sum += difference.e.segment<3>(start).squaredNorm();
  return std::sqrt(sum / static_cast<double>(differences.size()));
}

double WorstSigmas(const Comparison& comparison) {
  double worst = 0;
  for (const PoseDifference& difference : comparison.differences)
    worst = std::max(worst, difference.WorstSigmas().value_or(0.0));
  return worst;
}

// Of the least certain axis, as on the page.
std::optional<double> Largest(const std::optional<Vector6d>& sigma, int start) {
  if (!sigma) return std::nullopt;
  return sigma->segment<3>(start).maxCoeff();
}

void PrintCompare(const Comparison& comparison, std::ostream& out) {
  out << Plain(comparison.robot) << ", revision " << comparison.revision << ", against " << Plain(comparison.other)
      << ", in " << Plain(comparison.reference) << '\n';
  Table table({{"SENSOR"},
               {"moved mm", Align::kRight},
               {"sigma mm", Align::kRight},
               {"turned deg", Align::kRight},
               {"sigma deg", Align::kRight},
               {"worst axis", Align::kRight}});
  for (const PoseDifference& difference : comparison.differences) {
    const auto worst = difference.WorstSigmas();
    table.Add({difference.sensor, Scaled(difference.e.head<3>().norm(), kMmPerM, 3),
               Scaled(Largest(difference.sigma, 0), kMmPerM, 3), Scaled(difference.e.tail<3>().norm(), kDegPerRad, 4),
               Scaled(Largest(difference.sigma, 3), kDegPerRad, 4), worst ? Fixed(worst, 1) + " sigma" : "-"});
  }
  table.Print(out);
  out << "rms " << Fixed(Rms(comparison.differences, 0) * kMmPerM, 3) << " mm, "
      << Fixed(Rms(comparison.differences, 3) * kDegPerRad, 4) << " deg\n";
}

void WriteDifference(formats::JsonWriter& out, const PoseDifference& difference) {
  out.Object([&] {
    out.Text("id", difference.sensor);
    formats::WriteVector(out, "e", difference.e);
    if (difference.sigma)
      formats::WriteVector(out, "sigma", *difference.sigma);
    else
      out.Null("sigma");
    if (const auto worst = difference.WorstSigmas())
      out.Number("worst_sigmas", *worst);
    else
      out.Null("worst_sigmas");
  });
}

std::string Json(const Comparison& comparison) {
  return formats::WriteObject([&](formats::JsonWriter& out) {
    out.Text("robot", comparison.robot);
    out.Integer("revision", comparison.revision);
    out.Text("reference", comparison.reference);
    out.Text("with", comparison.other);
    out.Number("rms_m", Rms(comparison.differences, 0));
    out.Number("rms_rad", Rms(comparison.differences, 3));
    out.Number("worst_sigmas", WorstSigmas(comparison));
    out.List("sensors", [&] {
      for (const PoseDifference& difference : comparison.differences) WriteDifference(out, difference);
    });
  });
}

// Where a sigma is not known, an axis may be off by any number of them.
ExitCode JudgeSigmas(const Comparison& comparison, double sigmas_max) {
  if (WorstSigmas(comparison) > sigmas_max) return ExitCode::kVerdictFail;
  const bool all_judged =
      std::all_of(comparison.differences.begin(), comparison.differences.end(),
                  [](const PoseDifference& difference) { return difference.WorstSigmas().has_value(); });
  return all_judged ? ExitCode::kGood : ExitCode::kVerdictUnknown;
}

ExitCode RunCompare(const Context& context, const CompareOptions& options) {
  const auto comparison = Compared(context, options);
  if (!comparison) return Report(comparison.error(), context);
  if (context.json)
    context.out << Json(*comparison) << std::endl;
  else
    PrintCompare(*comparison, context.out);
  return options.sigmas_max > 0 ? JudgeSigmas(*comparison, options.sigmas_max) : ExitCode::kGood;
}

}  // namespace

void AddCompare(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("compare", "Compare a robot's poses with another revision or a file of poses");
  auto options = std::make_shared<CompareOptions>();
  verb->add_option("ROBOT", options->robot, "The robot's id")->required();
  verb->add_option("--revision", options->revision, "A numbered revision (default: the newest)")
      ->type_name("N")
      ->check(Positive());
  CLI::Option_group* with = verb->add_option_group("with");
  with->add_option("--with", options->with_revision, "The revision to compare with")
      ->type_name("N")
      ->check(Positive());
  with->add_option("--poses", options->poses_file, "A YAML file with sensors: {NAME: {T_ref_sensor: {p_m, q_xyzw}}}")
      ->type_name("FILE");
  with->require_option(1);
  verb->add_option("--sigmas-max", options->sigmas_max,
                   "Exit with 1 if any axis is off by more of its sigmas, 6 if a sigma is not known")
      ->type_name("K")
      ->check(Positive());
  verb->footer(
      "Both are laid together at the reference sensor; e = Log(T_other^-1 T), along and about each sensor's axes.\n"
      "Examples:\n"
      "  rigcal compare mapper-01 --with 3                          what moved since revision 3\n"
      "  rigcal compare mapper-01 --poses visit/session.yaml        against the nominal poses of the drawing\n"
      "  rigcal compare demo --poses demo/truth.yaml --sigmas-max 4  against a simulated robot's truth\n");
  verb->callback([&context, options] { context.exit_code = RunCompare(context, *options); });
}

}  // namespace rigcal::client
