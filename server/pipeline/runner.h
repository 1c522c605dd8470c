// The job runner: threads that loop over Step(), and one more of them that takes no jobs, so that robots get their
// revisions and reports while jobs hold all others. Owns its threads and one Store per thread.
#pragma once

#include <filesystem>
#include <memory>

#include "server/base/process/vitals.h"
#include "server/pipeline/step.h"

namespace rigcal::pipeline {

class Runner {
 public:
  struct Options {
    storage::StorePlace place;
    const Clock* clock = nullptr;
    int threads = 2;                    // that take jobs; 0: none at all
    Vitals* vitals = nullptr;           // told how the threads are; none: nobody asks
    UndrawnReports* undrawn = nullptr;  // likewise
    std::vector<std::string> worker;    // program and arguments that Work(); none: the threads do all work themselves
    std::string owner;  // what this process is called among those that share the store; empty: it has it for itself
  };
  // Opens a store per thread, notes what the last run left open (of a shared store, what the last owner of each robot
  // did), and begins to work. Errors are the store's.
  [[nodiscard]] static Result<Runner> Start(const Options& options, Announcer announcer);
  ~Runner();  // finishes the step at hand, then joins; unfinished work is found again at the next start
  // A runner that was moved from does nothing: the other goes on.
  Runner(Runner&&) noexcept;
  Runner& operator=(Runner&&) noexcept;
  // There may be work. Any thread; never blocks.
  void Wake();

 private:
  struct Impl;
  explicit Runner(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigcal::pipeline
