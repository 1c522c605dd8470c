#include "client/import/frame_tree.h"

#include <algorithm>
#include <limits>

namespace rigcal::importing {
namespace {

constexpr int kLinksMax = 64;  // of a chain, which may be a ring
constexpr std::size_t kFramesMax = 100'000;

}  // namespace

std::string PlainFrame(const std::string& frame) { return frame.rfind('/', 0) == 0 ? frame.substr(1) : frame; }

void FrameTree::Add(const bags::StampedPose& transform, bool is_static) {
  const std::string child = PlainFrame(transform.child);
  if (links_.size() >= kFramesMax && links_.count(child) == 0) return;
  links_[child] = {PlainFrame(transform.header.frame), transform.T_frame_child, transform.header.stamp_ns, is_static};
}

std::optional<bags::StampedPose> FrameTree::Pose(const std::string& frame, const std::string& child,
                                                 std::int64_t tolerance_ns) const {
  std::int64_t oldest_ns = std::numeric_limits<std::int64_t>::max(),
               newest_ns = std::numeric_limits<std::int64_t>::min();
  Se3 T_at_child;
  std::string at = PlainFrame(child);
  for (int i = 0; at != PlainFrame(frame); ++i) {
    const auto link = links_.find(at);
    if (link == links_.end() || i >= kLinksMax) return std::nullopt;
    T_at_child = link->second.T_parent_child * T_at_child;
    at = link->second.parent;
    if (link->second.is_static) continue;
    oldest_ns = std::min(oldest_ns, link->second.stamp_ns);
    newest_ns = std::max(newest_ns, link->second.stamp_ns);
  }
  if (newest_ns < oldest_ns || newest_ns - oldest_ns > tolerance_ns) return std::nullopt;
  return bags::StampedPose{{newest_ns, frame}, child, T_at_child.Normalized()};
}

}  // namespace rigcal::importing
