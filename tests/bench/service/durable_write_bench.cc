// Plain durable writes: what the disk alone can do with payloads of one size. Prints one JSON object.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "server/base/files/durable_file.h"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: durable_write_bench FOLDER BYTES COUNT\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  const auto bytes = static_cast<std::size_t>(std::atoll(argv[2]));
  const int count = std::atoi(argv[3]);
  std::string payload(bytes, '\0');
  unsigned state = 1;
  for (char& c : payload) c = static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < count; ++i)
    if (const auto ok = rigcal::WriteDurably(folder / std::to_string(i), payload); !ok) {
      std::fprintf(stderr, "%s\n", rigcal::Sentence(ok.error()).c_str());
      return 1;
    }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("{\"bytes_per_s\": %.1f, \"count\": %d, \"seconds\": %.6f}\n",
              static_cast<double>(bytes) * count / seconds, count, seconds);
  return 0;
}
