#include "idl/ros/cdr_topic.h"

#include <dds/ddsi/ddsi_serdata.h>

#include <array>

namespace rigcal::wire {
namespace {

constexpr dds_duration_t kCdrBlockingTime = DDS_MSECS(200);
constexpr std::size_t kCdrTakeMax = 32;

struct CdrQosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using CdrQos = std::unique_ptr<dds_qos_t, CdrQosDeleter>;

CdrQos CdrQosOf(const RosQos& ros) {
  CdrQos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), ros.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       kCdrBlockingTime);
  dds_qset_durability(qos.get(), ros.transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  const dds_history_kind_t history = ros.depth == 0 ? DDS_HISTORY_KEEP_ALL : DDS_HISTORY_KEEP_LAST;
  dds_qset_history(qos.get(), history, ros.depth);
  if (ros.transient_local)
    dds_qset_durability_service(qos.get(), 0, history, ros.depth == 0 ? 1 : ros.depth, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  dds_qset_writer_data_lifecycle(qos.get(), false);
  return qos;
}

Result<Entity> CheckedCdr(dds_entity_t handle, const std::string& topic) {
  if (handle >= 0) return Entity(handle);
  return Fail(ErrorCode::kInternal, "DDS on topic " + topic + ": " + dds_strretcode(-handle),
              "Too little memory, or a fault in Rigcal: report it with the topic's name and type.");
}

struct CdrTopicEntity {
  Entity entity;
  const ddsi_sertype* type = nullptr;
};

Result<CdrTopicEntity> OpenCdrTopic(const Participant& participant, const RosTopic& topic) {
  ddsi_sertype* type = internal::NewCdrType(WireTypeOf(topic.type));
  const dds_entity_t handle =
      dds_create_topic_sertype(participant.get(), WireTopicOf(topic.name).c_str(), &type, nullptr, nullptr, nullptr);
  if (handle < 0) ddsi_sertype_unref(type);
  RIGCAL_ASSIGN(Entity entity, CheckedCdr(handle, topic.name));
  return CdrTopicEntity{std::move(entity), type};
}

// "sensor_msgs/msg/Image" with "dds_" before the last part and "_" behind it; in a bag the parts stand apart by "/".
constexpr std::string_view kTopicPrefix = "rt/", kTypePart = "dds_::";

std::string Replaced(std::string text, std::string_view what, std::string_view with) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size()))
    text.replace(at, what.size(), with);
  return text;
}

}  // namespace

std::string WireTopicOf(std::string_view ros_topic) {
  return std::string(kTopicPrefix) + std::string(ros_topic.substr(ros_topic.rfind('/', 0) == 0 ? 1 : 0));
}

std::optional<std::string> RosTopicOf(std::string_view wire_topic) {
  if (wire_topic.rfind(kTopicPrefix, 0) != 0) return std::nullopt;
  return "/" + std::string(wire_topic.substr(kTopicPrefix.size()));
}

std::string WireTypeOf(std::string_view ros_type) {
  const std::size_t last = ros_type.rfind('/');
  if (last == std::string_view::npos) return std::string(ros_type);
  const std::string package = Replaced(std::string(ros_type.substr(0, last)), "/", "::");
  return package + "::" + std::string(kTypePart) + std::string(ros_type.substr(last + 1)) + "_";
}

std::string RosTypeOf(std::string_view wire_type) {
  const std::size_t part = wire_type.find(kTypePart);
  if (part == std::string_view::npos || wire_type.back() != '_') return std::string(wire_type);
  const std::string type(wire_type.substr(part + kTypePart.size(), wire_type.size() - part - kTypePart.size() - 1));
  return Replaced(std::string(wire_type.substr(0, part)), "::", "/") + type;
}

Result<CdrWriter> CdrWriter::Open(const Participant& participant, const RosTopic& topic, const RosQos& qos) {
  RIGCAL_ASSIGN(CdrTopicEntity of, OpenCdrTopic(participant, topic));
  RIGCAL_ASSIGN(
      Entity writer,
      CheckedCdr(dds_create_writer(participant.get(), of.entity.get(), CdrQosOf(qos).get(), nullptr), topic.name));
  dds_set_status_mask(writer.get(), DDS_PUBLICATION_MATCHED_STATUS);
  return CdrWriter(topic.name, std::move(of.entity), of.type, std::move(writer));
}

Status CdrWriter::Write(std::span<const std::byte> cdr) {
  ddsi_serdata* sample = internal::NewCdrSample(type_, cdr);
  const dds_return_t code = sample == nullptr ? DDS_RETCODE_OUT_OF_RESOURCES : dds_writecdr(writer_.get(), sample);
  if (code == DDS_RETCODE_OK) return {};
  if (code == DDS_RETCODE_TIMEOUT)
    return Fail(ErrorCode::kBusy, name_ + ": a reader did not take in time", "Try again.");
  return Fail(ErrorCode::kInternal, name_ + ": DDS could not write: " + dds_strretcode(-code),
              "Too little memory, or a fault in Rigcal.");
}

Result<CdrReader> CdrReader::Open(const Participant& participant, const RosTopic& topic, const RosQos& qos) {
  RIGCAL_ASSIGN(CdrTopicEntity of, OpenCdrTopic(participant, topic));
  RIGCAL_ASSIGN(
      Entity reader,
      CheckedCdr(dds_create_reader(participant.get(), of.entity.get(), CdrQosOf(qos).get(), nullptr), topic.name));
  dds_set_status_mask(reader.get(), DDS_SUBSCRIPTION_MATCHED_STATUS);  // data wakes a wait set through a read condition
  return CdrReader(topic.name, std::move(of.entity), std::move(reader));
}

Result<int> CdrReader::Take(const std::function<void(const CdrMessage&)>& body) {
  std::array<ddsi_serdata*, kCdrTakeMax> samples{};
  std::array<dds_sample_info_t, kCdrTakeMax> infos;
  int taken = 0;
  while (true) {
    const dds_return_t count = dds_takecdr(reader_.get(), samples.data(), kCdrTakeMax, infos.data(), DDS_ANY_STATE);
    if (count < 0)
      return Fail(ErrorCode::kInternal, name_ + ": DDS could not take: " + dds_strretcode(-count),
                  "Too little memory, or a fault in Rigcal.");
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      if (infos[i].valid_data)
        body({internal::CdrBytesOf(samples[i]), infos[i].source_timestamp, infos[i].publication_handle,
              internal::SequenceOf(samples[i])});
      if (infos[i].valid_data) ++taken;
      ddsi_serdata_unref(samples[i]);
    }
    if (static_cast<std::size_t>(count) < kCdrTakeMax) return taken;
  }
}

}  // namespace rigcal::wire
