#include "client/bags/ros1_bag.h"

#include <array>
#include <map>
#include <optional>

#include "client/bags/limits.h"
#include "client/bags/ros1_records.h"
#include "client/bags/unpack.h"
#include "server/base/text.h"

namespace rigcal::bags {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::string_view kMagic = "#ROSBAG V2.0\n", kAnyVersion = "#ROSBAG V";
constexpr const char* kCure = "What could be read is given; record the bag again, or mend it with `rosbag reindex`.";

class Ros1Bag : public Bag {
 public:
  explicit Ros1Bag(std::unique_ptr<ByteSource> source) : source_(std::move(source)), at_(kMagic.size()) {}

  bool Next(Message& message) override {
    for (;;) {
      if (read_ < chunk_.size()) {
        if (NextOfChunk(message)) return true;
      } else if (over_ || !NextOfFile(message)) {
        Finish();
        return false;
      } else if (message.topic) {
        return true;
      }
    }
  }
  [[nodiscard]] std::vector<std::shared_ptr<const Topic>> Topics() const override {
    std::vector<std::shared_ptr<const Topic>> topics;
    for (const auto& [id, topic] : connections_) topics.push_back(topic);
    return topics;
  }
  [[nodiscard]] Damage Unread() const override { return damage_; }
  [[nodiscard]] std::int64_t bytes_done() const override { return static_cast<std::int64_t>(at_); }
  [[nodiscard]] std::int64_t bytes_total() const override { return static_cast<std::int64_t>(source_->size()); }

 private:
  // False at the end of the file. A message has its topic set; else a chunk may have been entered.
  bool NextOfFile(Message& message) {
    message.topic = nullptr;
    const std::uint64_t offset = at_;
    if (offset == source_->size()) return false;
    const auto header = Block(offset, header_);
    if (!header) return false;
    const auto fields = Ros1Fields::Read(*header);
    if (!fields || !fields->op()) return Lose(offset, "this is no record of a bag");
    if (*fields->op() == Ros1Op::kChunk) return EnterChunk(offset, *fields);
    const bool is_wanted = *fields->op() == Ros1Op::kConnection || *fields->op() == Ros1Op::kMessage;
    if (!is_wanted) return SkipBlock(offset);
    const auto data = Block(offset, data_);
    if (!data) return false;
    Take(*fields, *data, message);
    return true;
  }

  bool NextOfChunk(Message& message) {
    Cursor in(Bytes(chunk_).subspan(read_));
    const Bytes header = in.Block(), data = in.Block();
    const auto fields = in.failed() ? std::nullopt : Ros1Fields::Read(header);
    if (!fields) {
      if (!chunk_trouble_) (void)Lose(chunk_offset_, "the chunk there ends within a record");
      read_ = chunk_.size();
      return false;
    }
    read_ = chunk_.size() - in.rest().size();
    message.topic = nullptr;
    Take(*fields, data, message);
    return message.topic != nullptr;
  }

  void Take(const Ros1Fields& fields, Bytes data, Message& message) {
    if (fields.op() == Ros1Op::kConnection) TakeConnection(fields, data);
    if (fields.op() != Ros1Op::kMessage) return;
    const auto connection = fields.Number("conn");
    const auto time_ns = fields.Time_ns("time");
    const auto topic = connections_.find(connection.value_or(UINT32_MAX));
    if (!connection || !time_ns || topic == connections_.end()) {
      ++strays_;
      return;
    }
    message = {topic->second, *time_ns, *time_ns, data};
    ++given_;
  }

  void TakeConnection(const Ros1Fields& fields, Bytes data) {
    const auto id = fields.Number("conn");
    const auto described = Ros1Fields::Read(data);
    if (!id || !described || connections_.count(*id) > 0) return;  // repeated in each chunk and at the end
    if (connections_.size() >= limits::kTopicsMax) {
      ++strays_;
      return;
    }
    Topic topic;
    topic.name = fields.Text("topic");
    topic.type = described->Text("type");
    topic.encoding = "ros1";
    topic.schema = described->Text("message_definition");
    topic.schema_encoding = "ros1msg";
    connections_[*id] = std::make_shared<const Topic>(std::move(topic));
  }

