#include "client/import/frame_tree.h"

#include <algorithm>
#include <limits>

#include "server/base/text.h"

namespace rigcal::importing {
namespace {

constexpr int kLinksMax = 64;  // of a chain, which may be a ring
constexpr std::size_t kFramesMax = 100'000;
constexpr double kSame_m = 1e-6, kSame_rad = 1e-6;  // the same static transform, said again

// "'a', 'b' and 'c'"
std::string Listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 < names.size() ? ", " : " and ") + Quoted(names[i]);
  return text;
}

}  // namespace

std::string PlainFrame(const std::string& frame) { return frame.rfind('/', 0) == 0 ? frame.substr(1) : frame; }

void FrameTree::Add(const bags::StampedPose& transform, bool is_static) {
  const std::string child = PlainFrame(transform.child);
  if (links_.size() >= kFramesMax && links_.count(child) == 0) return;
  Link link{PlainFrame(transform.header.frame), transform.T_frame_child, transform.header.stamp_ns, is_static, ""};
  const auto [known, is_new] = links_.try_emplace(child, link);
  if (is_new) return;
  link.doubt = known->second.doubt;
  const bool is_elsewhere = (is_static || known->second.is_static) &&
                            !AreNear(known->second.T_parent_child, link.T_parent_child, kSame_m, kSame_rad);
  if (link.doubt.empty() && link.parent != known->second.parent)
    link.doubt = "the frame " + Quoted(child) + " is in " + Quoted(known->second.parent) + " and in " +
                 Quoted(link.parent) + ": a frame has one above it";
  else if (link.doubt.empty() && is_elsewhere)
    link.doubt = "the transform of " + Quoted(child) + " in " + Quoted(link.parent) +
                 " is said to be static, and came with two values";
  known->second = std::move(link);
}

std::vector<std::pair<std::string, const FrameTree::Link*>> FrameTree::Chain(const std::string& frame,
                                                                             const std::string& child) const {
  std::vector<std::pair<std::string, const Link*>> chain;
  std::string at = PlainFrame(child);
  while (at != PlainFrame(frame) && chain.size() < kLinksMax) {
    const auto link = links_.find(at);
    if (link == links_.end()) break;
    chain.emplace_back(at, &link->second);
    at = link->second.parent;
  }
  return chain;
}

std::optional<bags::StampedPose> FrameTree::Pose(const std::string& frame, const std::string& child,
                                                 std::int64_t tolerance_ns) const {
  std::int64_t oldest_ns = std::numeric_limits<std::int64_t>::max(),
               newest_ns = std::numeric_limits<std::int64_t>::min();
  Se3 T_at_child;
  std::string at = PlainFrame(child);
  for (const auto& [of, link] : Chain(frame, child)) {
    T_at_child = link->T_parent_child * T_at_child;
    at = link->parent;
    if (link->is_static) continue;
    oldest_ns = std::min(oldest_ns, link->stamp_ns);
    newest_ns = std::max(newest_ns, link->stamp_ns);
  }
  if (at != PlainFrame(frame) || newest_ns < oldest_ns || newest_ns - oldest_ns > tolerance_ns) return std::nullopt;
  return bags::StampedPose{{newest_ns, frame}, child, T_at_child.Normalized()};
}

bool FrameTree::IsBetween(const std::string& link, const std::string& frame, const std::string& child) const {
  const auto chain = Chain(frame, child);
  return std::any_of(chain.begin(), chain.end(), [&](const auto& one) { return one.first == PlainFrame(link); });
}

std::string FrameTree::Doubt(const std::string& frame, const std::string& child) const {
  for (const auto& [of, link] : Chain(frame, child))
    if (!link->doubt.empty()) return link->doubt;
  return "";
}

bool FrameTree::IsKnown(const std::string& frame) const {
  return links_.count(frame) > 0 || std::any_of(links_.begin(), links_.end(), [&](const auto& child_link) {
           return child_link.second.parent == frame;
         });
}

std::string FrameTree::WhyNone(const std::string& frame, const std::string& child) const {
  const std::string top = PlainFrame(frame);
  for (const std::string& name : {PlainFrame(child), top})
    if (!IsKnown(name)) return "no transform is of or in a frame " + Quoted(name);
  std::vector<std::string> above;
  bool moves = false;
  for (const auto& [of, link] : Chain(frame, child)) {
    above.push_back(link->parent);
    moves = moves || !link->is_static;
  }
  if (above.empty() || above.back() != top)
    return Quoted(child) + " is not below " + Quoted(frame) + ": above it " +
           (above.empty() ? "is nothing" : (above.size() == 1 ? "is " : "are ") + Listed(above));
  return moves ? "the transforms from " + Quoted(frame) + " to " + Quoted(child) +
                     " are never within `tolerance_s` of each other"
               : "all transforms from " + Quoted(frame) + " to " + Quoted(child) +
                     " are static: nothing tells when it was where";
}

}  // namespace rigcal::importing
