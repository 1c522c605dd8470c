#include "client/moments/choose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace rigcal::moments {
namespace {

constexpr std::int64_t kMs = 1'000'000;

Sight SightAt(std::int64_t stamp_ns, double x_px) {
  Sight sight;
  sight.stamp_ns = stamp_ns;
  sight.target_idx = 0;
  sight.width_px = 640, sight.height_px = 480;
  sight.m_per_px = 0.002;
  sight.edge_px = 2.0;
  sight.contrast_grey = 150;
  for (int idx = 0; idx < 6; ++idx) {
    sight.corner_idx.push_back(idx);
    sight.corners_px.emplace_back(static_cast<float>(x_px + 20 * idx), 100.0F);
  }
  return sight;
}

// Two cameras at 20 Hz, the second 10 ms later, of a board that is held for a second and moved for a second.
double PlaceAt_px(std::int64_t stamp_ns) {
  const double t_s = static_cast<double>(stamp_ns) * 1e-9, whole = std::floor(t_s / 2), part = t_s / 2 - whole;
  return 50 * (whole + std::max(0.0, 2 * part - 1));
}

struct Pair {
  std::vector<Stream> streams{2};
  std::vector<Moment> moments;
};
Pair HeldAndMoved(std::int64_t seconds) {
  Pair pair;
  for (std::int64_t k = 0; k < 20 * seconds; ++k) {
    for (std::size_t c = 0; c < 2; ++c) {
      const std::int64_t stamp_ns = 50 * kMs * k + 10 * kMs * static_cast<std::int64_t>(c);
      pair.streams[c].stamps_ns.push_back(stamp_ns);
      pair.streams[c].sights.push_back(SightAt(stamp_ns, PlaceAt_px(stamp_ns)));
      pair.streams[c].clock_sigma_ns = 0;
    }
    pair.moments.push_back({50 * kMs * k, {static_cast<std::size_t>(k), static_cast<std::size_t>(k)}});
  }
  return pair;
}

std::size_t CountOf(const Choice& choice, LeftOut why) { return choice.left_out[static_cast<std::size_t>(why)]; }

std::size_t SumOf(const Choice& choice) {
  std::size_t sum = choice.kept.size();
  for (const std::size_t count : choice.left_out) sum += count;
  return sum;
}

TEST(Choose, EachPlaceWhereTheBoardIsHeldGivesOneCapture) {
  const Pair pair = HeldAndMoved(10);
  const Choice choice = Choose(pair.streams, pair.moments, {}, 2);
  EXPECT_EQ(choice.kept.size(), 5U);
  for (const Moment& moment : choice.kept) EXPECT_LT(moment.stamp_ns % (2000 * kMs), 1000 * kMs);
  EXPECT_GT(CountOf(choice, LeftOut::kMoved), 80U);
  EXPECT_GT(CountOf(choice, LeftOut::kSamePlace), 60U);
  EXPECT_NEAR(choice.usual_motion_px, 2.5, 0.1);
  EXPECT_NEAR(choice.usual_motion_m, 0.005, 2e-4);
  EXPECT_LE(choice.worst_kept_px, 0.5);
  EXPECT_EQ(SumOf(choice), choice.moments);
}

TEST(Choose, WhatNeverStandsStillIsLeftOutWithItsFigure) {
  Pair pair = HeldAndMoved(4);
  for (Stream& stream : pair.streams)
    for (Sight& sight : stream.sights) sight = SightAt(sight.stamp_ns, 90e-9 * static_cast<double>(sight.stamp_ns));
  const Choice choice = Choose(pair.streams, pair.moments, {}, 2);
  EXPECT_TRUE(choice.kept.empty());
  EXPECT_NEAR(choice.least_motion_px, 4.5, 0.01);
  EXPECT_EQ(CountOf(choice, LeftOut::kMoved) + CountOf(choice, LeftOut::kMotionUnknown), choice.moments);
}

TEST(Choose, AClockThatIsNotKnownHasToStandStillForLonger) {
  // Held for 0.18 s only, amid a slow motion.
  const auto chosen_with = [](std::optional<std::int64_t> sigma_ns) {
    Pair pair = HeldAndMoved(4);
    for (Stream& stream : pair.streams) {
      stream.clock_sigma_ns = sigma_ns;
      for (Sight& sight : stream.sights) {
        const double since_s = static_cast<double>(sight.stamp_ns - 2'000 * kMs) * 1e-9;
        const double beyond_s = std::max(0.0, std::abs(since_s) - 0.09);
        sight = SightAt(sight.stamp_ns, 40 * std::copysign(beyond_s, since_s));
      }
    }
    return Choose(pair.streams, pair.moments, {}, 2).kept.size();
  };
  EXPECT_EQ(chosen_with(0), 1U);
  EXPECT_EQ(chosen_with(std::nullopt), 0U);
}

// A pair of cameras whose second has something wrong with its pictures all the time.
Choice WithSecond(const std::function<void(Sight&)>& spoil) {
  Pair pair = HeldAndMoved(6);
  std::size_t k = 0;
  for (Sight& sight : pair.streams[1].sights)
    if (k++ % 4 != 0) spoil(sight);  // what is usual is told by the others
  return Choose(pair.streams, pair.moments, {}, 2);
}

TEST(Choose, BlurredAndBadlyExposedPicturesAreNoCapture) {
  EXPECT_GT(CountOf(WithSecond([](Sight& sight) { sight.edge_px = 9.0; }), LeftOut::kBlurred), 30U);
  EXPECT_GT(CountOf(WithSecond([](Sight& sight) { sight.bright_ratio = 0.5; }), LeftOut::kExposure), 30U);
  EXPECT_GT(CountOf(WithSecond([](Sight& sight) { sight.contrast_grey = 12; }), LeftOut::kExposure), 30U);
  EXPECT_GT(CountOf(WithSecond([](Sight& sight) { sight.target_idx = -1; }), LeftOut::kNoBoard), 80U);
}

TEST(Choose, OnePictureThatWillNotDoLeavesTheOthers) {
  Pair pair = HeldAndMoved(6);
  pair.streams.push_back(pair.streams[0]);
  for (Moment& moment : pair.moments) moment.message.push_back(moment.message[0]);
  for (Sight& sight : pair.streams[1].sights) sight.target_idx = -1;
  const Choice choice = Choose(pair.streams, pair.moments, {}, 2);
  ASSERT_EQ(choice.kept.size(), 3U);
  EXPECT_FALSE(choice.kept[0].message[1]);
  EXPECT_TRUE(choice.kept[0].message[0] && choice.kept[0].message[2]);
}

TEST(Choose, PosesThatMoveTellMotionToo) {
  Pair pair = HeldAndMoved(2);
  Stream poses;
  poses.kind = Stream::Kind::kPoses;
  poses.clock_sigma_ns = 0;
  for (std::int64_t k = 0; k < 200; ++k) {
    poses.stamps_ns.push_back(10 * kMs * k);
    poses.places_m.push_back(Eigen::Vector3d(k < 50 ? 0.0 : 0.001 * static_cast<double>(k - 50), 0, 0));
  }
  pair.streams.push_back(poses);
  for (Moment& moment : pair.moments) moment.message.push_back(static_cast<std::size_t>(moment.stamp_ns / (10 * kMs)));
  const Choice choice = Choose(pair.streams, pair.moments, {}, 2);
  ASSERT_EQ(choice.kept.size(), 1U);
  EXPECT_LT(choice.kept[0].stamp_ns, 500 * kMs);
}

TEST(Choose, OneCameraAndAPoseAreACapture) {
  Pair pair = HeldAndMoved(2);
  Stream& poses = pair.streams[1];
  poses.kind = Stream::Kind::kPoses;
  poses.sights.clear();
  poses.places_m.assign(poses.stamps_ns.size(), Eigen::Vector3d::Zero());
  EXPECT_EQ(Choose(pair.streams, pair.moments, {}, 2).kept.size(), 1U);
  for (Moment& moment : pair.moments) moment.message[1].reset();
  EXPECT_TRUE(Choose(pair.streams, pair.moments, {}, 2).kept.empty());
}

TEST(Choose, CapturesAreAsFarApartAsAsked) {
  const Pair pair = HeldAndMoved(10);
  MomentLimits limits;
  limits.every_ns = 3'000 * kMs;
  const Choice choice = Choose(pair.streams, pair.moments, limits, 2);
  EXPECT_EQ(choice.kept.size(), 3U);
  EXPECT_EQ(CountOf(choice, LeftOut::kTooSoon), 2U);
  EXPECT_EQ(SumOf(choice), choice.moments);
}

}  // namespace
}  // namespace rigcal::moments
