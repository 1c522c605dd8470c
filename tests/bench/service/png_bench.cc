// What encoding a raw grey picture as PNG alone can do, as `rigcal import` encodes it. Prints one JSON object.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <span>

#include "client/import/files.h"
#include "server/base/files/durable_file.h"
#include "server/base/process/parallel_for.h"

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: png_bench PIXELS WIDTH HEIGHT COUNT\n");
    return 2;
  }
  rigcal::bags::Image image;
  image.encoding = "mono8";
  image.width_px = std::atoi(argv[2]);
  image.height_px = std::atoi(argv[3]);
  image.step_bytes = image.width_px;
  const auto size = static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px);
  const auto count = static_cast<std::size_t>(std::atoi(argv[4]));
  const auto pixels = rigcal::ReadFile(argv[1], size);
  if (!pixels || pixels->size() != size) {
    std::fprintf(stderr, "%s: cannot be read, or has no %zu bytes\n", argv[1], size);
    return 1;
  }
  image.data = std::as_bytes(std::span(*pixels));
  const auto start = std::chrono::steady_clock::now();
  std::vector<std::size_t> packed(count);
  rigcal::ParallelFor(count, [&](std::size_t i) {
    const auto png = rigcal::importing::PngOf(image);
    packed[i] = png ? png->size() : 0;
  });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (const std::size_t bytes : packed)
    if (bytes == 0) return 1;
  std::printf("{\"bytes_per_s\": %.1f, \"packed_bytes\": %zu, \"seconds\": %.6f}\n",
              static_cast<double>(size * count) / seconds, packed.empty() ? 0 : packed[0], seconds);
  return 0;
}
