#include "storage/database/connection.h"

#include <utility>

#include "server/base/process/guarded.h"
#include "server/base/process/out_of_memory.h"
#include "storage/database/sqlite_engine.h"

namespace rigcal::storage {
namespace {

constexpr int kSoonPatience_ms = 100;

Error MisuseOf(const std::string& what) {
  return {ErrorCode::kInternal, what, "This is a fault of rigcald: please report it."};
}

}  // namespace

Connection::Connection(std::unique_ptr<Engine> engine, std::string name)
    : name_(std::move(name)), engine_(std::move(engine)) {}

Connection::Connection(const std::filesystem::path& file, std::string name)
    : Connection(std::make_unique<SqliteEngine>(file), std::move(name)) {}

SQLite::Database& Connection::database() { return dynamic_cast<SqliteEngine&>(*engine_).database(); }

Error Connection::ErrorOf(const std::exception& failure, const std::string& subject) const {
  if (auto error = engine_->ErrorOf(failure, subject)) return *std::move(error);
  if (IsOutOfMemory(failure))
    return {ErrorCode::kInternal, subject + ": there was no memory left", "Give the server more memory."};
  if (dynamic_cast<const StoredWrong*>(&failure) != nullptr)
    return {ErrorCode::kStorage, subject + ": " + failure.what(),
            "The database is damaged: `rigcal fsck` names what is; restore it from a backup."};
  return MisuseOf(subject + ": " + failure.what());
}

Status Connection::Guarded(const std::string& subject, const Body& body) {
  try {
    return body();
  } catch (const std::exception& failure) {
    Error error = OnceThereIsMemory([&] { return ErrorOf(failure, subject); });
    if (state_ == State::kWriting && !doom_) OnceThereIsMemory([&] { doom_ = error; });
    return Fail(std::move(error));
  }
}

Status Connection::Run(void (Engine::*step)()) {
  return Guarded(name_, [&]() -> Status {
    ((*engine_).*step)();
    return {};
  });
}

Status Connection::Commit() {
  if (doom_) return Fail(*doom_);
  return Run(&Engine::Commit);
}

// Ends what is under way, whatever is thrown meanwhile.
class Connection::Ending {
 public:
  explicit Ending(Connection& connection) : connection_(connection) {}
  ~Ending() {
    if (!is_committed) connection_.engine_->Rollback();
    connection_.state_ = State::kIdle;
  }
  Ending(const Ending&) = delete;
  Ending& operator=(const Ending&) = delete;
  bool is_committed = false;

 private:
  Connection& connection_;
};

Status Connection::Write(void (Engine::*begin)(), const Body& body) {
  if (state_ != State::kIdle) return Fail(MisuseOf("a write inside another transaction"));
  RIGCAL_TRY(Run(begin));
  Ending ending(*this);
  state_ = State::kWriting;
  doom_.reset();
  Status done = guard_ ? Guarded(name_, guard_) : Status{};
  if (done) done = Guarded(name_, body);
  if (done) done = Commit();
  ending.is_committed = done.has_value();
  return done;
}

Status Connection::WriteSoon(const Body& body) {
  RIGCAL_TRY(WaitFor(kSoonPatience_ms));
  Status done = rigcal::Guarded([&] { return Write(body); });
  const Status patient = WaitFor(kPatience_ms);
  return done ? patient : done;
}

Status Connection::WaitFor(int milliseconds) {
  return Guarded(name_, [&]() -> Status {
    engine_->SetPatience(milliseconds);
    return {};
  });
}

Status Connection::Read(const Body& body) {
  if (state_ != State::kIdle) return Guarded(name_, body);
  Status done = Run(&Engine::BeginRead);
  const Ending ending(*this);
  state_ = State::kReading;
  if (done) done = Guarded(name_, body);
  return done;
}

Status Connection::Append(const std::string& subject, const Body& body) {
  if (state_ == State::kReading) return Fail(MisuseOf("a write inside a read"));
  if (state_ == State::kIdle) return Write([&] { return Append(subject, body); });
  if (doom_) return Fail(*doom_);
  return Guarded(subject, body);
}

Status Connection::Load(const std::string& subject, const Body& body) {
  if (doom_ && state_ == State::kWriting) return Fail(*doom_);
  return Guarded(subject, body);
}

}  // namespace rigcal::storage
