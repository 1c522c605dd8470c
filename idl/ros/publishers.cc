#include "idl/ros/publishers.h"

#include <climits>

#include "idl/discovery.h"

namespace rigcal::wire {
namespace {

constexpr std::size_t kPublishersMax = 20'000;  // beyond it those that ended are forgotten

RosQos OfferedQos(const dds_qos_t* offered) {
  RosQos qos;
  dds_reliability_kind_t reliability = DDS_RELIABILITY_RELIABLE;
  dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
  dds_duration_t blocking = 0;
  if (dds_qget_reliability(offered, &reliability, &blocking)) qos.reliable = reliability == DDS_RELIABILITY_RELIABLE;
  if (dds_qget_durability(offered, &durability)) qos.transient_local = durability != DDS_DURABILITY_VOLATILE;
  return qos;
}

}  // namespace

Result<RosPublishers> RosPublishers::Open(const Participant& participant) {
  RIGCAL_ASSIGN(Entity publications, OpenBuiltin(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION));
  return RosPublishers(std::move(publications));
}

Result<RosPublishers::News> RosPublishers::Look() {
  News news;
  if (met_.size() > kPublishersMax) Forget();
  RIGCAL_TRY(internal::TakeNews(publications_.get(), INT_MAX, [&](const void* sample, const dds_sample_info_t& info) {
    const auto known = met_.find(info.instance_handle);
    if (info.instance_state != DDS_ALIVE_INSTANCE_STATE) {
      if (known == met_.end() || !known->second.is_there) return;
      known->second.is_there = false;
      news.ended.push_back(info.instance_handle);
      return;
    }
    if (known != met_.end() || !info.valid_data) return;
    const auto& endpoint = *static_cast<const dds_builtintopic_endpoint_t*>(sample);
    if (endpoint.topic_name == nullptr || endpoint.type_name == nullptr) return;
    const auto topic = RosTopicOf(endpoint.topic_name);
    if (!topic) return;
    met_[info.instance_handle] = {{*topic, RosTypeOf(endpoint.type_name)}, OfferedQos(endpoint.qos)};
    news.came.push_back(info.instance_handle);
  }));
  return news;
}

void RosPublishers::Forget() {
  std::erase_if(met_, [](const auto& one) { return !one.second.is_there; });
}

}  // namespace rigcal::wire
