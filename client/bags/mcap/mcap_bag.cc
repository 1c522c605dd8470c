#include "client/bags/mcap/mcap_bag.h"

#include <limits>
#include <map>

#include "client/bags/cursor.h"
#include "client/bags/limits.h"
#include "client/bags/mcap/mcap_walk.h"
#include "server/base/text.h"

namespace rigcal::bags {
namespace {

constexpr const char* kCure = "What could be read is given; record the bag again, or mend it with `mcap recover`.";

// What the definitions of a type are called where the messages are ROS 1's.
constexpr const char* kRos1Schema = "ros1msg";

class McapBag : public Bag {
 public:
  explicit McapBag(McapWalk walk, std::optional<McapStatistics> statistics)
      : walk_(std::move(walk)), statistics_(std::move(statistics)) {}

  bool Next(Message& message) override {
    while (!over_) {
      const auto record = walk_.Next();
      if (!record || record->op == McapOp::kDataEnd) {
        Finish(record.has_value());
        return false;
      }
      if (Take(*record, message)) return true;
    }
    return false;
  }
  [[nodiscard]] std::vector<std::shared_ptr<const Topic>> Topics() const override {
    std::vector<std::shared_ptr<const Topic>> topics;
    for (const auto& [id, topic] : channels_) topics.push_back(topic);
    return topics;
  }
  [[nodiscard]] Damage Unread() const override { return walk_.damage(); }
  [[nodiscard]] std::int64_t bytes_done() const override { return static_cast<std::int64_t>(walk_.offset()); }
  [[nodiscard]] std::int64_t bytes_total() const override { return static_cast<std::int64_t>(walk_.source().size()); }

 private:
  struct Schema {
    std::string name, encoding, text;
  };

  // Whether it is a message.
  bool Take(const McapRecord& record, Message& message) {
    switch (record.op) {
      case McapOp::kSchema:
        return TakeSchema(record);
      case McapOp::kChannel:
        return TakeChannel(record);
      case McapOp::kMessage:
        return TakeMessage(record, message);
      default:
        return false;
    }
  }

  bool TakeSchema(const McapRecord& record) {
    const auto schema = ReadMcapSchema(record.content);
    if (!schema) return Lose(record, "a Schema that is not whole");
    if (schemas_.count(schema->id) > 0) return false;  // repeated in each chunk
    schema_bytes_ += schema->data.size();
    if (schemas_.size() >= limits::kTopicsMax || schema_bytes_ > limits::kDefinitionsBytesMax)
      return Lose(record, "more than " + std::to_string(limits::kTopicsMax) + " Schemas, or " +
                              std::to_string(limits::kDefinitionsBytesMax) + " bytes of them");
    schemas_[schema->id] = {std::string(schema->name), std::string(schema->encoding),
                            std::string(TextOf(schema->data))};
    return false;
  }

  bool TakeChannel(const McapRecord& record) {
    const auto channel = ReadMcapChannel(record.content);
    if (!channel) return Lose(record, "a Channel that is not whole");
    if (channels_.count(channel->id) > 0) return false;
    if (channels_.size() >= limits::kTopicsMax)
      return Lose(record, "more than " + std::to_string(limits::kTopicsMax) + " Channels");
    Topic topic;
    topic.name = channel->topic;
    topic.encoding = channel->message_encoding;
    const auto schema = schemas_.find(channel->schema_id);
    if (schema == schemas_.end() && channel->schema_id != 0)
      Lose(record, "the Channel of " + Quoted(channel->topic) + " refers to a Schema that did not come");
    if (schema != schemas_.end()) {
      topic.type = schema->second.name;
      topic.schema_encoding = schema->second.encoding;
      topic.schema = schema->second.text;
    }
    if (topic.encoding == "ros1" && topic.schema_encoding.empty() && !topic.schema.empty())
      topic.schema_encoding = kRos1Schema;
    channels_[channel->id] = std::make_shared<const Topic>(std::move(topic));
    return false;
  }

  bool TakeMessage(const McapRecord& record, Message& message) {
    const auto read = ReadMcapMessage(record.content);
    if (!read) return Lose(record, "a Message that is not whole");
    const auto channel = channels_.find(read->channel_id);
    if (channel == channels_.end()) {
      ++strays_;
      return false;
    }
    constexpr auto kLatest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
    if (read->log_ns > kLatest || read->publish_ns > kLatest)
      return Lose(record, "a Message of " + Quoted(channel->second->name) + " with a time beyond the year 2262");
    message = {channel->second, static_cast<std::int64_t>(read->log_ns), static_cast<std::int64_t>(read->publish_ns),
               read->data};
    ++given_;
    return true;
  }

  bool Lose(const McapRecord& record, const std::string& what) {
    walk_.damage().Add({ErrorCode::kInvalidInput,
                        walk_.source().name() + " at byte " + std::to_string(record.offset) + ": " + what, kCure});
    return false;
  }

  void Finish(bool data_ended) {
    over_ = true;
    while (data_ended && walk_.Next()) {  // to see whether the file is whole
    }
    const std::string& name = walk_.source().name();
    if (strays_ > 0)
      walk_.damage().Add({ErrorCode::kInvalidInput,
                          name + ": " + std::to_string(strays_) + " messages are of no Channel that is there", kCure});
    if (!walk_.damage().empty()) return;
    if (!walk_.closed())
      walk_.damage().Add(
          {ErrorCode::kInvalidInput,
           name + " was not closed: it ends after " + std::to_string(given_) + " messages without the end mark",
           kCure});
    else if (statistics_ && statistics_->messages != given_)
      walk_.damage().Add({ErrorCode::kInvalidInput,
                          name + ": its summary counts " + std::to_string(statistics_->messages) + " messages, " +
                              std::to_string(given_) + " are there",
                          kCure});
  }

  McapWalk walk_;
  std::optional<McapStatistics> statistics_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, std::shared_ptr<const Topic>> channels_;
  std::size_t schema_bytes_ = 0;
  std::uint64_t given_ = 0, strays_ = 0;
  bool over_ = false;
};

}  // namespace

Result<std::unique_ptr<Bag>> OpenMcap(std::unique_ptr<ByteSource> source) {
  auto statistics = SummaryStatistics(*source);
  RIGCAL_ASSIGN(McapWalk walk, McapWalk::Begin(std::move(source)));
  return std::make_unique<McapBag>(std::move(walk), std::move(statistics));
}

}  // namespace rigcal::bags
