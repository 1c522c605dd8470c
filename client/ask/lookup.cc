#include <CLI/CLI.hpp>
#include <memory>

#include "client/positive.h"
#include "client/text/approval_text.h"
#include "client/text/part_text.h"
#include "client/text/pose_text.h"
#include "client/text/table.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

std::string QuaternionText(const Document& q_xyzw) {
  std::string text;
  for (const Document& value : q_xyzw.Items()) text += (text.empty() ? "" : " ") + Fixed(value.Number(), 9);
  return text;
}

void PrintPose(const Document& document, const std::string& b, std::ostream& out) {
  const Document pose = document["T_a_b"];
  out << "p mm       " << Triple(pose["p_m"], kMmPerM, 3) << '\n';
  out << "q_xyzw     " << QuaternionText(pose["q_xyzw"]) << '\n';
  out << "rpy deg    " << RpyText(pose, 4) << "  (R = Rz(yaw) Ry(pitch) Rx(roll))\n";
  out << "sigma mm   " << Triple(document["sigma_m"], kMmPerM, 4) << "  (along x y z of " << b << ")\n";
  out << "sigma deg  " << Triple(document["sigma_rad"], kDegPerRad, 5) << "  (about x y z of " << b << ")\n";
  out << "covariance (x y z rx ry rz of " << b << "; m, rad; T * Exp(xi))\n";
  PrintMatrix(document["covariance"], " ", out);
}

void PrintPoseInPart(const Document& document, const std::string& a, const std::string& b, std::ostream& out) {
  out << PartSentence(document, b + " in " + a) << '\n';
  out << "rpy deg    " << PartRpyText(document, 4) << "  (R = Rz(yaw) Ry(pitch) Rx(roll))\n";
  out << "along and about directions in " << a << '\n';
  PrintPart(document, document["robot_axes"], out);
}

void PrintLookup(const Document& document, std::ostream& out) {
  const std::string a = Plain(document["frame_a"].Text("?")), b = Plain(document["frame_b"].Text("?"));
  out << "T_" << a << "_" << b << "  pose of " << b << " in " << a << ", robot " << Plain(document["robot"].Text("?"))
      << ", revision " << CountOf(document["revision"]) << '\n';
  IsInPart(document) ? PrintPoseInPart(document, a, b, out) : PrintPose(document, b, out);
  PrintDrive(document, out);
  PrintVerdict(document["verdict"], document, out);
  PrintApproval(document, out);
}

// Without a whole pose there is no result to go by, whatever the verdict lets pass.
ExitCode JudgeLookup(const Document& document) {
  if (document.Has("superseded_by")) return ExitCode::kVerdictUnknown;  // the newest failed, say
  const ExitCode code = Judge(document["verdict"], document);
  return document["known"].Flag(true) || code == ExitCode::kVerdictFail ? code : ExitCode::kVerdictUnknown;
}

struct LookupOptions {
  std::string robot, a, b;
  int revision = 0;
};

ExitCode RunLookup(const Context& context, const LookupOptions& options) {
  std::vector<Field> parameters = {{"robot", options.robot}, {"a", options.a}, {"b", options.b}};
  if (options.revision > 0) parameters.emplace_back("revision", std::int64_t{options.revision});
  return Answer(context, {"lookup", JsonObject(parameters), PrintLookup, JudgeLookup});
}

}  // namespace

void AddLookup(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("lookup", "Print the pose of sensor B in sensor A with its 6x6 covariance");
  auto options = std::make_shared<LookupOptions>();
  verb->add_option("ROBOT", options->robot, "The robot's id")->required();
  verb->add_option("A", options->a, "Sensor in whose frame the pose is given")->required();
  verb->add_option("B", options->b, "Sensor whose pose it is")->required();
  verb->add_option("--revision", options->revision, "A numbered revision (default: the one that is in use)")
      ->check(Positive())
      ->type_name("N");
  verb->footer(
      "p_A = T_A_B * p_B, of the calibration that is in use: robots are told the same. " + std::string(kVerdictCodes) +
      "6 also where a direction of the pose was not measured: then it is told what was, and --json has T_a_b null.\n"
      "Examples:\n"
      "  rigcal lookup mapper-01 front_left lidar\n"
      "  rigcal lookup mapper-01 front_left lidar --json\n");
  verb->callback([&context, options] { context.exit_code = RunLookup(context, *options); });
}

}  // namespace rigcal::client
