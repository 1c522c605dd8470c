// What discovery tells of others on the same domain and tag, beside who serves (presence.h).
#pragma once

#include <string>
#include <vector>

#include "idl/dds.h"

namespace rigcal::wire {

// A reader of one of the topics that DDS itself fills; wakes a wait set when something came.
[[nodiscard]] Result<Entity> OpenBuiltin(const Participant& participant, dds_entity_t topic);

// Readers of any process, this one too, as they come. One thread.
class NewReaders {
 public:
  [[nodiscard]] static Result<NewReaders> Open(const Participant& participant);
  // The partitions in which readers of `topics` (TopicInfo::name) came since the last call; at the first, of all that are there.
  [[nodiscard]] Result<std::vector<std::string>> TakePartitions(const std::vector<std::string>& topics);
  [[nodiscard]] dds_entity_t get() const { return subscriptions_.get(); }

 private:
  explicit NewReaders(Entity subscriptions) : subscriptions_(std::move(subscriptions)) {}
  Entity subscriptions_;
};

namespace internal {
std::vector<std::string> PartitionsOf(const dds_qos_t* qos);
}  // namespace internal

}  // namespace rigcal::wire
