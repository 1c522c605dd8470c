#include "client/sim/rig/random.h"

#include <cmath>

namespace rigcal::sim {
namespace {

std::uint64_t Mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

// FNV-1a: the same for the same name wherever it stands in the rig.
std::uint64_t HashOf(std::string_view text) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3ULL;
  return hash;
}

}  // namespace

std::uint64_t KeyOf(std::uint64_t seed, std::string_view purpose, std::string_view name, std::uint64_t idx) {
  std::uint64_t key = Mixed(seed + 0x9E3779B97F4A7C15ULL);
  for (const std::uint64_t part : {HashOf(purpose), HashOf(name), idx}) key = Mixed(key * 3 + Mixed(part + 1));
  return key;
}

std::uint64_t Random::Bits() { return Mixed(state_ += 0x9E3779B97F4A7C15ULL); }

double Random::Uniform() { return static_cast<double>(Bits() >> 11) * 0x1p-53; }

double Random::Uniform(double low, double high) { return low + (high - low) * Uniform(); }

double Random::Normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform())), angle = 2.0 * M_PI * Uniform();
  spare_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

}  // namespace rigcal::sim
