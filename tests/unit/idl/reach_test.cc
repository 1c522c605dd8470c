#include "idl/reach.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace rigcal::wire {
namespace {

// A variable for the time of one test.
class Given {
 public:
  Given(const char* name, const char* value) : name_(name) {
    const char* const was = std::getenv(name);
    if (was != nullptr) before_ = was;
    ::setenv(name, value, 1);
  }
  ~Given() { ::setenv(name_, before_.c_str(), 1); }  // empty is not given
  Given(const Given&) = delete;
  Given& operator=(const Given&) = delete;

 private:
  const char* name_;
  std::string before_;
};

TEST(Reach, IsThisMachineWhereItIsToldAndNoOtherConfigurationRules) {
  const Given local("RIGCAL_DDS_LOCAL", "1"), no_rules("CYCLONEDDS_URI", "");
  EXPECT_TRUE(IsOnlyHere());
  EXPECT_FALSE(IsRuledFromOutside());
  const Given rules("CYCLONEDDS_URI", "file:///etc/rigcal/cyclonedds.xml");
  EXPECT_TRUE(IsRuledFromOutside());
  EXPECT_FALSE(IsOnlyHere());
}

TEST(Reach, IsTheNetworkWhereNothingIsTold) {
  const Given local("RIGCAL_DDS_LOCAL", ""), no_rules("CYCLONEDDS_URI", "");
  EXPECT_FALSE(IsOnlyHere());
}

}  // namespace
}  // namespace rigcal::wire
