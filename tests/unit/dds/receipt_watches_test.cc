// Receipts for those who push by another way than DDS.
#include "server/dds/tell/receipt_watches.h"

#include <gtest/gtest.h>

#include <thread>

namespace rigcal::dds {
namespace {

using std::chrono::seconds;
using std::chrono::steady_clock;

wire::Receipt ReceiptFor(const std::string& subject, std::vector<bool> held) {
  wire::Receipt receipt;
  receipt.robot = RobotId("r");
  receipt.subject_id = subject;
  receipt.held = std::move(held);
  return receipt;
}

bool AllHeld(const wire::Receipt& receipt) {
  return std::find(receipt.held.begin(), receipt.held.end(), false) == receipt.held.end();
}

TEST(ReceiptWatches, HearTheirOwnSubjectFromThenOn) {
  ReceiptWatches watches;
  EXPECT_FALSE(watches.Note(ReceiptFor("a", {true}))) << "nobody waits";
  ReceiptWatches::Watch watch(watches, "a");
  EXPECT_FALSE(watches.Note(ReceiptFor("b", {true})));
  EXPECT_FALSE(watch.Await(AllHeld, steady_clock::now())) << "none came since";
  EXPECT_TRUE(watches.Note(ReceiptFor("a", {true})));
  EXPECT_TRUE(watch.Await(AllHeld, steady_clock::now()));
  EXPECT_FALSE(watch.Await(AllHeld, steady_clock::now())) << "it was looked at";
}

TEST(ReceiptWatches, WaitForOneThatIsEnough) {
  ReceiptWatches watches;
  ReceiptWatches::Watch watch(watches, "a"), other(watches, "a");
  std::thread sends([&] {
    watches.Note(ReceiptFor("a", {true, false}));
    watches.Note(ReceiptFor("a", {true, true}));
  });
  for (ReceiptWatches::Watch* one : {&watch, &other}) {
    const auto receipt = one->Await(AllHeld, steady_clock::now() + seconds(60));
    ASSERT_TRUE(receipt);
    EXPECT_EQ(receipt->held, (std::vector<bool>{true, true}));
  }
  sends.join();
}

TEST(ReceiptWatches, EndWithWhoWatches) {
  ReceiptWatches watches;
  { const ReceiptWatches::Watch watch(watches, "a"); }
  EXPECT_FALSE(watches.Note(ReceiptFor("a", {true})));
}

}  // namespace
}  // namespace rigcal::dds
