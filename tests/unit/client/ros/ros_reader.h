// What a program of ROS 2 would meet: readers of one topic, with the bytes as they come and what discovery tells of who
// sends them.
#pragma once

#include <dds/ddsi/ddsi_serdata.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <utility>
#include <vector>

#include "client/ros/broadcast.h"

namespace rigcal::client {

inline constexpr int kRosTestDomain = 73;
inline constexpr std::chrono::milliseconds kRosPatience{60'000};

inline RosSide RosTestSide() {
  static const std::string tag = "ros-" + std::to_string(std::random_device()());
  return {kRosTestDomain, tag, true};
}

inline wire::Participant RosTestParticipant() {
  wire::ParticipantOptions options;
  options.domain = kRosTestDomain;
  options.tag = RosTestSide().tag;
  options.as_given = options.apart = true;
  return wire::Participant::Open(options).value();
}

struct RosWriterSeen {
  std::string topic, type;
  dds_reliability_kind_t reliability{};
  dds_durability_kind_t durability{};
  std::uint32_t partitions = 0;
};

template <typename T>
class RosReader {
 public:
  RosReader(const wire::Participant& participant, const std::string& topic) {
    wire::TopicInfo info = wire::InfoOf<T>();
    info.name = topic.c_str();
    entity_ = wire::internal::OpenReader(participant, info, {}).value();
  }
  [[nodiscard]] bool WaitForWriter(std::chrono::milliseconds timeout) const {
    return wire::internal::WaitForMatch(entity_.get(), false, timeout).has_value();
  }
  // The bytes of the next sample with the encapsulation's header; empty: none came in time.
  [[nodiscard]] std::vector<std::byte> Next(const wire::Participant& participant) const {
    auto waitset = wire::WaitSet::Open(participant).value();
    EXPECT_TRUE(waitset.Attach(entity_.get()));
    const auto end = std::chrono::steady_clock::now() + kRosPatience;
    while (std::chrono::steady_clock::now() < end) {
      ddsi_serdata* data = nullptr;
      dds_sample_info_t info;
      if (dds_takecdr(entity_.get(), &data, 1, &info, DDS_ANY_STATE) == 1) {
        std::vector<std::byte> bytes(ddsi_serdata_size(data));
        ddsi_serdata_to_ser(data, 0, bytes.size(), bytes.data());
        ddsi_serdata_unref(data);
        if (info.valid_data) return bytes;
      }
      EXPECT_TRUE(waitset.Wait(std::chrono::milliseconds(100)));
    }
    return {};
  }
  [[nodiscard]] RosWriterSeen Writer() const {
    RosWriterSeen seen;
    for (const dds_instance_handle_t handle : wire::internal::MatchedPublications(entity_.get())) {
      dds_builtintopic_endpoint_t* endpoint = dds_get_matched_publication_data(entity_.get(), handle);
      if (endpoint == nullptr) continue;
      seen.topic = endpoint->topic_name;
      seen.type = endpoint->type_name;
      dds_duration_t blocking = 0;
      dds_qget_reliability(endpoint->qos, &seen.reliability, &blocking);
      dds_qget_durability(endpoint->qos, &seen.durability);
      char** names = nullptr;
      dds_qget_partition(endpoint->qos, &seen.partitions, &names);
      for (std::uint32_t i = 0; i < seen.partitions; ++i) dds_free(names[i]);
      dds_free(names);
      dds_builtintopic_free_endpoint(endpoint);
    }
    return seen;
  }

 private:
  wire::Entity entity_;
};

}  // namespace rigcal::client
