#include <CLI/CLI.hpp>
#include <memory>

#include "client/pose_text.h"
#include "client/table.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

std::string QuaternionText(const Document& q_xyzw) {
  std::string text;
  for (const Document& value : q_xyzw.Items()) text += (text.empty() ? "" : " ") + Fixed(value.Number(), 9);
  return text;
}

void PrintLookup(const Document& document, std::ostream& out) {
  const std::string a = Plain(document["frame_a"].Text("?")), b = Plain(document["frame_b"].Text("?"));
  const Document pose = document["T_a_b"];
  out << "T_" << a << "_" << b << "  pose of " << b << " in " << a << ", robot " << Plain(document["robot"].Text("?"))
      << ", revision " << CountOf(document["revision"]) << '\n';
  out << "p mm       " << Triple(pose["p_m"], kMmPerM, 3) << '\n';
  out << "q_xyzw     " << QuaternionText(pose["q_xyzw"]) << '\n';
  out << "rpy deg    " << RpyText(pose, 4) << "  (R = Rz(yaw) Ry(pitch) Rx(roll))\n";
  out << "sigma mm   " << Triple(document["sigma_m"], kMmPerM, 4) << "  (along x y z of " << b << ")\n";
  out << "sigma deg  " << Triple(document["sigma_rad"], kDegPerRad, 5) << "  (about x y z of " << b << ")\n";
  out << "covariance (x y z rx ry rz of " << b << "; m, rad; T * Exp(xi))\n";
  PrintMatrix(document["covariance"], " ", out);
  PrintDrive(document, out);
  PrintVerdict(document["verdict"], document, out);
}

struct LookupOptions {
  std::string robot, a, b;
};

ExitCode RunLookup(const Context& context, const LookupOptions& options) {
  const std::string parameters = JsonObject({{"robot", options.robot}, {"a", options.a}, {"b", options.b}});
  return Answer(context, {"lookup", parameters, PrintLookup,
                          [](const Document& document) { return Judge(document["verdict"], document); }});
}

}  // namespace

void AddLookup(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("lookup", "Print the pose of sensor B in sensor A with its 6x6 covariance");
  auto options = std::make_shared<LookupOptions>();
  verb->add_option("ROBOT", options->robot, "The robot's id")->required();
  verb->add_option("A", options->a, "Sensor in whose frame the pose is given")->required();
  verb->add_option("B", options->b, "Sensor whose pose it is")->required();
  verb->footer("p_A = T_A_B * p_B. " + std::string(kVerdictCodes) +
               "Examples:\n"
               "  rigcal lookup mapper-01 front_left lidar\n"
               "  rigcal lookup mapper-01 front_left lidar --json\n");
  verb->callback([&context, options] { context.exit_code = RunLookup(context, *options); });
}

}  // namespace rigcal::client
