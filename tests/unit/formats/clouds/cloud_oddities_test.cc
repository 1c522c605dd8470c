// Points that cannot be: named with their number and what it means; refused where nothing is left.
#include "server/formats/clouds/cloud_oddities.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/unit/formats/clouds/cloud_samples.h"

namespace rigcal::formats {
namespace {

using testing::HasSubstr;

struct Mix {
  int good = 0, far = 0, nan = 0, zero = 0, same = 0;
};

Result<Cloud> CloudOf(const Mix& mix, float scale = 1) {
  std::string bytes;
  const auto add = [&](int count, auto... xyz) {
    for (int i = 0; i < count; ++i) bytes += Floats(xyz...);
  };
  for (int i = 0; i < mix.good; ++i) bytes += Floats(scale * 0.01 * i, scale * (5 + std::sin(0.1 * i)), scale * 1.0);
  add(mix.far, 5000, 2, 1);
  add(mix.nan, NAN, NAN, NAN);
  add(mix.zero, 0, 0, 0);
  add(mix.same, 0.0002, 3.0001, 1);
  const int all = mix.good + mix.far + mix.nan + mix.zero + mix.same;
  return ReadText(XyzPcd(all) + "DATA binary\n" + bytes, "pcd");
}

std::string Told(const Mix& mix) {
  const auto cloud = CloudOf(mix);
  return cloud ? OdditiesOf(*cloud) : "refused: " + cloud.error().what;
}

TEST(CloudOddities, WhatIsUsualIsNotNamed) {
  EXPECT_EQ(Told({.good = 1000}), "");
  EXPECT_EQ(Told({.good = 600, .nan = 400}), "");  // an organised cloud
  EXPECT_EQ(Told({.good = 600, .zero = 400}), "");
  EXPECT_EQ(Told({.good = 1}), "");
}

TEST(CloudOddities, AreCountedAndExplained) {
  EXPECT_THAT(Told({.good = 997, .far = 3}),
              HasSubstr("3 of 1000 points lie beyond 1 km and are left out: the unit is not metres"));
  EXPECT_THAT(Told({.good = 400, .nan = 600}), HasSubstr("600 of 1000 points have no finite coordinates"));
  EXPECT_THAT(Told({.good = 120, .zero = 1880}),
              HasSubstr("1880 of 2000 points are at 0, 0, 0: beams without a return"));
  EXPECT_THAT(Told({.good = 120, .same = 1880}), HasSubstr("1880 of 2000 points lie within 1 mm of one place"));
}

TEST(CloudOddities, WithoutASceneItIsRefused) {
  EXPECT_THAT(Told({.good = 20, .same = 1980}),
              HasSubstr("refused: file \"top/01.pcd\": 1980 of 2000 points lie within 1 mm"));
  EXPECT_THAT(Told({.good = 20, .zero = 1980}),
              HasSubstr("refused: file \"top/01.pcd\": 1980 of 2000 points are at 0, 0, 0"));
  EXPECT_THAT(Told({.far = 1000}),
              HasSubstr("refused: file \"top/01.pcd\": of its points 1000 lie beyond 1 km, and none within"));
  EXPECT_THAT(CloudOf({.good = 1000}, 1e-5F).error().what, HasSubstr("within 1 mm"));  // kilometres, say, or worse
}

}  // namespace
}  // namespace rigcal::formats
