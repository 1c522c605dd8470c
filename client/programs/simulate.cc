#include "client/sim/simulate.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>

#include "client/programs/simulate_disturbances.h"
#include "client/sim/bound.h"
#include "client/sim/rig/rig_yaml.h"
#include "client/text/progress.h"
#include "client/text/table.h"
#include "client/verbs.h"
#include "client/wire/transfer.h"

namespace rigcal::client {
namespace {

struct Options {
  std::string rig, out, print_rig, motion = "free", intrinsics = "calibrated", format = "jpg";
  double tilt_deg = -1;
  int captures = 0, threads = 0;
  DisturbanceWords disturbances;
  sim::Options simulation;
};

Result<sim::Options> Simulation(const Options& options) {
  sim::Options simulation = options.simulation;
  if (options.captures > 0) simulation.captures = options.captures;
  if (options.tilt_deg >= 0) simulation.tilt_rms_rad = options.tilt_deg * M_PI / 180;
  if (options.motion == "planar") simulation.motion = sim::MotionKind::kPlanar;
  if (options.motion == "spot") simulation.motion = sim::MotionKind::kSpot;
  if (options.intrinsics == "exact") simulation.intrinsics = sim::IntrinsicsKind::kExact;
  if (options.intrinsics == "absent") simulation.intrinsics = sim::IntrinsicsKind::kAbsent;
  RIGCAL_TRY(ReadDisturbances(options.disturbances, simulation));
  return simulation;
}

struct Done {
  sim::Truth truth;
  bool is_written = false;  // what follows is of the folder
  sim::WriteSummary summary;
  double seconds = 0.0;
};

Result<Done> Record(const Context& context, const Options& options) {
  RIGCAL_ASSIGN(sim::Rig rig, sim::LoadRig(options.rig));
  RIGCAL_ASSIGN(const sim::Options simulation, Simulation(options));
  RIGCAL_ASSIGN(const sim::Experiment experiment, sim::Prepare(std::move(rig), simulation));
  Done done;
  done.truth = sim::TruthOf(experiment);
  for (const auto& [id, bound] : sim::CramerRaoBound(experiment)) done.truth.sensors.at(id).bound = bound;
  if (options.out.empty()) return done;
  const std::int64_t start_ns = SteadyNow_ns();
  Progress progress(context.err, context.err_is_terminal, "Simulating", start_ns, Progress::Unit::kFiles);
  const sim::WriteOptions write{options.format == "png" ? sim::PictureFormat::kPng : sim::PictureFormat::kJpeg,
                                options.threads};
  auto summary = sim::WriteSession(experiment, done.truth, options.out, write, [&](std::size_t files, std::size_t all) {
    progress.Show({static_cast<std::int64_t>(files), static_cast<std::int64_t>(all), ""}, SteadyNow_ns());
  });
  progress.Clear();
  if (!summary) return Fail(summary.error());
  done.summary = *summary;
  done.is_written = true;
  done.seconds = static_cast<double>(SteadyNow_ns() - start_ns) * 1e-9;
  return done;
}

nlohmann::json JsonOf(const Se3& T) {
  const Eigen::Vector4d q = T.q.coeffs();
  return {{"p_m", {T.p_m.x(), T.p_m.y(), T.p_m.z()}}, {"q_xyzw", {q[0], q[1], q[2], q[3]}}};
}

nlohmann::json JsonOf(const sim::SensorTruth& sensor) {
  nlohmann::json json = {{"type", NameOf(sensor.kind)}, {"T_ref_sensor", JsonOf(sensor.T_ref_sensor)}};
  if (sensor.T_ref_bumped) json["T_ref_bumped"] = JsonOf(*sensor.T_ref_bumped);
  if (!sensor.bound) return json;
  for (const std::optional<double>& sigma : *sensor.bound)
    json["bound_sigma"].push_back(sigma ? nlohmann::json(*sigma) : nlohmann::json());
  return json;
}

void PrintJson(const Options& options, const Done& done, std::ostream& out) {
  nlohmann::json sensors = nlohmann::json::object();
  for (const auto& [id, sensor] : done.truth.sensors) sensors[id.str()] = JsonOf(sensor);
  out << nlohmann::json{{"rig", done.truth.rig},
                        {"folder", done.is_written ? nlohmann::json(options.out) : nlohmann::json()},
                        {"reference", done.truth.reference.str()},
                        {"captures", done.truth.captures.size()},
                        {"pictures", done.summary.pictures},
                        {"clouds", done.summary.clouds},
                        {"points", done.summary.points},
                        {"bytes", done.summary.bytes},
                        {"pixels", done.summary.pixels},
                        {"threads", done.summary.threads},
                        {"seconds", done.seconds},
                        {"mpx_per_s_per_thread", done.summary.MegapixelsPerSecond()},
                        {"sensors", sensors}}
             .dump()
      << '\n';
}

std::string SigmaText(const sim::BoundSigma& bound, std::size_t first, double scale, int digits) {
  std::string text;
  for (std::size_t i = first; i < first + 3; ++i)
    text += (text.empty() ? "" : " ") + (bound[i] ? Fixed(*bound[i] * scale, digits) : std::string("-"));
  return text;
}

void PrintText(const Options& options, const Done& done, std::ostream& out) {
  out << done.truth.rig << ": " << done.truth.captures.size() << " captures";
  if (done.is_written)
    out << ", " << done.summary.pictures << " pictures, " << done.summary.clouds << " clouds in " << options.out << '\n'
        << ByteText(static_cast<double>(done.summary.bytes)) << " in " << DurationText(done.seconds) << ", "
        << Fixed(done.summary.MegapixelsPerSecond(), 1) << " Mpx/s on each thread";
  out << '\n';
  Table table({{"sensor"}, {"bound mm, x y z"}, {"bound deg, x y z"}});
  for (const auto& [id, sensor] : done.truth.sensors)
    if (sensor.bound)
      table.Add({id.str(), SigmaText(*sensor.bound, 0, 1e3, 3), SigmaText(*sensor.bound, 3, 180 / M_PI, 4)});
  if (table.empty()) return;
  out << "Cramer-Rao bound of the poses in " << done.truth.reference.str()
      << ", one sigma along and about each sensor's axes:\n";
  table.Print(out);
}

Status Run(const Context& context, const Options& options) {
  if (!options.print_rig.empty()) {
    RIGCAL_ASSIGN(const std::string text, sim::BuiltInRig(options.print_rig));
    context.out << text;
    return {};
  }
  if (options.rig.empty())
    return Fail(ErrorCode::kInvalidInput, "the rig is not named",
                "For example: rigcal simulate mars-mapper --out visit/");
  RIGCAL_ASSIGN(const Done done, Record(context, options));
  if (context.json)
    PrintJson(options, done, context.out);
  else
    PrintText(options, done, context.out);
  return {};
}

void AddOptions(CLI::App& verb, Options& options) {
  sim::Options& simulation = options.simulation;
  verb.add_option("RIG", options.rig, "mars-mapper, eye-to-hand-cell, or a YAML file (see --print-rig)");
  verb.add_option("--out", options.out, "Folder to write, new or empty; without it only the bound is printed")
      ->type_name("DIR");
  verb.add_option("--print-rig", options.print_rig, "Print a built-in rig's YAML and stop")->type_name("NAME");
  verb.add_option("--captures", options.captures, "How many (default: the rig's)")
      ->type_name("N")
      ->check(CLI::Range(1, 10'000));
  verb.add_option("--scale", simulation.scale_ratio, "Size of the pictures, 1 is full")->type_name("RATIO");
  verb.add_option("--seed", simulation.seed, "Of everything that is drawn at random (default 1)")->type_name("N");
  verb.add_option("--noise", simulation.noise_factor, "Factor on all noise (default 1)")->type_name("FACTOR");
  verb.add_option("--dropouts", simulation.dropout_ratio, "Part of the files that is missing")->type_name("RATIO");
  verb.add_option("--motion", options.motion, "free; planar: level; spot: turning about one upright axis")
      ->check(CLI::IsMember({"free", "planar", "spot"}));
  verb.add_option("--tilt-deg", options.tilt_deg, "Tilt of the poses, rms (default: the rig's; 0 if planar or spot)")
      ->type_name("DEG")
      ->check(CLI::Range(0.0, 45.0));
  verb.add_option("--board-scale", simulation.board_scale_ratio, "True size of the boards over the declared one")
      ->type_name("RATIO");
  verb.add_option("--lidar-bias-m", simulation.lidar_bias_sigma_m, "Sigma of a constant error that each beam has")
      ->type_name("M")
      ->check(CLI::Range(0.0, 1.0));
  verb.add_option(
          "--intrinsics", options.intrinsics,
          "What session.yaml says of the lenses: exact; calibrated: with the errors and sigmas of a calibration "
          "beforehand (default); absent: to be estimated")
      ->check(CLI::IsMember({"exact", "calibrated", "absent"}));
  verb.add_option("--format", options.format, "Of pictures: jpg (quality 90, default) or png")
      ->check(CLI::IsMember({"jpg", "png"}));
  verb.add_option("--captured-at", simulation.captured_at, "Time of the visit (default 2026-01-31T12:00:00Z)")
      ->type_name("TIME");
  verb.add_option("--threads", options.threads, "At most (default: all)")->type_name("N")->check(CLI::Range(1, 1024));
  AddDisturbances(verb, options.disturbances, simulation);
}

}  // namespace

void AddSimulate(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(kSimulateVerb.name, kSimulateVerb.description);
  auto options = std::make_shared<Options>();
  AddOptions(*verb, *options);
  verb->footer(
      "Needs no server. The same rig, options and seed give the same bytes. truth.yaml holds the true poses; `rigcal "
      "push`\n"
      "leaves it away.\n"
      "Examples:\n"
      "  rigcal simulate mars-mapper --out visit/                              40 captures of 9 cameras, full size\n"
      "  rigcal simulate mars-mapper --out small/ --scale 0.4 --captures 16    the same in seconds\n"
      "  rigcal simulate mars-mapper --captures 20                             how well can it be known at all?\n"
      "  rigcal simulate mars-mapper --out level/ --motion planar --seed 7\n"
      "  rigcal simulate mars-mapper --out moved/ --bump back --bump-at 0.25   a sensor gives way during the visit\n"
      "  rigcal simulate eye-to-hand-cell --out cell/                          two cameras beside a robot with a "
      "board\n"
      "  rigcal simulate --print-rig mars-mapper > mine.yaml                   to begin a rig of your own\n"
      "  rigcal simulate mine.yaml --out visit/ --json\n");
  verb->callback([&context, options] {
    if (const Status done = Run(context, *options); !done) context.exit_code = Report(done.error(), context);
  });
}

}  // namespace rigcal::client
