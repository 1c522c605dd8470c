// Model values <-> generated C structs. Pure. From*: everything is checked (sizes, finite, unit quaternion, ids,
// limits); the error names the field. To*: the sample borrows from an owner that must outlive it, so it is wrapped with
// it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rigcal.h"
#include "server/model/edges/edge.h"
#include "server/model/robots/robot_state.h"

namespace rigcal::wire {

// A C sample together with the memory that its pointers refer to.
template <typename T>
struct Owned {
  T sample{};
  std::shared_ptr<void> memory;
};

// Copies text into a bounded C string; kInvalidInput if it is too long (never cut).
[[nodiscard]] Status CopyText(const std::string& text, char* to, std::size_t capacity, const char* field);

struct BatchItem {
  BatchId batch;
  std::uint32_t idx = 0, count = 0;
  Edge edge;
};
[[nodiscard]] Result<Owned<rigcal_wire_PairwiseResult>> ToPairwiseResult(const BatchItem& item);
// Checks everything incl. that edge_id, content and robot belong together.
[[nodiscard]] Result<BatchItem> FromPairwiseResult(const rigcal_wire_PairwiseResult& sample);

// What a robot is told of one of its sensors. A pose that is not known is the identity without covariance; what of it
// was measured stands beside it.
[[nodiscard]] Result<Owned<rigcal_wire_Calibration>> ToCalibration(const RobotId& robot,
                                                                   const RobotState::Calibration& calibration,
                                                                   const SensorPose& pose);

// A receipt as a value.
enum class ReceiptState { kNeedManifest, kReceiving, kClosed, kRefused };
struct Receipt {
  RobotId robot;
  std::string subject_id;
  ReceiptState state = ReceiptState::kNeedManifest;
  std::uint64_t incarnation = 0, sequence_number = 0, window_bytes = 0, written_bytes = 0;
  std::vector<bool> held;
  struct ChunkAt {
    std::uint32_t payload_idx = 0;
    std::uint64_t offset_bytes = 0;
  };
  std::vector<ChunkAt> busy;
  std::optional<Error> error;
};
[[nodiscard]] Result<Owned<rigcal_wire_Receipt>> ToReceipt(const Receipt& receipt);
[[nodiscard]] Result<Receipt> FromReceipt(const rigcal_wire_Receipt& sample);

}  // namespace rigcal::wire
