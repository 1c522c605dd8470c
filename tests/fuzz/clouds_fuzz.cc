#include <array>

#include "server/formats/clouds/cloud.h"
#include "tests/fuzz/fuzz.h"

using namespace rigcal;

namespace {

void Check(const Cloud& cloud) {
  fuzz::Require(!cloud.points_m.empty(), "a cloud has points");
  for (const Eigen::Vector3f& point : cloud.points_m) {
    fuzz::RequireFinite(point, "point");
    fuzz::Require(point.cwiseAbs().maxCoeff() <= 1e5f, "a point is within 100 km");
  }
  for (const CloudField& field : cloud.fields) {
    fuzz::Require(field.values.size() == cloud.points_m.size(), "a field has a value per point");
    for (const double value : field.values) fuzz::Require(std::isfinite(value), "a field's value is finite");
  }
}

}  // namespace

// The first byte chooses the format, and of a .bin whether its layout is given.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array kSuffixes = {"pcd", "ply", "bin"};
  fuzz::Input input(data, size);
  const auto choice = input.Number<std::uint8_t>();
  const char* suffix = kSuffixes[choice % kSuffixes.size()];
  std::optional<CloudLayout> layout;
  if (choice < 128) layout = KittiLayout();
  const auto cloud = formats::ReadCloud(std::as_bytes(std::span(input.rest())), suffix, "top/01", layout);
  if (fuzz::RequireGoodError(cloud)) Check(*cloud);
  return 0;
}
