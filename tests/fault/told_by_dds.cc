// What a server tells outside, marked in the disk's record before it goes out: whatever it promises must survive any
// power loss after the mark.
#include <dds/dds.h>
#include <rigcal.h>

#include <array>
#include <string>

#include "tests/fault/disk_log.h"
#include "tests/fault/real_calls.h"

namespace rigcal::fault {
namespace {

std::string TopicOf(dds_entity_t writer) {
  std::array<char, 128> name{};
  const dds_entity_t topic = Real<dds_entity_t(dds_entity_t)>("dds_get_topic")(writer);
  if (topic < 0 ||
      Real<dds_return_t(dds_entity_t, char*, std::size_t)>("dds_get_name")(topic, name.data(), name.size()) < 0)
    return "";
  return name.data();
}

// "held SUBJECT STATE 0 1 5": by their index.
std::string TextOf(const rigcal_wire_Receipt& receipt) {
  std::string text = std::string("held ") + receipt.subject_id + " " + receipt.state;
  for (std::uint32_t i = 0; i < receipt.held._length * 8; ++i)
    if ((receipt.held._buffer[i / 8] >> (i % 8) & 1) != 0) text += " " + std::to_string(i);
  return text;
}

std::string TextOf(const rigcal_wire_Calibration& calibration) {
  return std::string("calibration ") + calibration.robot_id + " " + std::to_string(calibration.revision);
}

std::string ToldBy(dds_entity_t writer, const void* sample) {
  const std::string topic = TopicOf(writer);
  if (topic.ends_with("/Receipt")) return TextOf(*static_cast<const rigcal_wire_Receipt*>(sample));
  if (topic.ends_with("/Calibration")) return TextOf(*static_cast<const rigcal_wire_Calibration*>(sample));
  return "";
}

}  // namespace
}  // namespace rigcal::fault

extern "C" dds_return_t dds_write(dds_entity_t writer, const void* sample) {
  namespace fault = rigcal::fault;
  if (fault::IsRecording()) {
    const std::string told = fault::ToldBy(writer, sample);
    if (!told.empty()) fault::DiskTurn().Note({fault::DiskAct::kMark, 0, 0, told, "", ""});
  }
  return fault::Real<dds_return_t(dds_entity_t, const void*)>("dds_write")(writer, sample);
}
