#include <CLI/CLI.hpp>
#include <memory>

#include "client/exchange/comparison.h"
#include "client/positive.h"
#include "client/text/table.h"
#include "client/verbs.h"
#include "server/model/edges/unit_doubt.h"

namespace rigcal::client {
namespace {

struct CompareOptions {
  std::string robot, poses_file;
  int revision = 0, with_revision = 0;
  double sigmas_max = 0.0;
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

// Sensors of which only one of both has a pose.
void ListNotCompared(const KnownPoses& poses, const KnownPoses& others, Comparison& comparison) {
  for (const auto& [sensor, pose] : poses)
    if (others.count(sensor) == 0) comparison.not_compared.push_back({sensor, "has no pose in " + comparison.other});
  for (const auto& [sensor, pose] : others)
    if (poses.count(sensor) == 0)
      comparison.not_compared.push_back({sensor, "has no pose in revision " + std::to_string(comparison.revision)});
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
  const KnownPoses poses = PosesOfRevision(document);
  RIGCAL_ASSIGN(comparison.differences, ComparePoses(poses, others, comparison.reference));
  ListNotCompared(poses, others, comparison);
  return comparison;
}

ExitCode RunCompare(const Context& context, const CompareOptions& options) {
  const auto comparison = Compared(context, options);
  if (!comparison) return Report(comparison.error(), context);
  if (context.json)
    context.out << ComparisonJson(*comparison) << std::endl;
  else
    PrintComparison(*comparison, context.out);
  return JudgeComparison(*comparison, options.sigmas_max);
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
  with->add_option("--with", options->with_revision, "The revision to compare with")->type_name("N")->check(Positive());
  with->add_option("--poses", options->poses_file, "A YAML file with sensors: {NAME: {T_ref_sensor: {p_m, q_xyzw}}}")
      ->type_name("FILE");
  with->require_option(1);
  verb->add_option("--sigmas-max", options->sigmas_max,
                   "Exit with 1 if any axis is off by more of its sigmas, 6 if a sigma is not known")
      ->type_name("K")
      ->check(Positive());
  verb->footer(
      "Both are laid together at the reference sensor; e = Log(T_other^-1 T), along and about each sensor's axes.\n"
      "Exits with 6 where only one of both has a pose of a sensor: that was not compared.\n"
      "Examples:\n"
      "  rigcal compare mapper-01 --with 3                          what moved since revision 3\n"
      "  rigcal compare mapper-01 --poses visit/session.yaml        against its nominal poses\n"
      "  rigcal compare demo --poses demo/truth.yaml --sigmas-max 4  against a simulated robot's truth\n");
  verb->callback([&context, options] { context.exit_code = RunCompare(context, *options); });
}

}  // namespace rigcal::client
