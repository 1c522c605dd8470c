// Preloaded (LD_PRELOAD) into a program of ours: takes the place of C++'s operator new, which throws std::bad_alloc
// where the plan says so (planned_failure.h): "memory" counts every allocation, "large" those of 16 KiB or more.
// What C libraries allocate does not fail: Cyclone DDS ends the process then.
#include <cstddef>
#include <cstdlib>
#include <new>

#include "tests/fault/planned_failure.h"

namespace rigcal::fault {
namespace {

constexpr std::size_t kLargeBytes = 16 << 10;

void* Allocate(std::size_t size_bytes, std::size_t alignment_bytes) {
  if (FailsInRow("memory") || (size_bytes >= kLargeBytes && FailsInRow("large"))) return nullptr;
  const std::size_t wanted_bytes = size_bytes == 0 ? 1 : size_bytes;
  if (alignment_bytes <= alignof(std::max_align_t)) return std::malloc(wanted_bytes);
  return std::aligned_alloc(alignment_bytes, (wanted_bytes + alignment_bytes - 1) / alignment_bytes * alignment_bytes);
}

// As the standard wants it: whoever set a handler has its say.
void* AllocateOrThrow(std::size_t size_bytes, std::size_t alignment_bytes) {
  while (true) {
    if (void* const memory = Allocate(size_bytes, alignment_bytes)) return memory;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

}  // namespace
}  // namespace rigcal::fault

using rigcal::fault::Allocate;
using rigcal::fault::AllocateOrThrow;

// The forms for arrays call these.
void* operator new(std::size_t size_bytes) { return AllocateOrThrow(size_bytes, 0); }
void* operator new(std::size_t size_bytes, const std::nothrow_t&) noexcept { return Allocate(size_bytes, 0); }
void* operator new(std::size_t size_bytes, std::align_val_t alignment) {
  return AllocateOrThrow(size_bytes, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size_bytes, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return Allocate(size_bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
