#include "server/base/process/service_manager.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>

#include "server/base/files/file_descriptor.h"
#include "server/base/stamp.h"
#include "tests/unit/temp_folder.h"

namespace rigcal {
namespace {

// As systemd listens.
class ServiceManagerTest : public ::testing::Test {
 protected:
  ServiceManagerTest() : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    const std::string name = (folder_.path() / "manager").string();
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, name.c_str(), name.size());
    EXPECT_EQ(bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    setenv("NOTIFY_SOCKET", name.c_str(), 1);
  }
  ~ServiceManagerTest() override {
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
    unsetenv("WATCHDOG_PID");
  }
  // Empty: nothing was told.
  std::string Told() {
    std::array<char, 256> text{};
    const ssize_t size = recv(socket_.get(), text.data(), text.size(), 0);
    return {text.data(), size < 0 ? 0 : static_cast<std::size_t>(size)};
  }

  TempFolder folder_;
  FileDescriptor socket_;
};

TEST_F(ServiceManagerTest, HearsWhatIsTold) {
  TellServiceManager("READY=1");
  EXPECT_EQ(Told(), "READY=1");
}

TEST_F(ServiceManagerTest, HearsNothingWhereNobodyListens) {
  unsetenv("NOTIFY_SOCKET");
  TellServiceManager("READY=1");
  EXPECT_EQ(Told(), "");
}

TEST_F(ServiceManagerTest, HearsThatItLivesWhileNothingStandsStill) {
  setenv("WATCHDOG_USEC", "2", 1);
  Watchdog watchdog;
  EXPECT_EQ(Told(), "WATCHDOG_USEC=2\nWATCHDOG=1");
  Vitals vitals(SystemClock());
  watchdog.Turn(vitals);
  EXPECT_EQ(Told(), "WATCHDOG=1");
  static_cast<void>(vitals.Expect("a thread that stands still", std::chrono::milliseconds(-1)));
  watchdog.Turn(vitals);
  EXPECT_EQ(Told(), "");
}

TEST_F(ServiceManagerTest, WantsToHearNothingOfAnotherProcess) {
  setenv("WATCHDOG_USEC", "2", 1);
  setenv("WATCHDOG_PID", "1", 1);
  Watchdog watchdog;
  watchdog.Turn(Vitals(SystemClock()));
  EXPECT_EQ(Told(), "");
}

}  // namespace
}  // namespace rigcal
