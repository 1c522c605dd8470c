#include "idl/discovery.h"

#include <algorithm>
#include <climits>

namespace rigcal::wire {
namespace internal {

std::vector<std::string> PartitionsOf(const dds_qos_t* qos) {
  std::vector<std::string> partitions;
  std::uint32_t count = 0;
  char** names = nullptr;
  if (!dds_qget_partition(qos, &count, &names)) return partitions;
  for (std::uint32_t i = 0; i < count; ++i) {
    partitions.emplace_back(names[i]);
    dds_free(names[i]);
  }
  dds_free(names);
  return partitions;
}

}  // namespace internal

namespace {

// The two that partitions are matched by.
bool HasWildcard(const std::string& partition) { return partition.find_first_of("*?") != std::string::npos; }

}  // namespace

Result<Entity> OpenBuiltin(const Participant& participant, dds_entity_t topic) {
  Entity entity(dds_create_reader(participant.get(), topic, nullptr, nullptr));
  if (entity.get() < 0)
    return Fail(ErrorCode::kInternal, std::string("DDS discovery: ") + dds_strretcode(-entity.get()),
                "Too little memory, or a fault in Rigcal: report it with the log");
  dds_set_status_mask(entity.get(), 0);  // data wakes a wait set through a read condition
  return entity;
}

Result<NewReaders> NewReaders::Open(const Participant& participant) {
  RIGCAL_ASSIGN(Entity subscriptions, OpenBuiltin(participant, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION));
  return NewReaders(std::move(subscriptions));
}

Result<std::vector<std::string>> NewReaders::TakePartitions(const std::vector<std::string>& topics) {
  std::vector<std::string> partitions;
  RIGCAL_TRY(internal::TakeNews(subscriptions_.get(), INT_MAX, [&](const void* sample, const dds_sample_info_t& info) {
    if (info.instance_state != DDS_ALIVE_INSTANCE_STATE) of_many_.erase(info.instance_handle);
    if (info.instance_state != DDS_ALIVE_INSTANCE_STATE || !info.valid_data) return;
    const auto& reader = *static_cast<const dds_builtintopic_endpoint_t*>(sample);
    if (reader.topic_name == nullptr || std::find(topics.begin(), topics.end(), reader.topic_name) == topics.end())
      return;
    for (std::string& partition : internal::PartitionsOf(reader.qos)) {
      if (HasWildcard(partition)) of_many_.insert(info.instance_handle);
      partitions.push_back(std::move(partition));
    }
  }));
  return partitions;
}

}  // namespace rigcal::wire
