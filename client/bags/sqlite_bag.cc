#include "client/bags/sqlite_bag.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <sqlite3.h>

#include <map>
#include <optional>
#include <vector>

#include "client/bags/limits.h"
#include "client/bags/sqlite_size.h"
#include "server/base/text.h"

namespace rigcal::bags {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCure =
    "What could be read is given; record the bag again, or mend it with sqlite3's `.recover`.";
constexpr int kBusyTimeout_ms = 1000;

// As a URI: a file without a log cannot change under us, and may lie where nothing can be written.
std::string UriOf(const fs::path& file) {
  std::string uri = "file:";
  for (const char c : fs::absolute(file).string()) {
    if (c == '?' || c == '#' || c == '%') {
      constexpr const char* kHex = "0123456789ABCDEF";
      uri += {'%', kHex[static_cast<unsigned char>(c) >> 4], kHex[static_cast<unsigned char>(c) & 15]};
    } else {
      uri += c;
    }
  }
  std::error_code none;
  const auto log_bytes = fs::file_size(file.string() + "-wal", none);
  return uri + (none || log_bytes == 0 ? "?immutable=1" : "?mode=ro");
}

class SqliteBag : public Bag {
 public:
  SqliteBag(const fs::path& file, std::string name, std::int64_t bytes)
      : name_(std::move(name)),
        bytes_(bytes),
        claimed_bytes_(static_cast<std::int64_t>(ClaimedSqliteBytes(file))),
        database_(UriOf(file), SQLite::OPEN_READONLY | SQLite::OPEN_URI, kBusyTimeout_ms) {}

  // Throws what SQLiteCpp throws.
  void Begin() {
    sqlite3_limit(database_.getHandle(), SQLITE_LIMIT_LENGTH, static_cast<int>(limits::kRecordBytesMax));
    database_.exec("PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON;");
    if (IsCut()) database_.exec("PRAGMA writable_schema = ON;");  // else SQLite refuses the whole of it
    const int tables =
        database_
            .execAndGet("SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name IN ('topics', 'messages')")
            .getInt();
    if (tables != 2) throw SQLite::Exception("it has no tables `topics` and `messages`");
    ReadTopics();
    ReadDefinitions();
    Count();
    for (auto& [id, topic] : reading_) topics_[id] = std::make_shared<const Topic>(std::move(topic));
    reading_.clear();
    query_.emplace(database_, "SELECT topic_id, timestamp, data FROM messages ORDER BY id");
  }

  bool Next(Message& message) override { return IsCut() ? NextOfCut(message) : Step(message); }
  [[nodiscard]] std::vector<std::shared_ptr<const Topic>> Topics() const override {
    std::vector<std::shared_ptr<const Topic>> topics;
    for (const auto& [id, topic] : topics_) topics.push_back(topic);
    return topics;
  }
  [[nodiscard]] Damage Unread() const override { return damage_; }
  [[nodiscard]] std::int64_t bytes_done() const override {
    return total_ > 0 ? static_cast<std::int64_t>(static_cast<double>(bytes_) * static_cast<double>(given_) /
                                                  static_cast<double>(total_))
                      : bytes_;
  }
  [[nodiscard]] std::int64_t bytes_total() const override { return bytes_; }

 private:
  [[nodiscard]] bool IsCut() const { return bytes_ < claimed_bytes_; }

  bool Step(Message& message) {
    if (!query_) return false;
    std::string failed;
    try {
      while (query_->executeStep())
        if (Take(message)) return true;
    } catch (const std::exception& failure) {
      failed = failure.what();
    }
    Finish(failed);
    return false;
  }

  // SQLite fills the page where the file was cut with zeros. A message that ends there ends in zeros; it is the last
  // one, as a recorder appends, and is left out. So each is held back until another one comes.
  bool NextOfCut(Message& message) {
    Message next;
    if (!held_ && Step(next)) Hold(next);
    if (!held_) return false;
    const bool is_last = !Step(next);
    given_bytes_ = std::move(held_bytes_);
    message = *held_;
    message.bytes = given_bytes_;
    held_.reset();
    if (!is_last) Hold(next);
    return !is_last || (!given_bytes_.empty() && given_bytes_.back() != std::byte{0});
  }
  void Hold(const Message& message) {
    held_ = message;
    held_bytes_.assign(message.bytes.begin(), message.bytes.end());
  }

