#include "client/wire/edge_outlet.h"

#include <algorithm>
#include <numeric>
#include <random>

namespace rigcal::client {

EdgesToPush EdgesOf(const RobotId& robot, std::vector<Edge> edges, std::optional<std::uint64_t> shuffle_seed) {
  EdgesToPush batch;
  batch.robot = robot;
  batch.id = BatchIdOf(robot, edges);
  std::vector<std::uint32_t> by_id(edges.size());
  std::iota(by_id.begin(), by_id.end(), 0U);
  std::sort(by_id.begin(), by_id.end(), [&](std::uint32_t x, std::uint32_t y) { return edges[x].id < edges[y].id; });
  batch.send_order.resize(edges.size());
  for (std::uint32_t rank = 0; rank < by_id.size(); ++rank) {
    batch.send_order[by_id[rank]] = rank;
    batch.edges.push_back(std::move(edges[by_id[rank]]));
  }
  if (shuffle_seed) std::shuffle(batch.send_order.begin(), batch.send_order.end(), std::mt19937_64(*shuffle_seed));
  return batch;
}

Result<std::unique_ptr<EdgeOutlet>> EdgeOutlet::Open(const wire::Participant& participant, const EdgesToPush& batch) {
  RIGCAL_ASSIGN(auto items,
                wire::Writer<rigcal_wire_PairwiseResult>::Open(participant, {wire::RobotPartition(batch.robot)}));
  return std::unique_ptr<EdgeOutlet>(new EdgeOutlet(batch, std::move(items)));
}

Status EdgeOutlet::SendHeader(const PushEngine& engine) { return SendChunk({ProbeItem(engine.chunks()), 0, 1}); }

Status EdgeOutlet::SendChunk(const ChunkAt& chunk) {
  wire::BatchItem item;
  item.batch = batch_.id;
  item.idx = chunk.payload_idx;
  item.count = static_cast<std::uint32_t>(batch_.edges.size());
  item.edge = batch_.edges[chunk.payload_idx];
  RIGCAL_ASSIGN(const auto sample, wire::ToPairwiseResult(item));
  return items_.Write(sample.sample);
}

}  // namespace rigcal::client
