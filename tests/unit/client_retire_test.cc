// `rigcal retire`: an order that takes an edge out for good.
#include <gtest/gtest.h>

#include "client_run.h"

namespace rigcal::client {
namespace {

TEST(Retire, AnEdgeNeedsAReason) {
  const std::string done =
      R"({"robot":"r1","edge":{"id":"cccccccccccccccccccc","frame_a":"a","frame_b":"b","diagnoses":[{"code":"retired",)"
      R"("what":"retired by Ada on 2026-02-01: typed wrong","cure":"Nothing"}]},"standing":{"number":9}})";
  FakeServer server("r1", Always(done));
  EXPECT_EQ(Rigcal({"retire", "cccccccc"}).code, 2);
  EXPECT_EQ(server.requests_seen, 0);
  const Ran ran = Rigcal({"retire", "cccccccc", "--reason", "typed wrong", "--no-wait"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(
      ran.out,
      "Edge cccccccccccccccc of r1, a - b, does not count any more: retired by Ada on 2026-02-01: typed wrong.\n");
}

}  // namespace
}  // namespace rigcal::client