  void ReadTopics() {
    SQLite::Statement rows(database_, "SELECT id, name, type, serialization_format FROM topics ORDER BY id");
    while (rows.executeStep() && reading_.size() < limits::kTopicsMax) {
      Topic topic;
      topic.name = rows.getColumn(1).getString();
      topic.type = rows.getColumn(2).getString();
      topic.encoding = rows.getColumn(3).getString();
      reading_[rows.getColumn(0).getInt64()] = std::move(topic);
    }
  }
  // In a file that was cut they may be what is lost; the types that are known do without.
  void ReadDefinitions() {
    try {
      if (database_.tableExists("message_definitions")) TakeDefinitions();
    } catch (const std::exception&) {
      if (!IsCut()) throw;
    }
  }
  void TakeDefinitions() {
    SQLite::Statement rows(database_,
                           "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions");
    std::size_t bytes = 0;
    while (rows.executeStep()) {
      const std::string type = rows.getColumn(0).getString(), encoding = rows.getColumn(1).getString(),
                        text = rows.getColumn(2).getString();
      bytes += text.size();
      if (bytes > limits::kDefinitionsBytesMax) break;
      for (auto& [id, topic] : reading_) {
        if (topic.type != type) continue;
        topic.schema_encoding = encoding;
        topic.schema = text;
      }
    }
  }
  void Count() {
    try {
      total_ = database_.execAndGet("SELECT count(*) FROM messages").getInt64();
    } catch (const std::exception&) {  // of a damaged one only the progress is not known
    }
  }

  bool Take(Message& message) {
    const auto topic = topics_.find(query_->getColumn(0).getInt64());
    const SQLite::Column data = query_->getColumn(2);
    if (topic == topics_.end() || static_cast<std::uint64_t>(data.getBytes()) > limits::kRecordBytesMax) {
      ++strays_;
      return false;
    }
    const std::int64_t time_ns = query_->getColumn(1).getInt64();
    const auto* first = static_cast<const std::byte*>(data.getBlob());
    message = {topic->second, time_ns, time_ns, {first, static_cast<std::size_t>(data.getBytes())}};
    ++given_;
    return true;
  }

  // `failed`: what SQLite said, if not all could be read.
  void Finish(const std::string& failed) {
    query_.reset();
    if (IsCut())
      damage_.Add({ErrorCode::kInvalidInput,
                   name_ + " is cut off: " + std::to_string(bytes_) + " of " + std::to_string(claimed_bytes_) +
                       " bytes are there",
                   kCure});
    else if (!failed.empty())
      damage_.Add(
          {ErrorCode::kInvalidInput,
           name_ + ": after " + std::to_string(given_) + " messages the database cannot be read: " + Quoted(failed),
           kCure});
    if (strays_ > 0 && !IsCut())
      damage_.Add({ErrorCode::kInvalidInput,
                   name_ + ": " + std::to_string(strays_) + " messages are of no topic that is there, or beyond " +
                       std::to_string(limits::kRecordBytesMax) + " bytes",
                   kCure});
  }

  std::string name_;
  std::int64_t bytes_, claimed_bytes_, given_ = 0, total_ = 0, strays_ = 0;
  SQLite::Database database_;
  std::map<std::int64_t, Topic> reading_;
  std::map<std::int64_t, std::shared_ptr<const Topic>> topics_;
  std::optional<SQLite::Statement> query_;           // gone: the end
  std::optional<Message> held_;                      // of a file that was cut: read, and not given yet
  std::vector<std::byte> held_bytes_, given_bytes_;  // what it points into, and what the one that was given does
  Damage damage_;
};

}  // namespace

Result<std::unique_ptr<Bag>> OpenSqliteBag(const fs::path& file, const std::string& name) {
  const std::string named = name.empty() ? file.string() : name;
  std::error_code failed;
  const auto bytes = fs::file_size(file, failed);
  if (failed)
    return Fail(ErrorCode::kNotFound, named + ": cannot be read (" + failed.message() + ")", "Check the path.");
  try {
    auto bag = std::make_unique<SqliteBag>(file, named, static_cast<std::int64_t>(bytes));
    bag->Begin();
    return bag;
  } catch (const std::exception& failure) {
    return Fail(ErrorCode::kInvalidInput, named + " is no bag in a database: " + Quoted(failure.what()),
                "Give the path of a bag, or mend it with sqlite3's `.recover`.");
  }
}

}  // namespace rigcal::bags
