#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>

#include "client/programs/bag_work.h"
#include "client/programs/interrupt.h"
#include "client/record/player.h"
#include "client/ros/ros_place.h"
#include "client/text/table.h"
#include "client/verbs.h"
#include "server/formats/json/json_values.h"
#include "server/formats/json/json_writer.h"

namespace rigcal::client {
namespace {

using recording::Player;
using recording::ReplayedTopic;
using recording::ReplayOutcome;
using std::chrono::milliseconds;

constexpr double kReplaySPerNs = 1e-9;
constexpr double kBehindTold_s = 0.2;

struct ReplayOptions {
  recording::ReplayInput input;
  std::string bag;
  double wait_s = 5;
  RosPlace ros;
};

void SayUnread(const Context& context, const std::vector<std::string>& unread, int domain) {
  for (const std::string& topic : unread)
    context.err << Plain(topic) << ": nobody in ROS domain " << domain << " reads it; it is sent nevertheless."
                << std::endl;
}

std::string ReplayJson(const ReplayOutcome& outcome) {
  return formats::WriteObject([&](formats::JsonWriter& out) {
    out.List("topics", [&] {
      for (const ReplayedTopic& topic : outcome.topics)
        out.Object([&] {
          out.Text("topic", topic.topic.name);
          out.Text("type", topic.topic.type);
          out.Integer("in_bag", topic.in_bag);
          out.Integer("sent", topic.sent);
          out.Integer("readers", topic.readers);
          topic.trouble.empty() ? out.Null("trouble") : out.Text("trouble", topic.trouble);
        });
    });
    out.Integer("bag_ns", outcome.bag_ns);
    out.Integer("took_ns", outcome.took_ns);
    out.Integer("latest_ns", outcome.latest_ns);
    out.Flag("whole", outcome.is_whole);
    out.List("damage", [&] {
      for (const Error& error : outcome.damage) out.Object([&] { formats::WriteErrorMembers(out, error); });
    });
  });
}

void PrintReplay(const ReplayOutcome& outcome, std::ostream& out) {
  Table table(
      {{"topic"}, {"type"}, {"sent", Align::kRight}, {"in the bag", Align::kRight}, {"readers", Align::kRight}});
  std::int64_t sent = 0;
  for (const ReplayedTopic& topic : outcome.topics) {
    table.Add({topic.topic.name, topic.topic.type, std::to_string(topic.sent), std::to_string(topic.in_bag),
               std::to_string(topic.readers)});
    sent += topic.sent;
  }
  table.Print(out);
  out << sent << " messages in " << DurationText(static_cast<double>(outcome.took_ns) * kReplaySPerNs) << " ("
      << DurationText(static_cast<double>(outcome.bag_ns) * kReplaySPerNs) << " of the bag)"
      << (outcome.is_whole ? "" : ", then stopped") << ".\n";
  for (const ReplayedTopic& topic : outcome.topics)
    if (!topic.trouble.empty()) out << Plain(topic.topic.name) << ": not sent: " << Plain(topic.trouble) << ".\n";
  const double latest_s = static_cast<double>(outcome.latest_ns) * kReplaySPerNs;
  if (latest_s > kBehindTold_s)
    out << "It was up to " << Fixed(latest_s, 1) << " s behind the bag: a reader or this machine did not keep up.\n";
}

Result<std::unique_ptr<Player>> OpenPlayer(const Context& context, const ReplayOptions& options,
                                           const wire::Participant& participant, int domain) {
  RIGCAL_ASSIGN(auto player, Player::Open(options.input, participant, InterruptWatch::Came));
  context.err << "Publishing " << player->TopicCount() << " topics in ROS domain " << domain << '.' << std::endl;
  const auto wait = milliseconds(std::llround(options.wait_s * 1e3));
  SayUnread(context, player->AwaitReaders(wait, InterruptWatch::Came), domain);
  return player;
}

Result<ExitCode> RunReplay(const Context& context, ReplayOptions& options) {
  const InterruptWatch watch;
  options.input.bag = options.bag;
  RIGCAL_ASSIGN(const int domain, RosDomainOf(options.ros));
  RIGCAL_ASSIGN(const auto participant, OpenRosParticipant(domain, options.ros.tag));
  RIGCAL_ASSIGN(const auto player, OpenPlayer(context, options, participant, domain));
  RIGCAL_ASSIGN(const ReplayOutcome outcome,
                WithBar(context, [&](const auto& progress) { return player->Play(InterruptWatch::Came, progress); }));
  const Status delivered = player->AwaitDelivery(context.timeout, InterruptWatch::Came);
  if (context.json)
    context.out << ReplayJson(outcome) << std::endl;
  else
    PrintReplay(outcome, context.out);
  if (!delivered) return Fail(delivered.error());
  return TellDamage(outcome.damage, context);
}

constexpr const char* kReplayFooter =
    "Publishes the messages of a bag of ROS 2 over DDS, byte for byte, under the names and types that ROS 2 gives "
    "them, at the pace at\n"
    "which they were recorded: nodes of ROS 2 and `rigcal record` receive them as from the robot. No ROS has to be "
    "installed.\n"
    "Topics are there before the first message is sent; --wait says how long readers are waited for. /tf_static is "
    "kept for late joiners.\n"
    "Exit code: 0 good, 5 something of the bag could not be read, 3 a reader did not acknowledge, 4 there is nothing "
    "that can be sent.\n"
    "Examples:\n"
    "  rigcal replay drive.mcap\n"
    "  rigcal replay drive.mcap --rate 0.5 --topics /left/image_raw /tf --ros-domain 42\n"
    "  rigcal record rig.yaml --out visit/ --for 60 &  rigcal replay drive.mcap\n";

}  // namespace

void AddReplay(CLI::App& app, Context& context) {
  CLI::App* verb = app.add_subcommand(kReplayVerb.name, kReplayVerb.description);
  auto options = std::make_shared<ReplayOptions>();
  verb->add_option("BAG", options->bag, "The bag: an .mcap or .db3 file, or the folder of a split one")->required();
  verb->add_option("--rate", options->input.rate, "Times the bag's pace (default 1)")
      ->type_name("X")
      ->check(CLI::Range(0.001, 1000.0));
  verb->add_option("--topics", options->input.topics, "These topics alone (default: all)")->type_name("TOPIC...");
  verb->add_option("--wait", options->wait_s, "Seconds to wait for a reader of every topic (default 5)")
      ->type_name("S")
      ->check(CLI::Range(0.0, 86'400.0));
  verb->add_flag("--best-effort", options->input.best_effort,
                 "Publish as many drivers do: what is lost is not sent again");
  AddRosPlace(*verb, options->ros);
  verb->footer(kReplayFooter);
  verb->callback([&context, options] {
    const auto code = RunReplay(context, *options);
    context.exit_code = code ? *code : Report(code.error(), context);
  });
}

}  // namespace rigcal::client
