// A row as a database keeps it, whatever it says. For storage/*.cc only.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace rigcal::storage {

struct Blob {
  std::string bytes;
  bool operator==(const Blob&) const = default;
};

using StoredCell = std::variant<std::monostate, std::int64_t, double, std::string, Blob>;  // the first: NULL
using StoredRow = std::vector<StoredCell>;

}  // namespace rigcal::storage
