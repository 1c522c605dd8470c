#include "client/programs/interrupt.h"

#include <gtest/gtest.h>

#include <csignal>

namespace rigcal::client {
namespace {

TEST(InterruptWatch, GivesSignalsBackAsTheyWere) {
  struct sigaction ignored {
  }, before{}, after{};
  ignored.sa_handler = SIG_IGN;
  ASSERT_EQ(sigaction(SIGTERM, &ignored, &before), 0);
  {
    const InterruptWatch watch;
    EXPECT_FALSE(InterruptWatch::Came());
    std::raise(SIGTERM);
    EXPECT_TRUE(InterruptWatch::Came());
  }
  sigaction(SIGTERM, &before, &after);
  EXPECT_EQ(after.sa_handler, SIG_IGN);
}

}  // namespace
}  // namespace rigcal::client
