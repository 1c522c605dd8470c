#include "client/import/topic_tally.h"

#include <algorithm>
#include <cstdio>

#include "client/bags/messages/cloud.h"
#include "client/bags/messages/header.h"
#include "client/bags/messages/image.h"
#include "client/bags/messages/motion.h"
#include "server/base/stamp.h"
#include "server/base/text.h"

namespace rigcal::importing {
namespace {

using bags::MessageKind;

constexpr std::size_t kSamplesMax = 65'536;
constexpr std::size_t kDetailBytesMax = 120;

// session.yaml's name of a lens model of sensor_msgs/distortion_models.
std::string LensModelOf(const std::string& distortion_model) {
  if (distortion_model == "plumb_bob") return "pinhole_radtan";
  if (distortion_model == "rational_polynomial") return "pinhole_rational";
  return distortion_model == "equidistant" || distortion_model == "fisheye" ? "fisheye_kb4" : "";
}

std::string SizeText(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

void Describe(const bags::CameraInfo& info, TopicSurvey& found) {
  found.detail = SizeText(info.width_px, info.height_px) + " " + info.distortion_model;
  found.lens_model = LensModelOf(info.distortion_model);
}
void Describe(const bags::Image& image, TopicSurvey& found) {
  found.detail = SizeText(image.width_px, image.height_px) + " " + image.encoding;
  found.sensor_kind = "camera";
}
void Describe(const bags::CompressedImage& image, TopicSurvey& found) {
  found.detail = image.suffix;
  found.sensor_kind = "camera";
}
void Describe(const bags::PointCloud& cloud, TopicSurvey& found) {
  found.detail = SizeText(static_cast<std::int64_t>(cloud.width), static_cast<std::int64_t>(cloud.height)) + " points:";
  for (const bags::PointField& field : cloud.fields) found.detail += " " + field.name;
  found.sensor_kind = "lidar";
}
void Describe(const bags::LaserScan& scan, TopicSurvey& found) {
  found.detail = std::to_string(scan.ranges_m.size()) + " ranges in a plane";
}
void Describe(const bags::StampedPose& pose, TopicSurvey& found) {
  if (!pose.child.empty()) found.detail = pose.header.frame + " -> " + pose.child;
  found.sensor_kind = "pose_stream";
}
void Describe(const bags::Imu&, TopicSurvey& found) { found.detail = "no pose of its own"; }
void Describe(const std::vector<bags::StampedPose>& transforms, TopicSurvey& found) {
  if (transforms.empty()) return;
  found.frame = transforms[0].header.frame;
  for (const bags::StampedPose& one : transforms)
    found.detail += (found.detail.empty() ? "" : ", ") + one.header.frame + " -> " + one.child;
}

template <typename T>
void DescribeOr(const Result<T>& read, TopicSurvey& found) {
  if (read)
    Describe(*read, found);
  else
    found.trouble = Sentence(read.error());
}

void Describe(const std::string& type, const bags::Value& value, TopicSurvey& found) {
  switch (bags::KindOf(type)) {
    case MessageKind::kImage:
      return DescribeOr(bags::ReadImage(value), found);
    case MessageKind::kCompressedImage:
      return DescribeOr(bags::ReadCompressedImage(value), found);
    case MessageKind::kCameraInfo:
      return DescribeOr(bags::ReadCameraInfo(value), found);
    case MessageKind::kCloud:
      return DescribeOr(bags::ReadPointCloud(value), found);
    case MessageKind::kScan:
      return DescribeOr(bags::ReadLaserScan(value), found);
    case MessageKind::kImu:
      return DescribeOr(bags::ReadImu(value), found);
    case MessageKind::kPose:
    case MessageKind::kOdometry:
      return DescribeOr(bags::ReadPose(value), found);
    case MessageKind::kTransforms:
      return DescribeOr(bags::ReadTransforms(value), found);
    case MessageKind::kOther:
      break;
  }
}

std::string NumberText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

// What the second has otherwise; empty: nothing.
std::string DifferenceText(const bags::CameraInfo& before, const bags::CameraInfo& now) {
  std::string text;
  const auto add = [&](const std::string& one) { text += (text.empty() ? "" : ", ") + one; };
  const auto add_number = [&](const char* name, double old, double fresh) {
    if (old != fresh) add(name + (" " + NumberText(old)) + " to " + NumberText(fresh));
  };
  if (before.width_px != now.width_px || before.height_px != now.height_px)
    add(SizeText(before.width_px, before.height_px) + " to " + SizeText(now.width_px, now.height_px));
  if (before.distortion_model != now.distortion_model)
    add(Quoted(before.distortion_model) + " to " + Quoted(now.distortion_model));
  add_number("fx", before.fx_px, now.fx_px);
  add_number("fy", before.fy_px, now.fy_px);
  add_number("cx", before.cx_px, now.cx_px);
  add_number("cy", before.cy_px, now.cy_px);
  if (before.distortion != now.distortion) add("another distortion");
  return text;
}

std::string StampText(std::int64_t ns) {
  char text[40];
  std::snprintf(text, sizeof text, "%lld.%09lld", static_cast<long long>(ns / 1'000'000'000),
                static_cast<long long>(ns % 1'000'000'000));
  return text;
}

}  // namespace

void CameraInfoWatch::Add(const bags::CameraInfo& info, std::int64_t log_ns) {
  const std::string difference = last_ ? DifferenceText(*last_, info) : "";
  last_ = info;
  if (difference.empty() || changes_++ > 0) return;
  const std::int64_t at_ns = info.header.stamp_ns > 0 ? info.header.stamp_ns : log_ns;
  first_change_ = "changes at " + ToIso(Stamp{at_ns}) + " (stamp " + StampText(at_ns) + "): " + difference;
}

std::string CameraInfoWatch::Change() const {
  if (changes_ < 2) return first_change_;
  return first_change_ + ", and " + (changes_ == 2 ? "once" : std::to_string(changes_ - 1) + " times") + " more";
}

void Samples::Add(std::int64_t value) {
  min_ = count_ == 0 ? value : std::min(min_, value);
  max_ = count_ == 0 ? value : std::max(max_, value);
  if (count_++ % stride_ != 0) return;
  kept_.push_back(value);
  if (kept_.size() < kSamplesMax) return;
  for (std::size_t i = 0; 2 * i < kept_.size(); ++i) kept_[i] = kept_[2 * i];
  kept_.resize(kept_.size() / 2);
  stride_ *= 2;
}

std::optional<OffsetSpread> Samples::Spread() const {
  if (kept_.empty()) return std::nullopt;
  std::vector<std::int64_t> sorted = kept_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return OffsetSpread{min_, *middle, max_};
}

TopicTally::TopicTally(const bags::Topic& topic) {
  found_.name = topic.name;
  found_.type = topic.type;
  found_.encoding = topic.encoding;
}

void TopicTally::Add(const bags::Message& message) {
  if (found_.count == 0) {
    found_.first_ns = found_.last_ns = message.log_ns;
  } else if (message.log_ns > found_.last_ns) {
    const std::int64_t gap_ns = message.log_ns - found_.last_ns;
    if (gap_ns > found_.longest_gap_ns) found_.gap_at_ns = found_.last_ns;
    found_.longest_gap_ns = std::max(found_.longest_gap_ns, gap_ns);
  }
  found_.first_ns = std::min(found_.first_ns, message.log_ns);
  found_.last_ns = std::max(found_.last_ns, message.log_ns);
  ++found_.count;
  found_.bytes += static_cast<std::int64_t>(message.bytes.size());
  LookInto(message);
}

void TopicTally::LookInto(const bags::Message& message) {
  if (decoded_ != message.topic.get()) {
    decoded_ = message.topic.get();
    auto definition = bags::DefinitionOf(*message.topic);
    if (!definition && found_.trouble.empty()) found_.trouble = Sentence(definition.error());
    definition_ = definition ? *definition : nullptr;
  }
  if (!definition_) return;
  const bool is_info = bags::KindOf(message.topic->type) == MessageKind::kCameraInfo;
  if (found_.count == 1 || is_info) {
    const auto value = bags::Decode(*message.topic, *definition_, message.bytes);
    if (value && found_.count == 1) Describe(message.topic->type, *value, found_);
    if (!value && found_.trouble.empty()) found_.trouble = Sentence(value.error());
    const auto info = is_info && value ? bags::ReadCameraInfo(*value) : Fail(ErrorCode::kInvalidInput, "", "");
    if (info) infos_.Add(*info, message.log_ns);
    if (found_.detail.size() > kDetailBytesMax) found_.detail = found_.detail.substr(0, kDetailBytesMax) + "...";
    if (!IsPrintableUtf8(found_.detail)) found_.detail = Quoted(found_.detail);
  }
  const auto header = bags::ReadHeader(*message.topic, *definition_, message.bytes);
  if (!header && found_.trouble.empty()) found_.trouble = Sentence(header.error());
  if (!header || !*header) return;
  if (found_.frame.empty()) found_.frame = (*header)->frame;
  AddStamp((*header)->stamp_ns, message.log_ns);
}

void TopicTally::AddStamp(std::int64_t stamp_ns, std::int64_t log_ns) {
  found_.unset_stamps += stamp_ns == 0 ? 1 : 0;
  found_.backward_stamps += stamp_ns <= last_stamp_ns_ ? 1 : 0;
  last_stamp_ns_ = std::max(last_stamp_ns_, stamp_ns);
  std::int64_t offset_ns = 0;
  if (stamp_ns != 0 && !__builtin_sub_overflow(stamp_ns, log_ns, &offset_ns)) offsets_.Add(offset_ns);
}

TopicSurvey TopicTally::Found() const {
  TopicSurvey found = found_;
  found.stamp_offset = offsets_.Spread();
  found.camera_change = infos_.Change();
  const double duration_s = static_cast<double>(found.last_ns - found.first_ns) * 1e-9;
  if (found.count > 1 && duration_s > 0) found.rate_hz = static_cast<double>(found.count - 1) / duration_s;
  if (!found.trouble.empty()) found.sensor_kind.clear();
  return found;
}

}  // namespace rigcal::importing
