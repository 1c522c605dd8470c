#include "client/record/recorder.h"

#include "server/base/stamp.h"

namespace rigcal::recording {
namespace {

std::int64_t SteadyNanoseconds() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

Result<std::unique_ptr<Recorder>> Recorder::Open(std::vector<WantedTopic> wanted, wire::Participant participant,
                                                 int domain, BagFile& bag, const Say& say) {
  RIGCAL_ASSIGN(auto publishers, wire::RosPublishers::Open(participant));
  RIGCAL_ASSIGN(auto waitset, wire::WaitSet::Open(participant));
  RIGCAL_TRY(waitset.Attach(publishers.get()));
  std::unique_ptr<Recorder> made(
      new Recorder({std::move(participant), std::move(publishers), std::move(waitset)}, bag));
  made->begun_.start_ns = SteadyNanoseconds();
  made->begun_.domain = domain;
  for (WantedTopic& topic : wanted) made->topics_.push_back(std::make_unique<FollowedTopic>(std::move(topic), say));
  return made;
}

std::int64_t Recorder::Elapsed_ns() const { return SteadyNanoseconds() - begun_.start_ns; }

Surroundings Recorder::Around() const {
  Surroundings around = begun_;
  around.now_ns = SteadyNanoseconds();
  around.publishers = &network_.publishers.Met();
  return around;
}

// What an ended publisher sent may still be there: it is taken before the end is told.
Status Recorder::Step(std::chrono::milliseconds wait) {
  RIGCAL_TRY(network_.waitset.Wait(wait));
  RIGCAL_ASSIGN(const wire::RosPublishers::News news, network_.publishers.Look());
  for (const dds_instance_handle_t handle : news.came) RIGCAL_TRY(Come(handle));
  RIGCAL_TRY(TakeAll());
  for (const dds_instance_handle_t handle : news.ended)
    if (FollowedTopic* of = FollowedOf(handle)) of->End(handle);
  for (const auto& topic : topics_) topic->TellTroubles(Around());
  return {};
}

FollowedTopic* Recorder::FollowedOf(dds_instance_handle_t publisher) {
  const std::string& name = network_.publishers.Met().at(publisher).topic.name;
  for (const auto& one : topics_)
    if (one->topic().name == name) return one.get();
  return nullptr;
}

// One reader for each way of offering: it asks for exactly that, so that nobody who is reliable is heard as one who is
// not.
Status Recorder::Come(dds_instance_handle_t handle) {
  const wire::RosPublisher& publisher = network_.publishers.Met().at(handle);
  FollowedTopic* of = FollowedOf(handle);
  if (of == nullptr || !of->Come(handle, publisher, SteadyNanoseconds())) return {};
  const std::string& type = publisher.topic.type;
  for (const auto& source : sources_)
    if (source->of == of && source->type == type && source->qos == publisher.qos) return {};
  RIGCAL_ASSIGN(const std::uint16_t channel, bag_.Add(BagTopicOf(publisher.topic.name, type)));
  RIGCAL_ASSIGN(wire::CdrReader reader, wire::CdrReader::Open(network_.participant, publisher.topic, publisher.qos));
  RIGCAL_TRY(network_.waitset.Attach(reader.get()));
  sources_.push_back(std::make_unique<Source>(Source{of, type, publisher.qos, channel, std::move(reader)}));
  return {};
}

// Transforms that stand still were sent before those that refer to them; so they are taken last, and go into the bag
// first.
Status Recorder::TakeAll() {
  std::vector<Kept> moving, still;
  for (const bool is_optional : {false, true})
    for (const auto& source : sources_)
      if (source->of->topic().IsOptional() == is_optional)
        RIGCAL_TRY(source->reader.Take(
            [&](const wire::CdrMessage& message) { Keep(*source, message, is_optional ? still : moving); }));
  for (std::vector<Kept>* kept : {&still, &moving})
    for (Kept& one : *kept)
      if (!bag_.Put(std::move(one.message))) one.of->Drop();
  return {};
}

// A reader of best-effort publishers is given those of reliable ones, too: another reader has them.
void Recorder::Keep(const Source& source, const wire::CdrMessage& message, std::vector<Kept>& kept) {
  const auto publisher = network_.publishers.Met().find(message.publication);
  if (publisher != network_.publishers.Met().end() && publisher->second.qos != source.qos) return;
  source.of->Arrive(SteadyNanoseconds(), static_cast<std::int64_t>(message.bytes.size()), message.publication,
                    message.sequence);
  kept.push_back(
      {source.of,
       {source.channel, SystemClock().Now().ns, message.sent_ns, {message.bytes.begin(), message.bytes.end()}}});
}

std::vector<TopicSeen> Recorder::Look() {
  std::vector<TopicSeen> seen;
  for (const auto& topic : topics_) seen.push_back(topic->Look(Around()));
  return seen;
}

}  // namespace rigcal::recording
