#include "client/ask/checks.h"

#include <gtest/gtest.h>

namespace rigcal::client {
namespace {

constexpr std::int64_t kMs_ns = 1'000'000;

// Each check that is not good says what to do; a good one says nothing more.
void ExpectLevel(const Check& check, CheckLevel level) {
  EXPECT_EQ(check.level, level) << check.name << ": " << check.text;
  EXPECT_EQ(check.cure.empty(), level == CheckLevel::kOk) << check.name;
  EXPECT_FALSE(check.text.empty());
}

TEST(Checks, Interfaces) {
  const NetworkInterface lo{"lo", "127.0.0.1", true, false}, eth{"eth0", "10.0.0.2", false, true};
  const NetworkInterface no_multicast{"wg0", "10.1.0.2", false, false};
  ExpectLevel(JudgeInterfaces({lo, eth}), CheckLevel::kOk);
  ExpectLevel(JudgeInterfaces({lo}), CheckLevel::kWarn);
  ExpectLevel(JudgeInterfaces({lo, no_multicast}), CheckLevel::kWarn);
  ExpectLevel(JudgeInterfaces({}), CheckLevel::kFail);
  EXPECT_NE(JudgeInterfaces({lo, eth}).text.find("eth0 10.0.0.2 (multicast)"), std::string::npos);
}

TEST(Checks, ReceiveBuffer) {
  ExpectLevel(JudgeReceiveBuffer(4 << 20), CheckLevel::kOk);
  ExpectLevel(JudgeReceiveBuffer(212'992), CheckLevel::kWarn);
  ExpectLevel(JudgeReceiveBuffer(std::nullopt), CheckLevel::kWarn);
}

TEST(Checks, Versions) {
  ExpectLevel(JudgeVersions("0.1.0", 1, "0.1.0", 1), CheckLevel::kOk);
  ExpectLevel(JudgeVersions("0.1.0", 1, "0.1.1", 1), CheckLevel::kWarn);
  ExpectLevel(JudgeVersions("0.1.0", 1, "0.1.0", 2), CheckLevel::kFail);
  ExpectLevel(JudgeVersions("0.1.0", 1, "?", std::nullopt), CheckLevel::kFail);
}

TEST(Checks, ClockSaysWhichWay) {
  ExpectLevel(JudgeClock(3 * kMs_ns, 2 * kMs_ns), CheckLevel::kOk);
  const Check ahead = JudgeClock(5000 * kMs_ns, 2 * kMs_ns), behind = JudgeClock(-5000 * kMs_ns, 2 * kMs_ns);
  ExpectLevel(ahead, CheckLevel::kWarn);
  ExpectLevel(behind, CheckLevel::kWarn);
  EXPECT_NE(ahead.text.find("5000.0 ms ahead"), std::string::npos);
  EXPECT_NE(behind.text.find("5000.0 ms behind"), std::string::npos);
  // A slow network must not be taken for a wrong clock.
  ExpectLevel(JudgeClock(900 * kMs_ns, 2000 * kMs_ns), CheckLevel::kOk);
}

TEST(Checks, DiskAndRoundTrip) {
  ExpectLevel(JudgeDisk("disk here", 50'000'000'000), CheckLevel::kOk);
  ExpectLevel(JudgeDisk("disk here", 5'000'000'000), CheckLevel::kWarn);
  ExpectLevel(JudgeDisk("disk here", 500'000'000), CheckLevel::kFail);
  ExpectLevel(JudgeDisk("disk here", std::nullopt), CheckLevel::kWarn);
  ExpectLevel(JudgeRoundTrip(2 * kMs_ns), CheckLevel::kOk);
  ExpectLevel(JudgeRoundTrip(200 * kMs_ns), CheckLevel::kWarn);
}

TEST(Checks, LostFiles) {
  ExpectLevel(JudgeLostFiles(0, {}), CheckLevel::kOk);
  const Check check = JudgeLostFiles(3, {"mapper-01 left/01.png (damaged)", "mapper-01 left/02.png (missing)"});
  ExpectLevel(check, CheckLevel::kFail);
  EXPECT_NE(
      check.text.find("3 are not as pushed: mapper-01 left/01.png (damaged), mapper-01 left/02.png (missing), ..."),
      std::string::npos);
}

TEST(Checks, ThisMachineHasAnInterface) {
  for (const NetworkInterface& one : ListInterfaces()) {
    EXPECT_FALSE(one.name.empty());
    EXPECT_NE(one.address, "?");
  }
}

}  // namespace
}  // namespace rigcal::client
