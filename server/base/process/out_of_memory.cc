#include "server/base/process/out_of_memory.h"

#include <new>
#include <string_view>
#include <system_error>

namespace rigcal {

bool IsOutOfMemory(const std::exception& exception) {
  if (dynamic_cast<const std::bad_alloc*>(&exception) != nullptr) return true;
  if (const auto* failure = dynamic_cast<const std::system_error*>(&exception))
    return failure->code() == std::errc::not_enough_memory ||
           failure->code() == std::errc::resource_unavailable_try_again;
  return std::string_view(exception.what()).find("Insufficient memory") != std::string_view::npos;
}

}  // namespace rigcal
