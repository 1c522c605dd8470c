#include "client/text/table.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

namespace rigcal::client {
namespace {

std::string Printed(const Table& table) {
  std::ostringstream out;
  table.Print(out);
  return out.str();
}

TEST(Table, ColumnsAreAsWideAsTheirWidestCell) {
  Table table({{"NAME"}, {"N", Align::kRight}, {"NOTE"}});
  table.Add({"a", "1", "x"});
  table.Add({"longer name", "1234", ""});
  EXPECT_EQ(Printed(table),
            "NAME            N  NOTE\n"
            "a               1  x\n"
            "longer name  1234\n");
}

TEST(Table, CountsCharactersAndNotBytes) {
  Table table({{"A"}, {"B"}});
  table.Add({"caf\xc3\xa9", "1"});
  table.Add({"cafe", "2"});
  EXPECT_EQ(Printed(table), "A     B\ncaf\xc3\xa9  1\ncafe  2\n");
}

TEST(Table, CellsFromElsewhereCannotMoveTheCursor) {
  Table table({{"A"}});
  table.Add({"x\x1b[2Jy\nz"});
  EXPECT_EQ(Printed(table), "A\nx [2Jy z\n");
}

TEST(Table, MissingCellsAreEmptyAndSurplusOnesDropped) {
  Table table({{"A"}, {"B"}});
  EXPECT_TRUE(table.empty());
  table.Add({"1"});
  table.Add({"1", "2", "3"});
  EXPECT_FALSE(table.empty());
  EXPECT_EQ(Printed(table), "A  B\n1\n1  2\n");
}

TEST(Numbers, UnknownIsADash) {
  EXPECT_EQ(Fixed(std::nullopt, 2), "-");
  EXPECT_EQ(Fixed(std::numeric_limits<double>::quiet_NaN(), 2), "-");
  EXPECT_EQ(Fixed(1.2345, 2), "1.23");
  EXPECT_EQ(Fixed(-0.0004, 3), "0.000");
  EXPECT_EQ(Fixed(-0.0005001, 3), "-0.001");
  EXPECT_EQ(Scaled(0.08318, 1e3, 2), "83.18");
  EXPECT_EQ(Scaled(std::nullopt, 1e3, 2), "-");
  EXPECT_EQ(Fixed(1e300, 0).size(), 301U);
}

TEST(Numbers, BytesInPowersOfAThousand) {
  EXPECT_EQ(ByteText(0), "0 B");
  EXPECT_EQ(ByteText(999), "999 B");
  EXPECT_EQ(ByteText(1500), "1.5 kB");
  EXPECT_EQ(ByteText(24e6), "24 MB");
  EXPECT_EQ(ByteText(1.26e9), "1.3 GB");
  EXPECT_EQ(ByteText(999.9e6), "1.0 GB");
}

}  // namespace
}  // namespace rigcal::client
