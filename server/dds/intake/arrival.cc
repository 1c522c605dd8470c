#include "server/dds/intake/arrival.h"

#include "server/base/limits.h"

namespace rigcal::dds {
namespace {

constexpr std::size_t kItemBytes = 512;  // ids and queue overhead of a small arrival

std::size_t ContentBytes(const wire::BatchItem& item) {
  const Uncertainty& uncertainty = item.edge.uncertainty;
  return sizeof(wire::BatchItem) + uncertainty.blocks.size() * (sizeof(BlockVector) + limits::kNameMax) +
         uncertainty.contributions.size() * (sizeof(Contribution) + limits::kNameMax);
}

std::size_t ContentBytes(const ChunkBytes& chunk) { return chunk.bytes.size(); }
std::size_t ContentBytes(const ManifestText& text) { return text.bytes.size(); }
std::size_t ContentBytes(const Order& order) { return order.json.size(); }
template <typename T>
std::size_t ContentBytes(const T&) {
  return 0;
}

}  // namespace

std::int64_t BytesOf(const Arrival& arrival) {
  return static_cast<std::int64_t>(kItemBytes + std::visit([](const auto& one) { return ContentBytes(one); }, arrival));
}

}  // namespace rigcal::dds
