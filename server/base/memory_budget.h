// So many bytes for all threads together: who would take more waits until others have given theirs back.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>

namespace rigcal {

class MemoryBudget {
 public:
  // The limit stays where it is: it may be set until the first share is taken.
  explicit MemoryBudget(const std::int64_t* bytes_max) : bytes_max_(bytes_max) {}

  // Gives its bytes back when it goes.
  class Share {
   public:
    Share(MemoryBudget* budget, std::int64_t bytes) : budget_(budget), bytes_(bytes) {}
    ~Share();
    Share(Share&& other) noexcept;
    Share& operator=(Share&&) = delete;

   private:
    MemoryBudget* budget_;
    std::int64_t bytes_;
  };
  // Waits; first come, first served. Nothing if it is more than there ever is. A thread takes all that a piece of work
  // needs in one go: one that holds a share and waits for another may wait for ever.
  [[nodiscard]] std::optional<Share> Take(std::int64_t bytes);

 private:
  const std::int64_t* bytes_max_;
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
