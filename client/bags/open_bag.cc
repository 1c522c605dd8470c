#include "client/bags/open_bag.h"

#include <array>
#include <map>
#include <optional>

#include "client/bags/byte_source.h"
#include "client/bags/cursor.h"
#include "client/bags/limits.h"
#include "client/bags/mcap/mcap_bag.h"
#include "client/bags/parts.h"
#include "client/bags/ros1_bag.h"
#include "client/bags/sqlite_bag.h"
#include "client/bags/temporary_file.h"
#include "client/bags/unpack.h"
#include "server/base/text.h"
#include "server/formats/edges/first_three.h"

namespace rigcal::bags {
namespace {

namespace fs = std::filesystem;

Result<std::unique_ptr<Bag>> OpenPlain(const fs::path& file, const fs::path& named) {
  RIGCAL_ASSIGN(std::unique_ptr<ByteSource> source, OpenSource(file, named.string()));
  std::array<std::byte, 16> begins{};
  RIGCAL_ASSIGN(const std::size_t got, source->ReadAt(0, begins));
  const std::string_view text = TextOf(std::span(begins).first(got));
  if (text.rfind("\x89MCAP", 0) == 0) return OpenMcap(std::move(source));
  if (text.rfind("#ROSBAG V", 0) == 0) return OpenRos1Bag(std::move(source));
  if (text.rfind("SQLite format 3", 0) == 0) return OpenSqliteBag(file, named.string());
  if (got == 0) return Fail(ErrorCode::kInvalidInput, named.string() + " is empty", "Record the bag again.");
  return Fail(ErrorCode::kInvalidInput,
              named.string() + " is no bag: it is neither MCAP nor a database of rosbag2 nor a bag of ROS 1",
              "Give the path of a bag.");
}

// What a compressed file is unpacked into has its name no longer than until it is open: whatever ends this program, no
// gigabytes stay behind.
Result<std::unique_ptr<Bag>> Open(const fs::path& file, Damage& damage) {
  std::array<std::byte, 4> begins{};
  {
    RIGCAL_ASSIGN(const std::unique_ptr<ByteSource> source, OpenSource(file));
    RIGCAL_TRY(source->ReadAt(0, begins));
  }
  if (!IsZstd(begins)) return OpenPlain(file, file);
  RIGCAL_ASSIGN(const std::unique_ptr<TemporaryFile> unpacked,
                TemporaryFile::Make(file.extension() == ".zstd" ? file.stem().extension().string() : ""));
  RIGCAL_TRY(UnpackZstdFile(file, unpacked->path(), [&](Error error) { damage.Add(std::move(error)); }));
  return OpenPlain(unpacked->path(), file);
}

class PartsBag : public Bag {
 public:
  PartsBag(Parts parts, std::int64_t bytes_total) : parts_(std::move(parts)), bytes_total_(bytes_total) {
    for (const Error& doubt : parts_.doubts) damage_.Add(doubt);
  }

  // The first part that is a bag; the error of the first one where none is.
  Status Begin() {
    std::optional<Error> first;
    while (next_ < parts_.files.size() && !part_) {
      const Status opened = OpenNext();
      if (!opened && !first) first = opened.error();
    }
    if (!part_)
      return Fail(first.value_or(Error{ErrorCode::kInvalidInput, "the bag has no files", "Give the path of a bag."}));
    return {};
  }