  bool EnterChunk(std::uint64_t offset, const Ros1Fields& fields) {
    const auto packing = PackingOf(fields.Text("compression"));
    const std::string name(fields.Text("compression"));
    chunk_offset_ = offset;
    chunk_trouble_.reset();
    const bool is_read = packing && *packing != Packing::kZstd;
    const auto data = Block(offset, data_, true);
    if (!data) return false;
    if (!is_read)
      return Lose(offset, "the chunk there is compressed with " + Quoted(name) + ", which is neither bz2 nor lz4") ||
             true;
    Unpacked unpacked = Unpack(*packing, *data, limits::kChunkBytesMax);
    if (unpacked.trouble && !chunk_trouble_) chunk_trouble_ = unpacked.trouble;
    const auto size = fields.Number("size");
    if (!chunk_trouble_ && size && *size != unpacked.bytes.size())
      chunk_trouble_ =
          "it unpacks to " + std::to_string(unpacked.bytes.size()) + " bytes, not " + std::to_string(*size);
    if (chunk_trouble_) (void)Lose(offset, "of the chunk there not all can be read: " + *chunk_trouble_);
    chunk_ = std::move(unpacked.bytes);
    read_ = 0;
    return true;
  }

  // Bytes behind their 32-bit length; of a chunk also those that are there of one that was cut off.
  std::optional<Bytes> Block(std::uint64_t offset, std::vector<std::byte>& buffer, bool as_far_as_it_goes = false) {
    const auto size = BlockSize(offset);
    if (!size) return std::nullopt;
    const std::uint64_t there = source_->size() - at_;
    if (*size > limits::kRecordBytesMax || (*size > there && !as_far_as_it_goes)) {
      (void)Lose(offset, "a record of " + std::to_string(*size) + " bytes, " +
                             (*size > there ? "of which " + std::to_string(there) + " are there"
                                            : "beyond the limit of " + std::to_string(limits::kRecordBytesMax)));
      return std::nullopt;
    }
    if (*size > there)
      chunk_trouble_ = "the file ends within it, " + std::to_string(*size - there) + " bytes are missing";
    buffer.resize(static_cast<std::size_t>(std::min<std::uint64_t>(*size, there)));
    const auto got = source_->ReadAt(at_, buffer);
    if (!got) {
      damage_.Add(got.error());
      return std::nullopt;
    }
    at_ += buffer.size();
    return Bytes(buffer);
  }
  bool SkipBlock(std::uint64_t offset) {
    const auto size = BlockSize(offset);
    if (!size) return false;
    if (*size > source_->size() - at_) return Lose(offset, "the file ends within a record");
    at_ += *size;
    return true;
  }
  std::optional<std::uint64_t> BlockSize(std::uint64_t offset) {
    std::array<std::byte, 4> bytes{};
    const auto got = source_->ReadAt(at_, bytes);
    if (!got) damage_.Add(got.error());
    if (got && *got < bytes.size()) (void)Lose(offset, "the file ends within a record");
    if (!got || *got < bytes.size()) return std::nullopt;
    at_ += bytes.size();
    return Cursor(bytes).Number<std::uint32_t>();
  }

  // False, for the caller to return.
  bool Lose(std::uint64_t offset, const std::string& what) {
    damage_.Add(
        {ErrorCode::kInvalidInput, source_->name() + " at byte " + std::to_string(offset) + ": " + what, kCure});
    return false;
  }
  void Finish() {
    if (!over_ && strays_ > 0)
      damage_.Add({ErrorCode::kInvalidInput,
                   source_->name() + ": " + std::to_string(strays_) + " messages are of no connection that is there",
                   kCure});
    over_ = true;
  }

  std::unique_ptr<ByteSource> source_;
  std::uint64_t at_, chunk_offset_ = 0, given_ = 0, strays_ = 0;
  std::vector<std::byte> header_, data_, chunk_;
  std::size_t read_ = 0;  // of chunk_
  std::optional<std::string> chunk_trouble_;
  std::map<std::uint32_t, std::shared_ptr<const Topic>> connections_;
  bool over_ = false;
  Damage damage_;
};

}  // namespace

Result<std::unique_ptr<Bag>> OpenRos1Bag(std::unique_ptr<ByteSource> source) {
  std::array<char, kMagic.size()> begins{};
  RIGCAL_ASSIGN(const std::size_t got, source->ReadAt(0, std::as_writable_bytes(std::span(begins))));
  const std::string_view text(begins.data(), got);
  if (got == 0) return Fail(ErrorCode::kInvalidInput, source->name() + " is empty", "Record the bag again.");
  if (text.rfind(kAnyVersion, 0) != 0)
    return Fail(ErrorCode::kInvalidInput, source->name() + " is no bag of ROS 1: it does not begin as one",
                "Give the path of a bag.");
  if (text != kMagic)
    return Fail(ErrorCode::kUnsupported, source->name() + " is a bag of another version than 2.0",
                "Convert it with `rosbag migrate`.");
  return std::make_unique<Ros1Bag>(std::move(source));
}

}  // namespace rigcal::bags
