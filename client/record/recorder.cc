#include "client/record/recorder.h"

#include <algorithm>

#include "client/text/table.h"
#include "server/base/near_names.h"
#include "server/base/stamp.h"

namespace rigcal::recording {
namespace {

constexpr std::int64_t kNobodyAfter_ns = 5'000'000'000;  // discovery takes a second or two
constexpr double kSecondsPerNs = 1e-9;

std::int64_t SteadyNanoseconds() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string SecondsText(std::int64_t ns) { return client::Fixed(static_cast<double>(ns) * kSecondsPerNs, 1) + " s"; }

}  // namespace

Recorder::Recorder(wire::Participant participant, wire::RosPublishers publishers, wire::WaitSet waitset, int domain, BagFile& bag, Say say)
    : participant_(std::move(participant)),
      publishers_(std::move(publishers)),
      waitset_(std::move(waitset)),
      domain_(domain),
      bag_(bag),
      say_(std::move(say)),
      start_ns_(SteadyNanoseconds()) {}

Result<std::unique_ptr<Recorder>> Recorder::Open(std::vector<WantedTopic> wanted, wire::Participant participant, int domain, BagFile& bag,
                                                 Say say) {
  RIGCAL_ASSIGN(auto publishers, wire::RosPublishers::Open(participant));
  RIGCAL_ASSIGN(auto waitset, wire::WaitSet::Open(participant));
  RIGCAL_TRY(waitset.Attach(publishers.get()));
  std::unique_ptr<Recorder> made(
      new Recorder(std::move(participant), std::move(publishers), std::move(waitset), domain, bag, std::move(say)));
  for (WantedTopic& topic : wanted) {
    made->topics_.push_back(std::make_unique<Followed>());
    made->topics_.back()->seen.topic = std::move(topic);
  }
  return made;
}

std::int64_t Recorder::Elapsed_ns() const { return SteadyNanoseconds() - start_ns_; }

// What an ended publisher sent may still be there: it is taken before the end is told.
Status Recorder::Step(std::chrono::milliseconds wait) {
  RIGCAL_TRY(waitset_.Wait(wait));
  RIGCAL_ASSIGN(const wire::RosPublishers::News news, publishers_.Look());
  for (const dds_instance_handle_t handle : news.came) RIGCAL_TRY(Come(handle));
  RIGCAL_TRY(TakeAll());
  for (const dds_instance_handle_t handle : news.ended) End(handle);
  const std::int64_t now_ns = SteadyNanoseconds();
  for (const auto& topic : topics_) TellTroubles(*topic, now_ns);
  return {};
}

Recorder::Followed* Recorder::FollowedOf(const std::string& topic) {
  for (const auto& one : topics_)
    if (one->seen.topic.name == topic) return one.get();
  return nullptr;
}

Status Recorder::Come(dds_instance_handle_t handle) {
  const wire::RosPublisher& publisher = publishers_.Met().at(handle);
  Followed* of = FollowedOf(publisher.topic.name);
  if (of == nullptr) return {};
  if (const auto why_not = WhyNot(of->seen.topic, publisher.topic.type)) {
    of->refused.insert(handle);
    SayOnce(*of, "type " + publisher.topic.type, Sentence(*why_not));
    return {};
  }
  TellArrival(*of, publisher);
  of->publishers.insert(handle);
  if (of->first_came_ns == 0) of->first_came_ns = SteadyNanoseconds();
  of->seen.best_effort = of->seen.best_effort || !publisher.qos.reliable;
  return OpenSource(*of, publisher);
}

void Recorder::TellArrival(Followed& of, const wire::RosPublisher& publisher) {
  const std::string name = NameFor(of.seen.topic);
  if (of.publishers.empty() && of.first_came_ns != 0) say_(name + ": a publisher is there again, and is recorded on.");
  const bool has_one_sender = bags::KindOf(publisher.topic.type) != bags::MessageKind::kTransforms;
  if (!of.publishers.empty() && has_one_sender)
    SayOnce(of, "several",
            name + ": " + std::to_string(of.publishers.size() + 1) +
                " publishers at once; all of them are recorded as one sensor. Stop all but one, if they are not one sensor.");
  if (!publisher.qos.reliable)
    SayOnce(of, "best effort", name + ": its publisher is best effort: what is lost on the way is not sent again. It is counted.");
}

// One reader for each way of offering: it asks for exactly that, so that nobody who is reliable is heard as one who is not.
Status Recorder::OpenSource(Followed& of, const wire::RosPublisher& publisher) {
  for (const auto& source : of.sources)
    if (source->type == publisher.topic.type && source->qos == publisher.qos) return {};
  RIGCAL_ASSIGN(const std::uint16_t channel, bag_.Add(BagTopicOf(publisher.topic.name, publisher.topic.type)));
  RIGCAL_ASSIGN(wire::CdrReader reader, wire::CdrReader::Open(participant_, publisher.topic, publisher.qos));
  RIGCAL_TRY(waitset_.Attach(reader.get()));
  of.sources.push_back(std::make_unique<Source>(Source{publisher.topic.type, publisher.qos, channel, std::move(reader)}));
  std::vector<std::string>& types = of.seen.types;
  if (std::find(types.begin(), types.end(), publisher.topic.type) == types.end()) types.push_back(publisher.topic.type);
  return {};
}

void Recorder::End(dds_instance_handle_t handle) {
  Followed* of = FollowedOf(publishers_.Met().at(handle).topic.name);
  if (of == nullptr) return;
  of->refused.erase(handle);
  if (of->publishers.erase(handle) == 0 || !of->publishers.empty() || of->seen.topic.IsOptional()) return;
  say_(NameFor(of->seen.topic) + ": its publisher ended after " + std::to_string(of->seen.arrivals.messages()) +
       " messages; one that comes is recorded on.");
}

// Transforms that stand still were sent before those that refer to them; so they are taken last, and go into the bag first.
Status Recorder::TakeAll() {
  std::vector<Kept> moving, still;
  for (const bool is_optional : {false, true})
    for (const auto& of : topics_)
      for (const auto& source : of->sources)
        if (of->seen.topic.IsOptional() == is_optional)
          RIGCAL_TRY(
              source->reader.Take([&](const wire::CdrMessage& message) { Keep(*of, *source, message, is_optional ? still : moving); }));
  for (std::vector<Kept>* kept : {&still, &moving})
    for (Kept& one : *kept)
      if (!bag_.Put(std::move(one.message))) ++one.of->seen.unwritten;
  return {};
}

// A reader of best-effort publishers is given those of reliable ones, too: another reader has them.
void Recorder::Keep(Followed& of, const Source& source, const wire::CdrMessage& message, std::vector<Kept>& kept) {
  const auto publisher = publishers_.Met().find(message.publication);
  if (publisher != publishers_.Met().end() && publisher->second.qos != source.qos) return;
  of.seen.arrivals.Add(SteadyNanoseconds(), static_cast<std::int64_t>(message.bytes.size()), message.publication, message.sequence);
  kept.push_back({&of, {source.channel, SystemClock().Now().ns, message.sent_ns, {message.bytes.begin(), message.bytes.end()}}});
}

void Recorder::SayOnce(Followed& of, const std::string& what, const std::string& sentence) {
  if (of.said.insert(what).second) say_(sentence);
}

void Recorder::TellNobody(Followed& of) {
  std::set<std::string> there;
  for (const auto& [handle, publisher] : publishers_.Met())
    if (publisher.is_there) there.insert(publisher.topic.name);
  const std::vector<std::string> names(there.begin(), there.end());
  const std::string where = "ROS domain " + std::to_string(domain_);
  const std::string cure = names.empty() ? "no topic at all is published in " + where + ": check --ros-domain and the network"
                                         : std::to_string(names.size()) + " other topics are published in " + where;
  SayOnce(of, "nobody",
          "nobody publishes " + NameFor(of.seen.topic) + Suggestion(NearestNames(of.seen.topic.name, names)) + " (" + cure +
              "). It is waited for.");
}

void Recorder::TellTroubles(Followed& of, std::int64_t now_ns) {
  const std::string name = NameFor(of.seen.topic);
  const Arrivals& arrivals = of.seen.arrivals;
  const bool is_long = Elapsed_ns() > kNobodyAfter_ns, is_wanted = !of.seen.topic.IsOptional();
  if (is_wanted && is_long && of.publishers.empty() && of.refused.empty() && of.first_came_ns == 0) TellNobody(of);
  if (is_wanted && arrivals.messages() == 0 && !of.publishers.empty() && now_ns - of.first_came_ns > kNobodyAfter_ns)
    SayOnce(of, "silent", name + ": its publisher is there and sends nothing. Start the sensor, or wake its driver.");
  if (arrivals.missed() > 0)
    SayOnce(of, "missed",
            name + ": messages are lost on the way" + (of.seen.best_effort ? "" : ", as its publisher does not keep them long enough") +
                "; recording on. Free the network or the processor, or publish less often.");
  if (of.seen.unwritten > 0)
    SayOnce(of, "unwritten",
            name + ": messages are dropped, as the disk does not keep up. Record to a faster disk, or publish less often.");
  const bool stalled = is_wanted && arrivals.IsStalled(now_ns);
  if (stalled && !of.is_stalled) say_(name + ": nothing for " + SecondsText(*arrivals.SinceLast_ns(now_ns)) + ".");
  if (!stalled && of.is_stalled) say_(name + ": goes on.");
  of.is_stalled = stalled;
}

TopicState Recorder::StateOf(const Followed& of) const {
  if (of.is_stalled && !of.publishers.empty()) return TopicState::kStalled;
  if (!of.publishers.empty()) return of.seen.arrivals.messages() > 0 ? TopicState::kRecorded : TopicState::kSilent;
  if (of.first_came_ns != 0) return TopicState::kEnded;
  return of.refused.empty() ? TopicState::kNobody : TopicState::kOtherType;
}

std::vector<TopicSeen> Recorder::Look() {
  std::vector<TopicSeen> seen;
  const std::int64_t now_ns = SteadyNanoseconds();
  for (const auto& of : topics_) {
    seen.push_back(of->seen);
    seen.back().at_ns = now_ns;
    seen.back().state = StateOf(*of);
    seen.back().publishers = of->publishers.size();
    if (seen.back().state == TopicState::kOtherType)
      for (const dds_instance_handle_t handle : of->refused) seen.back().types.push_back(publishers_.Met().at(handle).topic.type);
    of->seen.arrivals.BeginWindow(now_ns);
  }
  return seen;
}

}  // namespace rigcal::recording
