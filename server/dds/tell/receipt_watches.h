// Receipts for those who push by another way than DDS: they wait here for what the recorder says.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "idl/convert.h"

namespace rigcal::dds {

// Any thread.
class ReceiptWatches {
 public:
  // Hears the receipts of one session or batch that are sent from now on. `watches` outlives it.
  class Watch {
   public:
    Watch(ReceiptWatches& watches, std::string subject_id);
    ~Watch();
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;
    // The first receipt, of those that came since the last call, for which `is_enough` holds; of several that came
    // meanwhile the newest is looked at alone. Nothing where none came in time.
    [[nodiscard]] std::optional<wire::Receipt> Await(const std::function<bool(const wire::Receipt&)>& is_enough,
                                                     std::chrono::steady_clock::time_point until);

   private:
    ReceiptWatches& watches_;
    const std::string subject_id_;
    std::uint64_t seen_ = 0;
  };

  // One that is sent. Whether somebody here waits for it.
  bool Note(const wire::Receipt& receipt);

 private:
  struct Heard {
    int watches = 0;
    std::uint64_t count = 0;  // of receipts
    wire::Receipt newest;
  };
  std::mutex mutex_;
  std::condition_variable came_;
  std::map<std::string, Heard> by_subject_;  // those that are watched
};

}  // namespace rigcal::dds
