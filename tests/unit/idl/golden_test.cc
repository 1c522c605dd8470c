// The bytes of one fixed sample of each type are part of the contract: an old peer must read them. To write them anew
// after a deliberate change: RIGCAL_WRITE_GOLDEN=1 build/<preset>/bin/idl_test --gtest_filter='GoldenCdr.*'
#include <dds/ddsi/ddsi_serdata.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <random>
#include <sstream>

#include "idl/dds.h"
#include "tests/unit/idl/sample_edge.h"

namespace rigcal::wire {
namespace {

constexpr std::chrono::milliseconds kPatience{60'000};
char g_json[] = "{\"a\": 1}";
char g_words[] = "words";

std::string HexOf(const std::vector<std::uint8_t>& bytes) {
  std::string text;
  char pair[3];
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::snprintf(pair, sizeof pair, "%02x", bytes[i]);
    text += pair;
    text += i % 32 == 31 ? "\n" : " ";
  }
  return text + "\n";
}

// As they go over the wire: encapsulation header first.
template <typename T>
std::vector<std::uint8_t> CdrOf(const T& sample) {
  ParticipantOptions options;
  options.tag = "golden-" + std::to_string(std::random_device()());
  auto participant = Participant::Open(options);
  auto reader = Reader<T>::Open(*participant, {"robot/a"});
  auto writer = Writer<T>::Open(*participant, {"robot/a"});
  if (!participant || !reader || !writer || !writer->WaitForReader(kPatience) || !writer->Write(sample)) return {};
  ddsi_serdata* data = nullptr;
  dds_sample_info_t info;
  if (dds_takecdr(reader->get(), &data, 1, &info, DDS_ANY_STATE) != 1) return {};
  std::vector<std::uint8_t> bytes(ddsi_serdata_size(data));
  ddsi_serdata_to_ser(data, 0, bytes.size(), bytes.data());
  ddsi_serdata_unref(data);
  return bytes;
}

template <typename T>
void ExpectGolden(const char* type, const T& sample) {
  const std::string path = std::string(RIGCAL_SOURCE_DIR) + "/tests/golden/cdr/" + type + ".hex";
  const std::string hex = HexOf(CdrOf(sample));
  ASSERT_GT(hex.size(), 12u);
  if (std::getenv("RIGCAL_WRITE_GOLDEN") != nullptr) std::ofstream(path) << hex;
  std::ifstream file(path);
  std::stringstream golden;
  golden << file.rdbuf();
  EXPECT_EQ(hex, golden.str()) << path;
}

void FillSubject(char* robot_id, char* session_id) {
  std::strcpy(robot_id, "mapper-01");
  std::memset(session_id, 'a', 64);
}

dds_sequence_octet Octets() {
  static std::uint8_t bytes[] = {1, 2, 3, 4, 5};
  return {5, 5, bytes, false};
}

TEST(GoldenCdr, SessionHeader) {
  rigcal_wire_SessionHeader sample{};
  FillSubject(sample.robot_id, sample.session_id);
  sample.protocol = 1;
  std::strcpy(sample.client_version, "0.1.0");
  sample.payload_count = 18;
  sample.manifest_bytes = 4'000;
  sample.total_bytes = 5'000'000'000;
  ExpectGolden("SessionHeader", sample);
}

TEST(GoldenCdr, Manifest) {
  rigcal_wire_Manifest sample{};
  FillSubject(sample.robot_id, sample.session_id);
  sample.bytes = Octets();
  ExpectGolden("Manifest", sample);
}

TEST(GoldenCdr, Chunk) {
  rigcal_wire_Chunk sample{};
  FillSubject(sample.robot_id, sample.session_id);
  sample.payload_idx = 7;
  sample.offset_bytes = 3'000'000'000;
  sample.bytes = Octets();
  ExpectGolden("Chunk", sample);
}

TEST(GoldenCdr, Receipt) {
  Receipt receipt;
  receipt.robot = RobotId("mapper-01");
  receipt.subject_id = std::string(64, 'b');
  receipt.state = ReceiptState::kReceiving;
  receipt.incarnation = 1;
  receipt.sequence_number = 2;
  receipt.window_bytes = 3;
  receipt.written_bytes = 4;
  receipt.held = {true, false, true, false, false, false, false, false, true};
  receipt.busy = {{5, 6}, {7, 8}};
  receipt.error = Error{ErrorCode::kConflict, "what", "cure"};
  const auto owned = ToReceipt(receipt);
  ASSERT_TRUE(owned);
  ExpectGolden("Receipt", owned->sample);
}

TEST(GoldenCdr, PairwiseResult) {
  rigcal_wire_PairwiseResult sample{};
  FillSubject(sample.robot_id, sample.batch_id);
  sample.batch_idx = 1;
  sample.batch_count = 2;
  std::memset(sample.edge_id, 'c', 64);
  std::strcpy(sample.frame_a, "left");
  std::strcpy(sample.frame_b, "right");
  for (int i = 0; i < 3; ++i) sample.p_m[i] = 0.5 + i;
  for (int i = 0; i < 4; ++i) sample.q_xyzw[i] = i == 3 ? 1.0 : 0.0;
  for (int i = 0; i < 36; ++i) sample.information[i] = i;
  sample.rank = 6;
  sample.dof = 11;
  std::strcpy(sample.source, "given");
  std::strcpy(sample.method, "given");
  rigcal_wire_BlockVector block{"capture-1", {1, 2, 3, 4, 5, 6}};
  rigcal_wire_Contribution part{"board size", {}};
  part.covariance[35] = 2.5;
  sample.blocks = {1, 1, &block, false};
  sample.contributions = {1, 1, &part, false};
  sample.occurrence_idx = 1;
  sample.jackknife_ratio = 0.5;
  sample.measured_ns = 1'700'000'000'000'000'001;
  ExpectGolden("PairwiseResult", sample);
}

TEST(GoldenCdr, Event) {
  rigcal_wire_Event sample{};
  std::strcpy(sample.robot_id, "mapper-01");
  std::strcpy(sample.kind, "edge");
  std::strcpy(sample.subject_id, "42");
  sample.stamp_ns = 1'700'000'000'000'000'001;
  sample.sequence_number = 3;
  sample.json = g_json;
  ExpectGolden("Event", sample);
}

TEST(GoldenCdr, Calibration) {
  rigcal_wire_Calibration sample{};
  std::strcpy(sample.robot_id, "mapper-01");
  std::strcpy(sample.sensor_id, "right");
  std::strcpy(sample.reference_id, "left");
  sample.revision = 3;
  sample.known = true;
  for (int i = 0; i < 3; ++i) sample.p_m[i] = 0.5 + i;
  for (int i = 0; i < 4; ++i) sample.q_xyzw[i] = i == 3 ? 1.0 : 0.0;
  for (int i = 0; i < 36; ++i) sample.covariance[i] = i;
  std::strcpy(sample.verdict, "pass");
  sample.stamp_ns = 1'700'000'000'000'000'001;
  rigcal_wire_OpenDirection open{{0, 0, 1, 0, 0, 0}};
  rigcal_wire_MeasuredAxis axes[2] = {{"forward", false, {1, 0, 0}, true, 0.5, 0.25, 0},
                                      {"yaw", true, {0, 0, 1}, true, 0, 0, 0.125}};
  rigcal_wire_MeasuredPart part{};
  for (int i = 0; i < 3; ++i) part.p_m[i] = 1.5 + i;
  part.q_xyzw[3] = 1.0;
  for (int i = 0; i < 36; ++i) part.covariance[i] = 36 - i;
  part.open_directions = {1, 1, &open, false};
  part.axes = {2, 2, axes, false};
  sample.measured_part = {1, 1, &part, false};
  ExpectGolden("Calibration", sample);
}

TEST(GoldenCdr, CalibrationInUse) {
  rigcal_wire_CalibrationInUse sample{};
  std::strcpy(sample.robot_id, "mapper-01");
  std::memset(sample.digest, 'd', 64);
  sample.revision = 3;
  sample.applied_ns = 1'700'000'000'000'000'001;
  std::strcpy(sample.who, "agent");
  ExpectGolden("CalibrationInUse", sample);
}

TEST(GoldenCdr, RobotStatus) {
  rigcal_wire_RobotStatus sample{};
  std::strcpy(sample.robot_id, "mapper-01");
  sample.revision = 3;
  std::strcpy(sample.verdict, "warn");
  sample.why = g_words;
  sample.edges = 4;
  sample.jobs_waiting = 5;
  sample.stamp_ns = 1'700'000'000'000'000'001;
  ExpectGolden("RobotStatus", sample);
}

TEST(GoldenCdr, Request) {
  rigcal_wire_Request sample{};
  std::strcpy(sample.id, "request-1");
  std::strcpy(sample.verb, "lookup");
  sample.json = g_json;
  ExpectGolden("Request", sample);
}

TEST(GoldenCdr, Reply) {
  rigcal_wire_Reply sample{};
  std::strcpy(sample.id, "request-1");
  sample.part_idx = 1;
  sample.part_count = 2;
  sample.json = g_json;
  ExpectGolden("Reply", sample);
}

// The same sample written down by hand after the XCDR2 rules (OMG DDS-XTypes 1.3, 7.4): delimited, little-endian.
TEST(GoldenCdr, ReplyFollowsTheStandard) {
  rigcal_wire_Reply sample{};
  std::strcpy(sample.id, "r1");
  sample.part_idx = 1;
  sample.part_count = 2;
  sample.json = g_words;
  const std::vector<std::uint8_t> expected = {
      0x00, 0x09, 0x00, 0x02,                        // D_CDR2_LE; two bytes of padding at the end
      0x1a, 0x00, 0x00, 0x00,                        // members take 26 bytes
      0x03, 0x00, 0x00, 0x00, 'r', '1', 0x00, 0x00,  // id, terminator, padding to 4
      0x01, 0x00, 0x00, 0x00,                        // part_idx
      0x02, 0x00, 0x00, 0x00,                        // part_count
      0x06, 0x00, 0x00, 0x00, 'w', 'o', 'r',  'd',  's', 0x00, 0x00, 0x00};
  EXPECT_EQ(HexOf(CdrOf(sample)), HexOf(expected));
}

}  // namespace
}  // namespace rigcal::wire
