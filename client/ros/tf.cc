#include <CLI/CLI.hpp>
#include <atomic>
#include <climits>
#include <csignal>
#include <memory>
#include <utility>

#include "client/exchange/calibration_query.h"
#include "client/ros/broadcast.h"
#include "client/ros/ros_place.h"
#include "client/text/table.h"
#include "client/verbs.h"
#include "server/formats/json/json_writer.h"

namespace rigcal::client {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kTfTick(200);    // how long Ctrl-C may go unnoticed
constexpr milliseconds kTfAgain(2000);  // what failed is tried again after so long

std::atomic<bool> tf_interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");
void OnTfInterrupt(int) { tf_interrupted = true; }

struct TfOptions {
  std::string robot, root;
  std::vector<std::string> frames;
  RosPlace ros;
  bool camera_info = false, once = false;
};

// --root names a sensor, or the frame that --frame gives it.
Result<CalibrationQuery> TfQueryOf(const TfOptions& options) {
  CalibrationQuery query{options.robot};
  query.may_be_overruled = false;
  RIGCAL_ASSIGN(query.frames, FramesOf(options.frames));
  if (options.root.empty()) return query;
  for (const auto& [sensor, frame] : query.frames)
    if (frame == options.root) query.root = sensor;
  if (!query.root) {
    RIGCAL_ASSIGN(query.root, SensorId::Parse(options.root));
  }
  return query;
}

struct TfLook {
  AskedCalibration asked;
  std::vector<std::string> left_out;
};

class TfPublisher {
 public:
  [[nodiscard]] static Result<TfPublisher> Open(const Context& context, const TfOptions& options);
  // True: at first, when something was announced or taken back since the last call, or when what failed is due again.
  [[nodiscard]] Result<bool> HasNews();
  // Publishes what is in use, if it is not yet. Nothing: it is. On an error what was published stays, but where the
  // server says that nothing is in use any more (kConflict).
  [[nodiscard]] Result<std::optional<TfLook>> Look();
  void LookAgain() { again_at_ = TfClock::now() + kTfAgain; }
  [[nodiscard]] RosBroadcast& broadcast() { return broadcast_; }

 private:
  using TfClock = std::chrono::steady_clock;
  TfPublisher(CalibrationQuery query, milliseconds timeout, wire::Participant participant, Connection connection,
              wire::Reader<rigcal_wire_Calibration> calibrations, wire::WaitSet waitset, RosBroadcast broadcast)
      : query_(std::move(query)),
        timeout_(timeout),
        participant_(std::move(participant)),
        connection_(std::move(connection)),
        calibrations_(std::move(calibrations)),
        waitset_(std::move(waitset)),
        broadcast_(std::move(broadcast)) {}

