#include "server/pipeline/workers/worker.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <future>
#include <iostream>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "server/base/log.h"
#include "server/base/process/memory_budget.h"
#include "server/base/process/thread_rank.h"
#include "server/base/text.h"
#include "server/metrics/noted.h"
#include "server/pipeline/attempt.h"
#include "server/pipeline/edges/run_edge_job.h"
#include "server/pipeline/recomputation/drain.h"
#include "server/pipeline/reports/publish.h"
#include "server/pipeline/sessions/session_refinement.h"

namespace rigcal::pipeline {
namespace {

using Fields = std::vector<std::string>;

std::string LineOf(const Fields& fields) {
  std::string line;
  for (std::string field : fields) {
    for (char& c : field)
      if (c == '\t' || c == '\n' || c == '\r') c = ' ';
    line += (line.empty() ? "" : "\t") + field;
  }
  return line;
}

std::int64_t NumberOf(const std::string& text) {
  std::int64_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

// What is said to the server and what it says: orders for the thread that works, and memory for those that decode.
class Line {
 public:
  // The file descriptor that answers go to; whatever a library prints goes to the log.
  explicit Line(int answers) : answers_(answers) {}

  void Say(const Fields& fields) {
    const std::string line = LineOf(fields) + "\n";
    const std::lock_guard lock(mutex_);
    for (std::size_t at = 0; at < line.size();) {
      const ssize_t written = write(answers_, line.data() + at, line.size() - at);
      if (written < 0 && errno != EINTR) std::_Exit(1);  // nobody listens any more
      at += written > 0 ? static_cast<std::size_t>(written) : 0;
    }
  }

  MemoryBudget::GiveBack TakeMemory(std::int64_t bytes) {
    std::string id;
    std::future<void> granted;
    {
      const std::lock_guard lock(mutex_);
      id = std::to_string(++asked_);
      granted = waiting_[id].get_future();
    }
    Say({"take", id, std::to_string(bytes)});
    granted.wait();
    return [this, id] { Say({"give", id}); };
  }

  void Grant(const std::string& id) {
    const std::lock_guard lock(mutex_);
    const auto found = waiting_.find(id);
    if (found == waiting_.end()) return;
    found->second.set_value();
    waiting_.erase(found);
  }

  void Order(Fields order) {
    const std::lock_guard lock(mutex_);
    next_.set_value(std::move(order));
  }
  Fields NextOrder() {
    std::future<Fields> next;
    {
      const std::lock_guard lock(mutex_);
      next = next_.get_future();
    }
    Fields order = next.get();
    const std::lock_guard lock(mutex_);
    next_ = {};
    return order;
  }

 private:
  int answers_;
  std::mutex mutex_;
  std::promise<Fields> next_;
  std::map<std::string, std::promise<void>> waiting_;
  std::uint64_t asked_ = 0;
};

// Without a server there is nobody to work for: what is unfinished is done anew.
void Listen(Line& line) {
  for (std::string text; std::getline(std::cin, text);) {
    Fields fields = WorkerFields(text);
    if (fields[0] == "granted" && fields.size() == 2)
      line.Grant(fields[1]);
    else
      line.Order(std::move(fields));
  }
  std::_Exit(0);
}

struct WorkPlace {
  storage::Store& store;
  const Clock& clock;
  calib::CameraMemory& cameras;
};

Result<std::string> CarryOutOrder(const WorkPlace& place, const Fields& order) {
  if (order[0] == "job" && order.size() == 7) {
    const storage::JobRow job{NumberOf(order[1]),
                              RobotId(order[2]),
                              SessionId(order[3]),
                              {SensorId(order[4]), SensorId(order[5])},
                              static_cast<int>(NumberOf(order[6]))};
    const LogAbout about({.robot = order[2], .session = order[3], .job = order[1]});
    RIGCAL_ASSIGN(const Edge edge, RunEdgeJob(place.store, job, place.clock, place.cameras));
    return edge.id.str();
  }
  if (order[0] == "refine" && order.size() == 2) {
    const LogAbout about({.robot = order[1]});
    RIGCAL_TRY(RefineSessions(place.store, RobotId(order[1]), place.cameras, place.clock));
    return std::string();
  }
  if (order[0] == "recompute" && order.size() == 2) {
    RIGCAL_ASSIGN(const auto item, storage::LoadRecomputedItem(place.store, NumberOf(order[1])));
    if (item) RIGCAL_TRY(RecomputeSession(place.store, *item, place.clock, place.cameras));
    return std::string();
  }
  if (order[0] == "publish" && order.size() == 4) {
    const storage::RevisionKey key{RobotId(order[1]), static_cast<int>(NumberOf(order[2]))};
    const LogAbout about({.robot = order[1]});
    RIGCAL_ASSIGN(const std::filesystem::path folder, Publish(place.store, key, place.clock, order[3]));
    return folder.string();
  }
  return Fail(ErrorCode::kInternal, "a worker was told " + Quoted(order[0]), "Report this with the log of the server.");
}

// The lease that stands before an order, taken from it.
std::optional<storage::Lease> TakeLeaseFrom(Fields& order) {
  constexpr int kLeaseFields = 4;
  if (order[0] != "leased" || order.size() <= kLeaseFields) return std::nullopt;
  const storage::Lease lease{RobotId(order[3]), order[1], NumberOf(order[2])};
  order.erase(order.begin(), order.begin() + kLeaseFields);
  return lease;
}

Fields AnswerTo(const WorkPlace& place, Fields order) {
  const auto lease = TakeLeaseFrom(order);
  std::optional<storage::Fenced> fenced;
  if (lease) fenced.emplace(place.store, *lease);
  const Result<std::string> done = Guarded([&] { return CarryOutOrder(place, order); });
  if (done) return {"done", *done};
  return {"failed", std::to_string(static_cast<int>(done.error().code)), done.error().what, done.error().cure};
}

// The system ends this process before the server where memory runs out; and it cannot take all of it.
void LimitItself() {
  rlimit limit{};
  if (getrlimit(RLIMIT_DATA, &limit) == 0) {
    const rlim_t stacks = rlim_t{8} << 20;  // of each thread, counted whole
    const auto most = static_cast<rlim_t>(MemoryOfProcess() / 8 * 7) + std::thread::hardware_concurrency() * stacks;
    limit.rlim_cur = std::min(limit.rlim_cur, most);
    setrlimit(RLIMIT_DATA, &limit);
  }
  if (const int file = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC); file >= 0) {
    if (write(file, "500", 3) != 3) LogWarn("/proc/self/oom_score_adj takes nothing");
    close(file);
  }
}

}  // namespace

std::vector<std::string> WorkerFields(const std::string& line) {
  std::vector<std::string> fields;
  std::size_t begin = 0;
  for (std::size_t end = 0; end != std::string::npos; begin = end + 1) {
    end = line.find('\t', begin);
    fields.push_back(line.substr(begin, end == std::string::npos ? end : end - begin));
  }
  return fields;
}

std::string JobOrder(const storage::JobRow& job) {
  return LineOf({"job", std::to_string(job.number), job.robot.str(), job.session.str(), job.pair.a.str(),
                 job.pair.b.str(), std::to_string(job.attempts)});
}
std::string RefineOrder(const RobotId& robot) { return LineOf({"refine", robot.str()}); }
std::string RecomputeOrder(std::int64_t item_number) { return LineOf({"recompute", std::to_string(item_number)}); }
std::string LeasedOrder(const storage::Lease& lease, const std::string& order) {
  return LineOf({"leased", lease.owner, std::to_string(lease.token), lease.robot.str()}) + "\t" + order;
}
std::string PublishOrder(const storage::RevisionKey& key, const std::string& why_no_clouds) {
  return LineOf({"publish", key.robot.str(), std::to_string(key.number), why_no_clouds});
}

int Work(const storage::StorePlace& place, const Clock& clock) {
  LimitItself();
  SetThreadRank(ThreadRank::kWorks);
  static Line line(dup(STDOUT_FILENO));  // outlives the thread that listens
  dup2(STDERR_FILENO, STDOUT_FILENO);
  metrics::NoteElsewhere([](const metrics::StageRun& run) {
    line.Say({"spent", metrics::NameOf(run.stage), std::to_string(run.took_s), run.failed ? "failed" : "done"});
  });
  OnLoggedError([](ErrorCode kind) { line.Say({"erred", NameOf(kind)}); });
  DecodingBudget().AskElsewhere([](std::int64_t bytes) { return line.TakeMemory(bytes); });
  std::thread([] { Listen(line); }).detach();
  auto store = storage::Store::Open(place);
  calib::CameraMemory cameras;
  while (true) {
    const Fields order = line.NextOrder();
    line.Say({"begun"});
    if (!store) store = storage::Store::Open(place);
    if (!store)
      line.Say(
          {"failed", std::to_string(static_cast<int>(store.error().code)), store.error().what, store.error().cure});
    else
      line.Say(AnswerTo({*store, clock, cameras}, order));
  }
}

}  // namespace rigcal::pipeline
