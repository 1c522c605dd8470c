#include "server/dds/record/part_file.h"

#include <gtest/gtest.h>

#include "server/base/files/durable_file.h"
#include "tests/unit/dds/fixture.h"

namespace rigcal::dds {
namespace {

class PartFileTest : public testing::Test {
 protected:
  std::string OnDisk() { return *ReadFile(path_, 1 << 20); }
  TempFolder folder_;
  std::filesystem::path path_ = folder_.path() / "0.part";
  const std::string bytes_ = RandomBytes(10'000, 3);
};

TEST_F(PartFileTest, TakesPiecesInAnyOrderAndTwice) {
  PartFile part(path_, bytes_.size());
  part.Add(7'000, bytes_.substr(7'000));
  ASSERT_TRUE(part.Flush());
  part.Add(2'000, bytes_.substr(2'000, 5'500));  // overlaps
  part.Add(0, bytes_.substr(0, 1'000));
  ASSERT_TRUE(part.Flush());
  EXPECT_FALSE(part.Complete());
  part.Add(0, bytes_.substr(0, 3'000));
  EXPECT_FALSE(part.Complete());  // not on disk yet
  ASSERT_TRUE(part.Flush());
  ASSERT_TRUE(part.Complete());
  EXPECT_EQ(*part.Hash(), Sha256Of(std::string_view(bytes_)));
  EXPECT_EQ(OnDisk(), bytes_);
}

TEST_F(PartFileTest, HashesInOrderWithinOneRound) {
  PartFile part(path_, bytes_.size());
  part.Add(5'000, bytes_.substr(5'000));
  part.Add(0, bytes_.substr(0, 5'000));
  ASSERT_TRUE(part.Flush());
  std::filesystem::remove(path_);  // nothing needs to be read again
  EXPECT_EQ(*part.Hash(), Sha256Of(std::string_view(bytes_)));
}

// Else bytes could be exchanged after they were hashed.
TEST_F(PartFileTest, NeverWritesTheSameByteTwice) {
  PartFile part(path_, bytes_.size());
  part.Add(0, bytes_.substr(0, 9'000));
  ASSERT_TRUE(part.Flush());
  std::string other = bytes_;
  for (char& c : other) c = static_cast<char>(~c);
  part.Add(0, other.substr(0, 9'000));
  part.Add(8'000, other.substr(8'000, 1'000) + bytes_.substr(9'000));
  ASSERT_TRUE(part.Flush());
  EXPECT_EQ(*part.Hash(), Sha256Of(std::string_view(bytes_)));
  EXPECT_EQ(OnDisk(), bytes_);
}

TEST_F(PartFileTest, NamesTheFileItCannotWrite) {
  PartFile part(folder_.path() / "missing" / "0.part", 10);
  part.Add(0, "0123456789");
  const Status status = part.Flush();
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("0.part"), std::string::npos);
}

TEST_F(PartFileTest, KnowsAShatteredTransfer) {
  PartFile part(path_, 100'000);
  for (std::uint64_t at = 0; at < 20'000; at += 2) part.Add(at, "x");
  ASSERT_TRUE(part.Flush());
  EXPECT_TRUE(part.Shattered());
}

}  // namespace
}  // namespace rigcal::dds
