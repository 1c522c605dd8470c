#include "client/record/player.h"

#include <algorithm>
#include <thread>

#include "client/bags/messages/definition.h"
#include "client/bags/open_bag.h"
#include "server/base/near_names.h"
#include "server/base/text.h"
#include "server/formats/edges/first_three.h"

namespace rigcal::recording {
namespace {

using PlayClock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr milliseconds kLook(50);     // how long a stop may go unnoticed
constexpr milliseconds kLinger(500);  // best-effort messages that are under way are lost when their publisher ends
constexpr std::int64_t kProgressEvery = 64;  // messages
constexpr std::size_t kEncapsulation_bytes = 4;

bool IsStaticFrames(const std::string& topic) {
  constexpr std::string_view kEnd = "tf_static";
  return topic.size() >= kEnd.size() && topic.compare(topic.size() - kEnd.size(), kEnd.size(), kEnd) == 0;
}

// Waits in pieces; false: it was stopped.
bool WaitUntil(PlayClock::time_point until, const Stop& stop) {
  while (!stop()) {
    const auto now = PlayClock::now();
    if (now >= until) return true;
    std::this_thread::sleep_for(std::min<nanoseconds>(until - now, kLook));
  }
  return false;
}

// ROS 2 spells a type with "msg" between; nothing where it has no package.
std::string TypeOnTheRobot(const std::string& type) {
  const std::string plain = bags::PlainTypeName(type);
  const std::size_t slash = plain.find('/');
  return slash == std::string::npos ? type : plain.substr(0, slash) + "/msg" + plain.substr(slash);
}

std::string TroubleOf(const bags::Topic& topic) {
  if (topic.encoding != "cdr") return "its messages are encoded as " + Quoted(topic.encoding) + ", and ROS 2 sends cdr";
  if (topic.type.find('/') == std::string::npos) return "its type " + Quoted(topic.type) + " is none of ROS 2";
  return "";
}

}  // namespace

// Unsigned, as stamps of a broken bag may be farther apart than a signed number holds.
nanoseconds DueAfter(std::int64_t first_ns, std::int64_t log_ns, double rate) {
  constexpr double kCentury_ns = 3.15e18;
  if (log_ns <= first_ns) return nanoseconds(0);
  const std::uint64_t apart_ns = static_cast<std::uint64_t>(log_ns) - static_cast<std::uint64_t>(first_ns);
  return nanoseconds(static_cast<std::int64_t>(std::min(static_cast<double>(apart_ns) / rate, kCentury_ns)));
}

Result<std::unique_ptr<Player>> Player::Open(const ReplayInput& input, const wire::Participant& participant,
                                             const Stop& stop) {
  std::unique_ptr<Player> player(new Player(input));
  RIGCAL_TRY(player->Survey(stop));
  RIGCAL_TRY(player->CheckNames());
  RIGCAL_TRY(player->Publish(participant));
  return player;
}

Status Player::Survey(const Stop& stop) {
  RIGCAL_ASSIGN(const std::unique_ptr<bags::Bag> bag, bags::OpenBag(input_.bag));
  for (bags::Message message; !stop() && bag->Next(message);) Count(message);
  std::sort(topics_.begin(), topics_.end(), [](const auto& a, const auto& b) { return a->told.topic < b->told.topic; });
  return {};
}

void Player::Count(const bags::Message& message) {
  Played* played = PlayedOf(*message.topic);
  if (played == nullptr) {
    topics_.push_back(std::make_unique<Played>());
    played = topics_.back().get();
    played->told = {{message.topic->name, TypeOnTheRobot(message.topic->type)}, 0, 0, 0, TroubleOf(*message.topic)};
  }
  ++played->told.in_bag;
  first_ns_ = std::min(first_ns_, message.log_ns);
  last_ns_ = std::max(last_ns_, message.log_ns);
}

Player::Played* Player::PlayedOf(const bags::Topic& topic) {
  const std::string type = TypeOnTheRobot(topic.type);
  for (const auto& one : topics_)
    if (one->told.topic.name == topic.name && one->told.topic.type == type) return one.get();
  return nullptr;
}

Status Player::CheckNames() const {
  std::vector<std::string> names;
  for (const auto& one : topics_) names.push_back(one->told.topic.name);
  for (const std::string& wanted : input_.topics)
    if (std::find(names.begin(), names.end(), wanted) == names.end())
      return Fail(
          ErrorCode::kNotFound,
          "the bag has no messages of topic " + Quoted(wanted) + Suggestion(NearestNames(wanted, names)),
          "It has " +
              (names.empty() ? "none"
                             : formats::FirstThree(names.size(), [&](std::size_t i) { return Quoted(names[i]); })) +
              ".");
  return {};
}

Status Player::Publish(const wire::Participant& participant) {
  std::string trouble = "it has no messages";
  const std::vector<std::string>& wanted = input_.topics;
  if (!wanted.empty())
    std::erase_if(topics_, [&](const auto& one) {
      return std::find(wanted.begin(), wanted.end(), one->told.topic.name) == wanted.end();
    });
  for (const auto& one : topics_) {
    const std::string& name = one->told.topic.name;
    if (!one->told.trouble.empty()) {
      trouble = Quoted(name) + ": " + one->told.trouble;
      continue;
    }
    wire::RosQos qos;
    qos.transient_local = IsStaticFrames(name);
    qos.reliable = qos.transient_local || !input_.best_effort;
    RIGCAL_ASSIGN(one->writer, wire::CdrWriter::Open(participant, one->told.topic, qos));
  }
  if (TopicCount() > 0) return {};
  return Fail(ErrorCode::kUnsupported, input_.bag.string() + " has nothing that can be sent: " + trouble,
              "Give a bag of ROS 2; `rigcal import BAG --list` shows what is in it.");
}

std::size_t Player::TopicCount() const {
  return static_cast<std::size_t>(
      std::count_if(topics_.begin(), topics_.end(), [](const auto& one) { return one->writer.has_value(); }));
}

std::vector<std::string> Player::AwaitReaders(milliseconds timeout, const Stop& stop) {
  const auto end = PlayClock::now() + timeout;
  while (true) {
    std::vector<std::string> unread;
    for (const auto& one : topics_)
      if (one->writer && one->writer->MatchedReaders() == 0) unread.push_back(one->told.topic.name);
    if (unread.empty() || PlayClock::now() >= end || !WaitUntil(std::min(end, PlayClock::now() + kLook), stop))
      return unread;
  }
}

Status Player::Send(Played& played, const bags::Message& message, const Stop& stop) {
  if (message.bytes.size() < kEncapsulation_bytes) return {};
  played.told.readers = std::max(played.told.readers, played.writer->MatchedReaders());
  while (!stop()) {
    const Status written = played.writer->Write(message.bytes);
    if (written) ++played.told.sent;
    if (written || written.error().code != ErrorCode::kBusy) return written;
  }
  return {};
}

Result<ReplayOutcome> Player::Play(const Stop& stop, const PlayProgress& progress) {
  RIGCAL_ASSIGN(const std::unique_ptr<bags::Bag> bag, bags::OpenBag(input_.bag));
  ReplayOutcome outcome;
  const auto start = PlayClock::now();
  std::int64_t count = 0;
  for (bags::Message message; !stop() && bag->Next(message);) {
    Played* played = PlayedOf(*message.topic);
    if (played == nullptr || !played->writer) continue;
    const auto due = start + DueAfter(first_ns_, message.log_ns, input_.rate);
    if (!WaitUntil(due, stop)) break;
    RIGCAL_TRY(Send(*played, message, stop));
    outcome.latest_ns = std::max<std::int64_t>(outcome.latest_ns, nanoseconds(PlayClock::now() - due).count());
    if (++count % kProgressEvery == 1 && progress) progress(bag->bytes_done(), bag->bytes_total());
  }
  outcome.took_ns = nanoseconds(PlayClock::now() - start).count();
  outcome.bag_ns = DueAfter(first_ns_, last_ns_, 1).count();
  outcome.is_whole = !stop();
  outcome.damage = bag->Unread().All();
  for (const auto& one : topics_) outcome.topics.push_back(one->told);
  return outcome;
}

Status Player::AwaitDelivery(milliseconds timeout, const Stop& stop) {
  const auto end = PlayClock::now() + timeout;
  if (input_.best_effort) WaitUntil(PlayClock::now() + kLinger, stop);
  for (const auto& one : topics_) {
    while (one->writer && !stop()) {
      if (one->writer->WaitForAcks(kLook)) break;
      if (PlayClock::now() < end) continue;
      return Fail(ErrorCode::kUnreachable, "a reader of " + one->told.topic.name + " did not acknowledge what was sent",
                  "Give it longer (--timeout), or look whether it runs.");
    }
  }
  return {};
}

}  // namespace rigcal::recording