  bool Next(Message& message) override {
    while (part_) {
      if (part_->Next(message)) {
        message.topic = OneOf(message.topic);
        if (Unpack(message)) return true;
        continue;
      }
      Close();
      while (next_ < parts_.files.size() && !part_) (void)OpenNext();
    }
    TellNotUnpacked();
    return false;
  }
  [[nodiscard]] std::vector<std::shared_ptr<const Topic>> Topics() const override {
    std::vector<std::shared_ptr<const Topic>> topics = known_;
    if (!part_) return topics;
    for (const auto& topic : part_->Topics())
      if (!Find(*topic)) topics.push_back(topic);
    return topics;
  }
  [[nodiscard]] Damage Unread() const override {
    Damage all = damage_;
    if (part_) all.Add(part_->Unread());
    if (!otherwise_.empty())
      all.Add({ErrorCode::kInvalidInput,
               "metadata.yaml has other encodings than the files: " +
                   formats::FirstThree(otherwise_.size(), [&](std::size_t i) { return otherwise_[i]; }),
               "The bag is read as its files say; mend metadata.yaml if that is right."});
    return all;
  }
  [[nodiscard]] std::int64_t bytes_done() const override { return bytes_done_ + (part_ ? part_->bytes_done() : 0); }
  [[nodiscard]] std::int64_t bytes_total() const override { return bytes_total_; }

 private:
  Status OpenNext() {
    auto part = Open(parts_.files[next_++], damage_);
    if (!part) damage_.Add(part.error());
    if (!part) return Fail(part.error());
    part_ = *std::move(part);
    return {};
  }
  void Close() {
    bytes_done_ += part_->bytes_total();
    for (const auto& topic : part_->Topics()) (void)OneOf(topic);
    damage_.Add(part_->Unread());
    part_.reset();
    same_.clear();
  }

  // One topic for all parts that have it, so that it is decoded by one definition.
  std::shared_ptr<const Topic> OneOf(const std::shared_ptr<const Topic>& topic) {
    auto& same = same_[topic.get()];
    if (same) return same;
    same = Find(*topic);
    if (same) return same;
    const auto stated = parts_.encodings.find(topic->name);
    if (stated != parts_.encodings.end() && stated->second != topic->encoding)
      otherwise_.push_back(Quoted(topic->name) + " as " + Quoted(stated->second));
    known_.push_back(topic);
    return same = topic;
  }
  [[nodiscard]] std::shared_ptr<const Topic> Find(const Topic& topic) const {
    for (const auto& known : known_)
      if (known->name == topic.name && known->type == topic.type && known->encoding == topic.encoding &&
          known->schema == topic.schema)
        return known;
    return nullptr;
  }

  // Of a message that was compressed by itself.
  bool Unpack(Message& message) {
    if (message.topic->encoding != "cdr" || !IsZstd(message.bytes)) return true;
    Unpacked unpacked = bags::Unpack(Packing::kZstd, message.bytes, limits::kRecordBytesMax);
    not_unpacked_ += unpacked.trouble ? 1 : 0;
    unpacked_ = std::move(unpacked.bytes);
    message.bytes = unpacked_;
    return !unpacked.trouble;
  }
  void TellNotUnpacked() {
    if (not_unpacked_ > 0)
      damage_.Add({ErrorCode::kInvalidInput,
                   std::to_string(not_unpacked_) + " messages are compressed and cannot be unpacked",
                   "They are left out; copy the bag again from where it was recorded."});
    not_unpacked_ = 0;
  }

  Parts parts_;
  std::unique_ptr<Bag> part_;
  std::size_t next_ = 0;
  std::int64_t bytes_total_, bytes_done_ = 0, not_unpacked_ = 0;
  std::vector<std::shared_ptr<const Topic>> known_;
  std::map<const Topic*, std::shared_ptr<const Topic>> same_;  // of the open part
  std::vector<std::string> otherwise_;                         // topics that metadata.yaml describes otherwise
  std::vector<std::byte> unpacked_;
  Damage damage_;
};

}  // namespace

Result<std::unique_ptr<Bag>> OpenBag(const fs::path& path) {
  RIGCAL_ASSIGN(Parts parts, PartsOf(path));
  std::int64_t bytes = 0;
  for (const fs::path& file : parts.files) {
    std::error_code missing;
    const auto size = fs::file_size(file, missing);
    bytes += missing ? 0 : static_cast<std::int64_t>(size);
  }
  auto bag = std::make_unique<PartsBag>(std::move(parts), bytes);
  RIGCAL_TRY(bag->Begin());
  return bag;
}

}  // namespace rigcal::bags
