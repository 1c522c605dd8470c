// So many bytes for all threads together: who would take more waits until others have given theirs back.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>

namespace rigcal {

class MemoryBudget {
 public:
  // The limit is asked for at each share: it may be set anew.
  explicit MemoryBudget(std::function<std::int64_t()> bytes_max) : bytes_max_(std::move(bytes_max)) {}

  using GiveBack = std::function<void()>;
  // Gives its bytes back when it goes.
  class Share {
   public:
    // Calls `give_back` once, when it goes; a share that was moved from calls nothing.
    explicit Share(GiveBack give_back) : give_back_(std::move(give_back)) {}
    ~Share();
    // Takes the bytes over.
    Share(Share&& other) noexcept : give_back_(std::exchange(other.give_back_, nullptr)) {}
    Share& operator=(Share&&) = delete;

   private:
    GiveBack give_back_;
  };
  // Waits; first come, first served. Nothing if it is more than there ever is. A thread takes all that a piece of work
  // needs in one go: one that holds a share and waits for another may wait for ever.
  [[nodiscard]] std::optional<Share> Take(std::int64_t bytes);

  // From here on another process keeps the account: `ask` waits until it has set so many bytes aside. Before any thread
  // takes.
  using Ask = std::function<GiveBack(std::int64_t bytes)>;
  // Take() then waits in `ask`, and a share that goes calls what `ask` returned.
  void AskElsewhere(Ask ask) { ask_ = std::move(ask); }

 private:
  void Return(std::int64_t bytes);

  Ask ask_;
  std::function<std::int64_t()> bytes_max_;
  std::mutex mutex_;
  std::condition_variable given_back_;
  std::int64_t taken_bytes_ = 0;              // guarded by mutex_
  std::uint64_t next_number_ = 0, turn_ = 0;  // of those that wait; guarded by mutex_
};

// Of this process, for pictures and clouds while they are decoded: the limit decoded_bytes.
[[nodiscard]] MemoryBudget& DecodingBudget();

// What the process may have: the least of the machine's memory and the limits of its control groups, its data and its
// address space, of that without what stacks and the heaps of threads reserve and never use.
[[nodiscard]] std::int64_t MemoryOfProcess();

}  // namespace rigcal
