// What discovery tells of others on the same domain and tag, beside who serves (presence.h).
#pragma once

#include <set>
#include <string>
#include <vector>

#include "idl/dds.h"

namespace rigcal::wire {

// A reader of one of the topics that DDS itself fills; wakes a wait set when something came.
[[nodiscard]] Result<Entity> OpenBuiltin(const Participant& participant, dds_entity_t topic);

// Readers of any process, this one too, as they come and go. One thread.
class NewReaders {
 public:
  [[nodiscard]] static Result<NewReaders> Open(const Participant& participant);
  // The partitions in which readers of `topics` (TopicInfo::name) came since the last call; at the first, of all that
  // are there.
  [[nodiscard]] Result<std::vector<std::string>> TakePartitions(const std::vector<std::string>& topics);
  // As of that call: those of them that are still there and read in a partition with a wildcard (`*` or `?`), as of
  // many robots at once. The handles are those of Writer::HasReaderBeside.
  [[nodiscard]] const std::set<dds_instance_handle_t>& OfMany() const { return of_many_; }
  [[nodiscard]] dds_entity_t get() const { return subscriptions_.get(); }

 private:
  explicit NewReaders(Entity subscriptions) : subscriptions_(std::move(subscriptions)) {}
  Entity subscriptions_;
  std::set<dds_instance_handle_t> of_many_;
};

namespace internal {
std::vector<std::string> PartitionsOf(const dds_qos_t* qos);
}  // namespace internal

}  // namespace rigcal::wire
