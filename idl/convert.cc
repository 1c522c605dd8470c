#include "idl/convert.h"

#include <array>
#include <cstring>

#include "server/base/text.h"

namespace rigcal::wire {
namespace {

constexpr std::array kStates = {
    std::pair{ReceiptState::kNeedManifest, "need_manifest"}, std::pair{ReceiptState::kReceiving, "receiving"},
    std::pair{ReceiptState::kClosed, "closed"}, std::pair{ReceiptState::kRefused, "refused"}};

struct ReceiptMemory {
  std::vector<std::uint8_t> held;
  std::vector<rigcal_wire_ChunkRef> busy;
  std::string error_code, what, cure;
};

std::vector<std::uint8_t> Packed(const std::vector<bool>& bits) {
  std::vector<std::uint8_t> bytes((bits.size() + 7) / 8, 0);
  for (std::size_t i = 0; i < bits.size(); ++i)
    if (bits[i]) bytes[i / 8] = static_cast<std::uint8_t>(bytes[i / 8] | (1u << (i % 8)));
  return bytes;
}

// The number of items is not on the wire: the bits of the last byte beyond it are zero and harmless.
std::vector<bool> Unpacked(const dds_sequence_octet& bytes) {
  std::vector<bool> bits(std::size_t{8} * bytes._length, false);
  for (std::size_t i = 0; i < bits.size(); ++i) bits[i] = ((bytes._buffer[i / 8] >> (i % 8)) & 1u) != 0;
  return bits;
}

Result<ReceiptState> StateOf(std::string_view name) {
  for (const auto& [state, text] : kStates)
    if (name == text) return state;
  return Fail(ErrorCode::kUnsupported, "receipt state " + Quoted(name) + " is unknown to this version",
              "Use a client of the server's version");
}

const char* NameOfState(ReceiptState state) {
  for (const auto& [known, text] : kStates)
    if (state == known) return text;
  return "refused";
}

}  // namespace

Status CopyText(const std::string& text, char* to, std::size_t capacity, const char* field) {
  if (text.size() >= capacity || text.find('\0') != std::string::npos)
    return Fail(ErrorCode::kInvalidInput, std::string(field) + " " + Quoted(text) + " does not fit",
                "Use at most " + std::to_string(capacity - 1) + " characters");
  std::memcpy(to, text.c_str(), text.size() + 1);
  return {};
}

Result<Owned<rigcal_wire_Receipt>> ToReceipt(const Receipt& receipt) {
  auto memory = std::make_shared<ReceiptMemory>();
  memory->held = Packed(receipt.held);
  for (const Receipt::ChunkAt& at : receipt.busy) memory->busy.push_back({at.payload_idx, at.offset_bytes});
  if (receipt.error) {
    memory->error_code = NameOf(receipt.error->code);
    memory->what = receipt.error->what;
    memory->cure = receipt.error->cure;
  }
  Owned<rigcal_wire_Receipt> owned;
  rigcal_wire_Receipt& sample = owned.sample;
  RIGCAL_TRY(CopyText(receipt.robot.str(), sample.robot_id, sizeof sample.robot_id, "robot_id"));
  RIGCAL_TRY(CopyText(receipt.subject_id, sample.subject_id, sizeof sample.subject_id, "subject_id"));
  RIGCAL_TRY(CopyText(NameOfState(receipt.state), sample.state, sizeof sample.state, "state"));
  sample.incarnation = receipt.incarnation;
  sample.sequence_number = receipt.sequence_number;
  sample.window_bytes = receipt.window_bytes;
  sample.written_bytes = receipt.written_bytes;
  const auto held_count = static_cast<std::uint32_t>(memory->held.size());
  const auto busy_count = static_cast<std::uint32_t>(memory->busy.size());
  sample.held = {held_count, held_count, memory->held.data(), false};
  sample.busy = {busy_count, busy_count, memory->busy.data(), false};
  sample.error_code = memory->error_code.data();
  sample.what = memory->what.data();
  sample.cure = memory->cure.data();
  owned.memory = std::move(memory);
  return owned;
}

Result<Receipt> FromReceipt(const rigcal_wire_Receipt& sample) {
  Receipt receipt;
  RIGCAL_ASSIGN(receipt.robot, RobotId::Parse(sample.robot_id));
  RIGCAL_TRY(CheckDigest("receipt subject", sample.subject_id));
  receipt.subject_id = sample.subject_id;
  RIGCAL_ASSIGN(receipt.state, StateOf(sample.state));
  receipt.incarnation = sample.incarnation;
  receipt.sequence_number = sample.sequence_number;
  receipt.window_bytes = sample.window_bytes;
  receipt.written_bytes = sample.written_bytes;
  receipt.held = Unpacked(sample.held);
  for (std::uint32_t i = 0; i < sample.busy._length; ++i)
    receipt.busy.push_back({sample.busy._buffer[i].payload_idx, sample.busy._buffer[i].offset_bytes});
  const std::string code = sample.error_code == nullptr ? "" : sample.error_code;
  if (!code.empty())
    receipt.error =
        Error{ErrorCodeOf(code), sample.what == nullptr ? "" : sample.what, sample.cure == nullptr ? "" : sample.cure};
  return receipt;
}

}  // namespace rigcal::wire
