#include <gmock/gmock.h>

#include <array>
#include <cstdlib>

#include "idl/dds.h"
#include "server/reload.h"
#include "tests/unit/temp_folder.h"

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

TEST(SettingsTest, WhetherThereIsAnIdentityIsSettledAtTheStart) {
  const TempFolder folder;
  const std::filesystem::path place = folder.path() / "dds";
  std::filesystem::create_directory(place);
  setenv("RIGCAL_DDS_IDENTITY", ("-" + place.string()).c_str(), 1);
  const std::array words = {"rigcald"};
  Config config;
  ASSERT_EQ(Settings(1, words.data()).Read(config), std::nullopt);
  EXPECT_EQ(config.participant.identity, place);
  EXPECT_EQ(getenv("RIGCAL_DDS_IDENTITY"), nullptr);
  std::filesystem::remove(place);
  config.participant.domain = 229;
  EXPECT_FALSE(wire::Participant::Open(config.participant)) << "it would speak without an identity";
}

}  // namespace
}  // namespace rigcal
