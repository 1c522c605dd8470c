// Hand-made clouds as bytes.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "server/formats/clouds/cloud.h"

namespace rigcal::formats {

template <typename T>
std::string Little(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}
template <typename T>
std::string Big(T value) {
  std::string bytes = Little(value);
  std::reverse(bytes.begin(), bytes.end());
  return bytes;
}
template <typename... T>
std::string Floats(T... values) {
  return (Little(static_cast<float>(values)) + ...);
}

// A .bin holds x y z intensity.
inline Result<Cloud> ReadText(const std::string& bytes, std::string_view suffix) {
  return ReadCloud(std::as_bytes(std::span(bytes)), suffix, "top/01." + std::string(suffix), KittiLayout());
}

// "DATA ..." and what follows are up to the caller.
inline std::string PcdHeaderOf(const std::string& fields, const std::string& sizes, const std::string& types,
                               const std::string& counts, int points) {
  const std::string number = std::to_string(points);
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + sizes + "\nTYPE " + types + "\nCOUNT " + counts +
         "\nWIDTH " + number + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + number + "\n";
}
inline std::string XyzPcd(int points) { return PcdHeaderOf("x y z", "4 4 4", "F F F", "1 1 1", points); }

inline std::string PlyHeaderOf(const std::string& format, const std::string& elements) {
  return "ply\nformat " + format + " 1.0\ncomment made by hand\n" + elements + "end_header\n";
}
inline std::string XyzElement(int points) {
  return "element vertex " + std::to_string(points) + "\nproperty float x\nproperty float y\nproperty float z\n";
}

// LZF without any reference: runs of up to 32 bytes, each after its length - 1.
inline std::string Packed(const std::string& plain) {
  std::string packed;
  for (std::size_t at = 0; at < plain.size(); at += 32) {
    const std::string run = plain.substr(at, 32);
    packed += static_cast<char>(run.size() - 1) + run;
  }
  return packed;
}
inline std::string CompressedBody(const std::string& packed, std::size_t plain_bytes) {
  return Little(static_cast<std::uint32_t>(packed.size())) + Little(static_cast<std::uint32_t>(plain_bytes)) + packed;
}

}  // namespace rigcal::formats
