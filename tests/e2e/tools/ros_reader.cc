// Stands for a program of ROS 2: reads one topic with the QoS of tf2_ros's listener, by Cyclone's own configuration
// (CYCLONEDDS_URI), and prints a line of JSON per message: whose topic and type it is, what its writer offers, and its
// bytes. Nothing of Rigcal but the types.
//   ros_reader DOMAIN TOPIC tf|camera_info COUNT SECONDS
#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>

#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "ros2.h"

namespace {

// Of the writer: {"topic": ..., "type": ..., "reliable": ..., "transient_local": ..., "depth": ...
std::string WriterText(dds_entity_t reader, dds_instance_handle_t publication) {
  dds_builtintopic_endpoint_t* endpoint = dds_get_matched_publication_data(reader, publication);
  if (endpoint == nullptr) return "{\"topic\": null";
  dds_reliability_kind_t reliability{};
  dds_durability_kind_t durability{};
  dds_history_kind_t history{};
  dds_duration_t blocking = 0;
  dds_qget_reliability(endpoint->qos, &reliability, &blocking);
  dds_qget_durability(endpoint->qos, &durability);
  int depth = 0;
  dds_qget_history(endpoint->qos, &history, &depth);
  const std::string text =
      std::string("{\"topic\": \"") + endpoint->topic_name + "\", \"type\": \"" + endpoint->type_name +
      "\", \"reliable\": " + (reliability == DDS_RELIABILITY_RELIABLE ? "true" : "false") +
      ", \"transient_local\": " + (durability == DDS_DURABILITY_TRANSIENT_LOCAL ? "true" : "false") +
      ", \"depth\": " + (history == DDS_HISTORY_KEEP_LAST ? std::to_string(depth) : "null");
  dds_builtintopic_free_endpoint(endpoint);
  return text;
}

// Of writers as they were met: one that sent what it had may be gone before that is read. Written by Cyclone's thread.
std::mutex met_mutex;
std::map<dds_instance_handle_t, std::string> met;

void Meet(dds_entity_t reader, dds_subscription_matched_status_t status, void*) {
  if (status.current_count_change <= 0) return;
  const std::lock_guard lock(met_mutex);
  met.try_emplace(status.last_publication_handle, WriterText(reader, status.last_publication_handle));
}

std::string MetText(dds_instance_handle_t publication) {
  const std::lock_guard lock(met_mutex);
  const auto found = met.find(publication);
  return found == met.end() ? "{\"topic\": null" : found->second;
}

dds_entity_t OpenReader(dds_entity_t participant, const char* topic_name, const std::string& kind) {
  const auto* type = kind == "tf" ? &tf2_msgs_msg_dds__TFMessage__desc : &sensor_msgs_msg_dds__CameraInfo__desc;
  const dds_entity_t topic = dds_create_topic(participant, type, topic_name, nullptr, nullptr);
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 100);
  dds_listener_t* listener = dds_create_listener(nullptr);
  dds_lset_subscription_matched(listener, Meet);
  const dds_entity_t reader = dds_create_reader(participant, topic, qos, listener);
  dds_delete_listener(listener);
  dds_delete_qos(qos);
  return reader;
}

std::string HexOf(const std::vector<unsigned char>& bytes) {
  std::string text;
  char pair[3];
  for (const unsigned char byte : bytes) {
    std::snprintf(pair, sizeof pair, "%02x", byte);
    text += pair;
  }
  return text;
}

bool PrintNext(dds_entity_t reader) {
  ddsi_serdata* data = nullptr;
  dds_sample_info_t info;
  if (dds_takecdr(reader, &data, 1, &info, DDS_ANY_STATE) != 1) return false;
  std::vector<unsigned char> bytes(ddsi_serdata_size(data));
  ddsi_serdata_to_ser(data, 0, bytes.size(), bytes.data());
  ddsi_serdata_unref(data);
  if (!info.valid_data) return false;
  std::printf("%s, \"cdr\": \"%s\"}\n", MetText(info.publication_handle).c_str(), HexOf(bytes).c_str());
  std::fflush(stdout);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) return 2;
  const dds_entity_t participant =
      dds_create_participant(static_cast<dds_domainid_t>(std::atoi(argv[1])), nullptr, nullptr);
  const dds_entity_t reader = OpenReader(participant, argv[2], argv[3]);
  if (reader < 0) return 3;
  std::printf("{\"ready\": true}\n");
  std::fflush(stdout);
  const dds_entity_t waitset = dds_create_waitset(participant), news = dds_create_readcondition(reader, DDS_ANY_STATE);
  dds_waitset_attach(waitset, news, 0);
  const dds_time_t end = dds_time() + DDS_SECS(std::atoi(argv[5]));
  dds_attach_t woken = 0;
  for (int missing = std::atoi(argv[4]); missing > 0;) {
    if (PrintNext(reader))
      --missing;
    else if (dds_waitset_wait_until(waitset, &woken, 1, end) <= 0)
      return 1;
  }
  dds_delete(participant);
  return 0;
}
