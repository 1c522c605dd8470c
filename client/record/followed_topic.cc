#include "client/record/followed_topic.h"

#include <algorithm>

#include "client/text/table.h"
#include "server/base/near_names.h"

namespace rigcal::recording {
namespace {

constexpr std::int64_t kNobodyAfter_ns = 5'000'000'000;  // discovery takes a second or two

std::string DurationText(std::int64_t ns) { return client::Fixed(static_cast<double>(ns) * 1e-9, 1) + " s"; }

// Of transforms many programs speak; of a sensor one.
bool HasOneSender(const std::string& type) { return bags::KindOf(type) != bags::MessageKind::kTransforms; }

}  // namespace

void FollowedTopic::SayOnce(const std::string& what, const std::string& sentence) {
  if (said_.insert(what).second) say_(sentence);
}

bool FollowedTopic::Come(dds_instance_handle_t handle, const wire::RosPublisher& publisher, std::int64_t now_ns) {
  const std::string name = NameFor(seen_.topic), &type = publisher.topic.type;
  if (const auto why_not = WhyNot(seen_.topic, type)) {
    refused_.insert(handle);
    SayOnce("type " + type, Sentence(*why_not));
    return false;
  }
  if (publishers_.empty() && first_came_ns_ != 0) say_(name + ": a publisher is there again, and is recorded on.");
  publishers_.insert(handle);
  if (first_came_ns_ == 0) first_came_ns_ = now_ns;
  if (publishers_.size() > 1 && HasOneSender(type))
    SayOnce("several", name + ": " + std::to_string(publishers_.size()) +
                           " publishers at once; all of them are recorded as one sensor. Stop all but one, if they are "
                           "not one sensor.");
  if (!publisher.qos.reliable)
    SayOnce("best effort",
            name + ": its publisher is best effort: what is lost on the way is not sent again. It is counted.");
  seen_.best_effort = seen_.best_effort || !publisher.qos.reliable;
  if (std::find(seen_.types.begin(), seen_.types.end(), type) == seen_.types.end()) seen_.types.push_back(type);
  return true;
}

void FollowedTopic::End(dds_instance_handle_t handle) {
  refused_.erase(handle);
  if (publishers_.erase(handle) == 0 || !publishers_.empty() || seen_.topic.IsOptional()) return;
  say_(NameFor(seen_.topic) + ": its publisher ended after " + std::to_string(seen_.arrivals.messages()) +
       " messages; one that comes is recorded on.");
}

void FollowedTopic::TellNobody(const Surroundings& around) {
  std::set<std::string> there;
  for (const auto& [handle, publisher] : *around.publishers)
    if (publisher.is_there) there.insert(publisher.topic.name);
  const std::vector<std::string> names(there.begin(), there.end());
  const std::string where = "ROS domain " + std::to_string(around.domain);
  const std::string rest = names.empty()
                               ? "no topic at all is published in " + where + ": check --ros-domain and the network"
                               : std::to_string(names.size()) + " other topics are published in " + where;
  SayOnce("nobody", "nobody publishes " + NameFor(seen_.topic) + Suggestion(NearestNames(seen_.topic.name, names)) +
                        " (" + rest + "). It is waited for.");
}

void FollowedTopic::TellTroubles(const Surroundings& around) {
  const std::string name = NameFor(seen_.topic);
  const Arrivals& arrivals = seen_.arrivals;
  const bool is_wanted = !seen_.topic.IsOptional(), is_late = around.now_ns - around.start_ns > kNobodyAfter_ns;
  if (is_wanted && is_late && first_came_ns_ == 0 && refused_.empty()) TellNobody(around);
  if (is_wanted && arrivals.messages() == 0 && !publishers_.empty() && around.now_ns - first_came_ns_ > kNobodyAfter_ns)
    SayOnce("silent", name + ": its publisher is there and sends nothing. Start the sensor, or wake its driver.");
  if (arrivals.missed() > 0)
    SayOnce("missed", name + ": messages are lost on the way" +
                          (seen_.best_effort ? "" : ", as its publisher does not keep them long enough") +
                          "; recording on. Free the network or the processor, or publish less often.");
  if (seen_.unwritten > 0)
    SayOnce(
        "unwritten",
        name + ": messages are dropped, as the disk does not keep up. Record to a faster disk, or publish less often.");
  const bool stalled = is_wanted && !publishers_.empty() && arrivals.IsStalled(around.now_ns);
  if (stalled && !is_stalled_)
    say_(name + ": nothing for " + DurationText(*arrivals.SinceLast_ns(around.now_ns)) + ".");
  if (!stalled && is_stalled_ && !publishers_.empty()) say_(name + ": goes on.");
  is_stalled_ = stalled;
}

TopicState FollowedTopic::StateNow() const {
  if (is_stalled_) return TopicState::kStalled;
  if (!publishers_.empty()) return seen_.arrivals.messages() > 0 ? TopicState::kRecorded : TopicState::kSilent;
  if (first_came_ns_ != 0) return TopicState::kEnded;
  return refused_.empty() ? TopicState::kNobody : TopicState::kOtherType;
}

TopicSeen FollowedTopic::Look(const Surroundings& around) {
  TopicSeen seen = seen_;
  seen.at_ns = around.now_ns;
  seen.state = StateNow();
  seen.publishers = publishers_.size();
  if (seen.state == TopicState::kOtherType)
    for (const dds_instance_handle_t handle : refused_) seen.types.push_back(around.publishers->at(handle).topic.type);
  seen_.arrivals.BeginWindow(around.now_ns);
  return seen;
}

}  // namespace rigcal::recording
