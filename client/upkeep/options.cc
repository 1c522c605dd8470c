#include "client/upkeep/options.h"

#include <cstdlib>

#include "client/text/progress.h"
#include "client/wire/transfer.h"

namespace rigcal::client {

std::string DefaultDataFolder() {
  const char* home = std::getenv("HOME");
  return home == nullptr ? "rigcal-data" : std::string(home) + "/.local/share/rigcal";
}

void WithBar(const Context& context, const std::string& label,
             const std::function<void(const std::function<void(std::int64_t, std::int64_t)>&)>& work) {
  Progress bar(context.err, context.err_is_terminal, label, SteadyNow_ns(), Progress::Unit::kFiles);
  work([&](std::int64_t done, std::int64_t total) {
    if (bar.IsDue(SteadyNow_ns())) bar.Show({done, total, ""}, SteadyNow_ns());
  });
  bar.Clear();
}

}  // namespace rigcal::client
