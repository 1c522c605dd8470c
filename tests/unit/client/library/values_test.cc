// The public header alone, as a program outside sees it: nothing of the client is included.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "client/library/include/rigcal/client.h"

namespace {

Eigen::Matrix4d AsEigen(const rigcal::Matrix4& T) {
  Eigen::Matrix4d to;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      to(row, column) = T[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
  return to;
}

rigcal::Pose SomePose(const Eigen::Quaterniond& q) { return {{0.1, -0.2, 0.3}, {q.x(), q.y(), q.z(), q.w()}}; }

TEST(LibraryValues, MatrixOfAPose) {
  const Eigen::Quaterniond q(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized()));
  const Eigen::Matrix4d T = AsEigen(SomePose(q).Matrix());
  EXPECT_TRUE((T.topLeftCorner<3, 3>().isApprox(q.toRotationMatrix(), 1e-14))) << T;
  EXPECT_TRUE((T.topRightCorner<3, 1>().isApprox(Eigen::Vector3d(0.1, -0.2, 0.3), 1e-15))) << T;
  EXPECT_TRUE(T.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1)));
}

TEST(LibraryValues, PoseOfAMatrixAlsoAtHalfATurn) {
  const std::vector<Eigen::Vector3d> axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 2, -3}, {-0.1, 5, 0.1}};
  for (const Eigen::Vector3d& axis : axes)
    for (const double angle : {0.0, 1e-9, 0.3, 2.0, 3.14159, M_PI, -M_PI + 1e-7, -2.5}) {
      const Eigen::Quaterniond q(Eigen::AngleAxisd(angle, axis.normalized()));
      const rigcal::Pose back = rigcal::PoseOf(SomePose(q).Matrix());
      const Eigen::Quaterniond found(back.q_xyzw[3], back.q_xyzw[0], back.q_xyzw[1], back.q_xyzw[2]);
      EXPECT_NEAR(std::abs(found.dot(q)), 1.0, 1e-12) << axis.transpose() << " by " << angle;
      EXPECT_NEAR(found.angularDistance(q), 0.0, 1e-7) << axis.transpose() << " by " << angle;
      EXPECT_GE(back.q_xyzw[3], 0.0);
      EXPECT_EQ(back.p_m, SomePose(q).p_m);
    }
}

TEST(LibraryErrors, ATagThatIsNoNameIsOneSentenceOfEveryCall) {
  rigcal::Client client({.tag = "no name"});
  for (int call = 0; call < 2; ++call) try {
      client.Ask("robots");
      FAIL();
    } catch (const rigcal::Error& error) {
      EXPECT_EQ(error.code(), rigcal::Code::kInvalidInput);
      EXPECT_NE(std::string(error.what()).find("no name"), std::string::npos) << error.what();
    }
  EXPECT_THROW((void)client.Follow("rig"), rigcal::Error);
}

TEST(LibraryErrors, WhereNobodyIsThereItSaysWhereItLooked) {
  rigcal::Client client({.tag = "nobody-at-all", .timeout_s = 0.1});
  try {
    (void)client.LookUp("rig", "a", "b");
    FAIL();
  } catch (const rigcal::Error& error) {
    EXPECT_EQ(error.code(), rigcal::Code::kUnreachable);
    EXPECT_NE(std::string(error.what()).find("tag 'nobody-at-all'"), std::string::npos) << error.what();
  }
}

TEST(LibraryErrors, EdgesThatAreWrongAreRefusedBeforeAServerIsLookedFor) {
  rigcal::Client client({.tag = "nobody-at-all"});
  rigcal::Edge edge{.frame_a = "a", .frame_b = "b", .T_a_b = {}};
  const auto refused = [&] {
    try {
      client.PushEdges("rig", {&edge, 1});
    } catch (const rigcal::Error& error) {
      EXPECT_EQ(error.code(), rigcal::Code::kInvalidInput);
      return std::string(error.what());
    }
    return std::string("it was taken");
  };
  EXPECT_NE(refused().find("\"information\" or \"covariance\" is missing"), std::string::npos) << refused();
  edge.information.emplace()[0][1] = 1.0;
  EXPECT_NE(refused().find("not symmetric"), std::string::npos) << refused();
  edge.information->at(0)[1] = std::nan("");
  EXPECT_NE(refused().find("information"), std::string::npos) << refused();
}

}  // namespace
