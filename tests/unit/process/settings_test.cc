#include <gmock/gmock.h>

#include "server/reload.h"

namespace rigcal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(SettingsTest, NothingChangesInTheSame) {
  const SettingsChange change = CompareSettings({}, {}, {}, {});
  EXPECT_THAT(change.at_once, IsEmpty());
  EXPECT_THAT(change.at_restart, IsEmpty());
}

TEST(SettingsTest, TellsWhatHoldsAtOnceFromWhatNeedsARestart) {
  Config read;
  read.verbose = true;
  read.http_names = {"rigs.example.org"};
  read.threads = 3;
  read.webhooks = {"https://alerts.example.org"};
  limits::Limits limits;
  limits.reports_of_robot = 5;
  limits.decoded_bytes = 1 << 30;
  const SettingsChange change = CompareSettings({}, {}, read, limits);
  EXPECT_THAT(change.at_once, ElementsAre("--verbose", "--http-name", "limit reports_of_robot = 5"));
  EXPECT_THAT(change.at_restart, ElementsAre("--threads", "--webhook", "limit decoded_bytes = 1073741824"));
}

TEST(SettingsTest, OfLimitsOnlyThoseThatMayChangeDo) {
  limits::Limits read;
  read.open_sessions = 3;
  read.http_connections = 5;
  read.image_pixels = 7;
  const limits::Limits now = WithThoseThatMayChange({}, read);
  EXPECT_EQ(now.open_sessions, 3);
  EXPECT_EQ(now.http_connections, limits::Limits().http_connections);
  EXPECT_EQ(now.image_pixels, limits::Limits().image_pixels);
}

}  // namespace
}  // namespace rigcal
