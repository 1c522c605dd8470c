// A driver's camera info that is another in the middle of a bag.
#include <gtest/gtest.h>

#include "client/import/topic_tally.h"

namespace rigcal::importing {
namespace {

bags::CameraInfo InfoAt(std::int64_t stamp_ns, double fx_px) {
  bags::CameraInfo info;
  info.header.stamp_ns = stamp_ns;
  info.width_px = 640, info.height_px = 480;
  info.distortion_model = "plumb_bob";
  info.distortion = {0.1, 0, 0, 0, 0};
  info.fx_px = fx_px, info.fy_px = 500, info.cx_px = 320, info.cy_px = 240;
  return info;
}

constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;

TEST(CameraInfoWatch, TellsWhenItChangesAndWhat) {
  CameraInfoWatch watch;
  watch.Add(InfoAt(kStart_ns, 500), 0);
  watch.Add(InfoAt(kStart_ns + 5, 500), 0);
  EXPECT_EQ(watch.Change(), "");
  bags::CameraInfo other = InfoAt(kStart_ns + 7, 600.5);
  other.width_px = 320, other.distortion[0] = 0.2;
  watch.Add(other, 0);
  const std::string once = watch.Change();
  EXPECT_EQ(once,
            "changes at 2023-11-14T22:13:20.000000007Z (stamp 1700000000.000000007): 640 x 480 to 320 x 480, "
            "fx 500 to 600.5, another distortion");
  watch.Add(InfoAt(kStart_ns + 9, 500), 0);
  EXPECT_EQ(watch.Change(), once + ", and once more");
  watch.Add(other, 0);
  EXPECT_EQ(watch.Change(), once + ", and 2 times more");
}

TEST(CameraInfoWatch, WithoutAStampTakesTheRecordersTime) {
  CameraInfoWatch watch;
  watch.Add(InfoAt(0, 500), kStart_ns);
  watch.Add(InfoAt(0, 501), kStart_ns + 1);
  EXPECT_EQ(watch.Change(), "changes at 2023-11-14T22:13:20.000000001Z (stamp 1700000000.000000001): fx 500 to 501");
}

}  // namespace
}  // namespace rigcal::importing
