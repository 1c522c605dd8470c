#include "client/bags/ros1_bag.h"
#include "tests/fuzz/bag_checks.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rigcal::fuzz::CheckBag(
      rigcal::bags::OpenRos1Bag(rigcal::bags::SourceOf(std::as_bytes(std::span(data, size)), "bag")));
  return 0;
}
