#include "client/bags/mcap/mcap_bag.h"
#include "tests/fuzz/bag_checks.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rigcal::fuzz::CheckBag(rigcal::bags::OpenMcap(rigcal::bags::SourceOf(std::as_bytes(std::span(data, size)), "bag")));
  return 0;
}
