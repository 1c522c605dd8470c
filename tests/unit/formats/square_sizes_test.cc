#include "server/formats/boards/square_sizes.h"

#include <gtest/gtest.h>

namespace rigcal::formats {
namespace {

TEST(SquareSizes, ReadBackAsTheyWereWritten) {
  const SquareSizes sizes = {{TargetId("wall"), {0.1 / 3.0, 0.0}}, {TargetId("board"), {0.02475, 1.5e-5}}};
  const std::string text = WriteSquareSizes(sizes);
  EXPECT_EQ(text.find("board"), 2U) << "sorted: " << text;
  EXPECT_EQ(ReadSquareSizes(text).value(), sizes);
  EXPECT_EQ(WriteSquareSizes({}), "");
  EXPECT_TRUE(ReadSquareSizes("").value().empty());
}

TEST(SquareSizes, RefuseWhatIsNoSize) {
  EXPECT_FALSE(ReadSquareSizes("{"));
  EXPECT_FALSE(ReadSquareSizes(R"({"board":{"square_m":0.025}})"));
  EXPECT_FALSE(ReadSquareSizes(R"({"board":{"square_m":0,"square_sigma_m":0}})"));
  EXPECT_FALSE(ReadSquareSizes(R"({"board":{"square_m":0.025,"square_sigma_m":-1}})"));
}

}  // namespace
}  // namespace rigcal::formats