  CalibrationQuery query_;
  milliseconds timeout_;
  wire::Participant participant_;
  Connection connection_;
  wire::Reader<rigcal_wire_Calibration> calibrations_;
  wire::WaitSet waitset_;
  RosBroadcast broadcast_;
  // Revision and digest; 0 and empty: none. A server whose store is another may give the same number to other poses.
  std::pair<int, std::string> published_ = {};
  std::optional<TfClock::time_point> again_at_ = TfClock::now();
};

Result<TfPublisher> TfPublisher::Open(const Context& context, const TfOptions& options) {
  RIGCAL_ASSIGN(const RobotId robot, RobotId::Parse(options.robot));
  RIGCAL_ASSIGN(CalibrationQuery query, TfQueryOf(options));
  RIGCAL_ASSIGN(const int ros_domain, RosDomainOf(options.ros));
  RIGCAL_ASSIGN(auto participant, wire::Participant::Open(context.dds));
  RIGCAL_ASSIGN(auto connection, Connection::Open(participant, context.dds));
  RIGCAL_ASSIGN(auto calibrations,
                wire::Reader<rigcal_wire_Calibration>::Open(participant, {wire::RobotPartition(robot)}));
  RIGCAL_ASSIGN(auto waitset, wire::WaitSet::Open(participant));
  RIGCAL_TRY(waitset.Attach(calibrations.get()));
  RIGCAL_ASSIGN(auto broadcast, RosBroadcast::Open({ros_domain, options.ros.tag, options.camera_info}));
  return TfPublisher(std::move(query), context.timeout, std::move(participant), std::move(connection),
                     std::move(calibrations), std::move(waitset), std::move(broadcast));
}

Result<bool> TfPublisher::HasNews() {
  const bool due_now = again_at_ && TfClock::now() >= *again_at_;
  RIGCAL_TRY(waitset_.Wait(due_now ? milliseconds(0) : kTfTick));
  RIGCAL_ASSIGN(const bool any, calibrations_.TakeHint(INT_MAX));
  const bool due = again_at_ && TfClock::now() >= *again_at_;
  if (any || due) again_at_.reset();
  return any || due;
}

Result<std::optional<TfLook>> TfPublisher::Look() {
  auto asked = AskCalibration(connection_, query_, timeout_);
  if (!asked && asked.error().code == ErrorCode::kConflict) {
    broadcast_.Withdraw();
    published_ = {};
  }
  if (!asked) return Fail(asked.error());
  std::pair<int, std::string> wanted(asked->calibration.revision, asked->digest);
  if (wanted == published_) return std::nullopt;
  published_ = {};
  RIGCAL_ASSIGN(std::vector<std::string> left_out, broadcast_.Publish(asked->calibration));
  published_ = std::move(wanted);
  left_out.insert(left_out.begin(), asked->calibration.left_out.begin(), asked->calibration.left_out.end());
  return TfLook{std::move(*asked), std::move(left_out)};
}

std::string TfJson(const TfLook& look, const RosBroadcast& broadcast) {
  const exports::Calibration& calibration = look.asked.calibration;
  return formats::WriteObject([&](formats::JsonWriter& out) {
    out.Text("robot", calibration.robot.str());
    out.Integer("revision", calibration.revision);
    out.Text("standing", calibration.standing);
    out.Integer("ros_domain", broadcast.domain());
    out.Text("root", calibration.root_frame());
    out.List("frames", [&] {
      for (const exports::ExportedSensor& sensor : calibration.sensors)
        if (sensor.sensor != calibration.root) out.Text(sensor.frame);
    });
    out.List("topics", [&] {
      for (const std::string& topic : broadcast.Topics()) out.Text(topic);
    });
    out.List("left_out", [&] {
      for (const std::string& sentence : look.left_out) out.Text(sentence);
    });
  });
}

void PrintTf(const Context& context, const TfLook& look, const RosBroadcast& broadcast) {
  const exports::Calibration& calibration = look.asked.calibration;
  if (!look.asked.doubt.empty()) context.err << Plain(look.asked.doubt) << std::endl;
  for (const std::string& sentence : look.left_out) context.err << "left out: " << Plain(sentence) << std::endl;
  if (context.json) {
    context.out << TfJson(look, broadcast) << std::endl;
    return;
  }
  context.out << calibration.sensors.size() - 1 << " transforms of revision " << calibration.revision << " of "
              << calibration.robot.str() << " (" << calibration.standing << "), root " << calibration.root_frame()
              << ", ROS domain " << broadcast.domain() << ':';
  for (const std::string& topic : broadcast.Topics()) context.out << ' ' << topic;
  context.out << std::endl;
}

Status TfOnce(const Context& context, TfPublisher& publisher) {
  RIGCAL_ASSIGN(const auto look, publisher.Look());
  RIGCAL_TRY(publisher.broadcast().AwaitReaders(context.timeout));
  if (look) PrintTf(context, *look, publisher.broadcast());
  return {};
}

// A fault is said when it comes, and not again while it stays the same; the machine keeps what it was told meanwhile.
void SayTfFault(const Context& context, const Error& error, bool was_withdrawn, std::string& said) {
  const std::string sentence = Sentence(error);
  if (std::exchange(said, sentence) == sentence) return;
  (void)Report(error, context.err);
  if (was_withdrawn)
    context.err << "Programs that start now are told no transforms; those that run keep what they have until they are "
                   "started again."
                << std::endl;
}

Status TfForEver(const Context& context, TfPublisher& publisher) {
  std::string said;
  while (!tf_interrupted) {
    RIGCAL_ASSIGN(const bool news, publisher.HasNews());
    if (!news) continue;
    const bool was_published = publisher.broadcast().is_published();
    const auto look = publisher.Look();
    if (!look) {
      SayTfFault(context, look.error(), was_published && !publisher.broadcast().is_published(), said);
      publisher.LookAgain();
      continue;
    }
    said.clear();
    if (*look) PrintTf(context, **look, publisher.broadcast());
  }
  return {};
}

Status RunTf(const Context& context, const TfOptions& options) {
  struct sigaction action {};
  action.sa_handler = OnTfInterrupt;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  RIGCAL_ASSIGN(TfPublisher publisher, TfPublisher::Open(context, options));
  return options.once ? TfOnce(context, publisher) : TfForEver(context, publisher);
}

}  // namespace

void AddTf(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand("tf", "On a ROS 2 robot: publish the calibration that is in use as /tf_static");
  auto options = std::make_shared<TfOptions>();
  verb->add_option("ROBOT", options->robot, "The robot's id")->required();
  verb->add_option("--root", options->root,
                   "The parent of all frames: a sensor, or its --frame (default: the robot's reference)")
      ->type_name("FRAME");
  verb->add_option("--frame", options->frames, "Another name of a sensor's frame; may be repeated")
      ->type_name("SENSOR=FRAME");
  AddRosPlace(*verb, options->ros);
  verb->add_flag("--camera-info", options->camera_info, "Also CAMERA/camera_info of every camera with intrinsics");
  verb->add_flag("--once", options->once,
                 "End when every reader that is there has it; an error if none is, within --timeout");
  verb->footer(
      "Only what is in use, and so was approved, is published; anew when another revision is announced. While no "
      "server answers, what\n"
      "was published stays. --domain and --tag say where the server is, --ros-domain where ROS 2 is. No ROS is needed "
      "(docs/ros.md).\n"
      "Examples:\n"
      "  rigcal tf mapper-01\n"
      "  rigcal tf mapper-01 --root lidar --frame lidar=top_lidar_link --camera-info\n"
      "  rigcal tf mapper-01 --ros-domain 42 --once --timeout 10\n");
  verb->callback([&context, options] {
    const Status done = RunTf(context, *options);
    if (!done) context.exit_code = Report(done.error(), context);
  });
}

}  // namespace rigcal::client
