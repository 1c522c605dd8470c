// Ids are types: a RobotId cannot be passed where a SensorId is meant.
#pragma once

#include <compare>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "server/base/result.h"

namespace rigcal {

// Names given by people: 1-64 characters of [A-Za-z0-9_.-], not starting with '.' or '-'. Safe as file names,
// DDS partitions and HTML. Digests: 64 lower-case hex digits.
[[nodiscard]] Status CheckName(std::string_view kind, std::string_view text);
[[nodiscard]] Status CheckDigest(std::string_view kind, std::string_view text);

template <typename Tag>
class Id {
 public:
  Id() = default;
  // Unchecked: for texts of our own, or that were checked before.
  explicit Id(std::string text) : text_(std::move(text)) {}
  // Checked construction, for everything that comes from outside. The error names the kind and the text.
  [[nodiscard]] static Result<Id> Parse(std::string_view text) {
    if (Status ok = Tag::kIsDigest ? CheckDigest(Tag::kKind, text) : CheckName(Tag::kKind, text); !ok)
      return Fail(ok.error());
    return Id(std::string(text));
  }
  [[nodiscard]] const std::string& str() const { return text_; }
  [[nodiscard]] bool empty() const { return text_.empty(); }
  friend bool operator==(const Id&, const Id&) = default;
  friend std::strong_ordering operator<=>(const Id& a, const Id& b) { return a.text_.compare(b.text_) <=> 0; }

 private:
  std::string text_;
};

struct RobotTag {
  static constexpr std::string_view kKind = "robot id";
  static constexpr bool kIsDigest = false;
};
struct SensorTag {
  static constexpr std::string_view kKind = "sensor id";
  static constexpr bool kIsDigest = false;
};
struct TargetTag {
  static constexpr std::string_view kKind = "target id";
  static constexpr bool kIsDigest = false;
};
struct CaptureTag {
  static constexpr std::string_view kKind = "capture id";
  static constexpr bool kIsDigest = false;
};
struct SessionTag {
  static constexpr std::string_view kKind = "session id";
  static constexpr bool kIsDigest = true;
};
struct EdgeTag {
  static constexpr std::string_view kKind = "edge id";
  static constexpr bool kIsDigest = true;
};
struct DigestTag {
  static constexpr std::string_view kKind = "sha256";
  static constexpr bool kIsDigest = true;
};
struct BatchTag {
  static constexpr std::string_view kKind = "batch id";
  static constexpr bool kIsDigest = true;
};

using RobotId = Id<RobotTag>;
using SensorId = Id<SensorTag>;
using TargetId = Id<TargetTag>;
using CaptureId = Id<CaptureTag>;
using SessionId = Id<SessionTag>;
using EdgeId = Id<EdgeTag>;
using BatchId = Id<BatchTag>;
using Digest = Id<DigestTag>;

}  // namespace rigcal

template <typename Tag>
struct std::hash<rigcal::Id<Tag>> {
  // Of the text, so that ids may be keys of unordered containers.
  std::size_t operator()(const rigcal::Id<Tag>& id) const { return std::hash<std::string>{}(id.str()); }
};
