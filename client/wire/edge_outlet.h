// A batch of finished edges on the wire: PairwiseResult items.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "client/wire/transfer.h"
#include "server/model/edges/edge.h"

namespace rigcal::client {

// An item's index is the rank of its edge id, so that a file in another order is the same batch with the same items.
struct EdgesToPush {
  RobotId robot;
  BatchId id;
  std::vector<Edge> edges;                // sorted by id
  std::vector<std::uint32_t> send_order;  // the file's order, or shuffled
};
// The batch's id is that of its robot and edges, in any order. `shuffle_seed`: absent for the file's order.
[[nodiscard]] EdgesToPush EdgesOf(const RobotId& robot, std::vector<Edge> edges,
                                  std::optional<std::uint64_t> shuffle_seed);

class EdgeOutlet : public Outlet {
 public:
  // A writer in the robot's partition.
  [[nodiscard]] static Result<std::unique_ptr<EdgeOutlet>> Open(const wire::Participant& participant,
                                                                const EdgesToPush& batch);
  [[nodiscard]] Status SendHeader(const PushEngine& engine) override;  // one item that is not held: it gets an answer
  [[nodiscard]] Status SendManifest() override { return {}; }
  [[nodiscard]] Status SendChunk(const ChunkAt& chunk) override;
  [[nodiscard]] Status CheckInput() const override { return {}; }
  [[nodiscard]] bool HasServer() const override { return items_.MatchedReaders() > 0; }
  [[nodiscard]] std::vector<dds_entity_t> Writers() const override { return {items_.get()}; }

 private:
  EdgeOutlet(const EdgesToPush& batch, wire::Writer<rigcal_wire_PairwiseResult> items)
      : batch_(batch), items_(std::move(items)) {}

  const EdgesToPush& batch_;
  wire::Writer<rigcal_wire_PairwiseResult> items_;
};

}  // namespace rigcal::client
