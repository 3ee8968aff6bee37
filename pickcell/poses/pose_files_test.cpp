#include "pickcell/poses/pose_files.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace pickcell::poses {
namespace {

TEST(PoseCsv, WithEulerAnglesIsRzRyRx) {
  const auto poses = parse_pose_csv(
      "# from the "
      "pendant\r\nimage,x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg\r\na.png,100,-200,300.5,90,0,0\n\nb.png,0,0,0,0,0,90\n",
      "p.csv");
  ASSERT_TRUE(poses) << poses.error().line();
  ASSERT_EQ(poses->size(), 2U);
  EXPECT_TRUE((*poses)[0].pose().translation().isApprox(Eigen::Vector3d(0.1, -0.2, 0.3005)));
  EXPECT_TRUE(((*poses)[0].pose().linear() * Eigen::Vector3d::UnitY()).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
  EXPECT_TRUE(((*poses)[1].pose().linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-12));
  const Eigen::Matrix3d all = rotation_zyx({10, 20, 30});
  const Eigen::Matrix3d by_parts = rotation_zyx({0, 0, 30}) * rotation_zyx({0, 20, 0}) * rotation_zyx({10, 0, 0});
  EXPECT_TRUE(all.isApprox(by_parts, 1e-12));
}

TEST(PoseCsv, WithQuaternionsIsInMetresAndScalarLast) {
  const auto poses = parse_pose_csv("image,x_m,y_m,z_m,qx,qy,qz,qw\na.png,1,2,3,0,0,0.7071068,0.7071068\n", "p.csv");
  ASSERT_TRUE(poses) << poses.error().line();
  EXPECT_TRUE((*poses)[0].pose().translation().isApprox(Eigen::Vector3d(1, 2, 3)));
  EXPECT_TRUE(((*poses)[0].pose().linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-6));
}

TEST(PoseCsv, FromSpreadsheetsOfOtherCountriesIsTheSame) {
  const std::string commas = "image,x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg\na.png,100,-200,300.5,90,0,0\n";
  for (const char separator : {';', '\t'}) {
    std::string text = "\xEF\xBB\xBF" + commas;
    std::replace(text.begin(), text.end(), ',', separator);
    const auto poses = parse_pose_csv(text, "p.csv");
    ASSERT_TRUE(poses) << poses.error().line();
    EXPECT_TRUE((*poses)[0].pose().isApprox((*parse_pose_csv(commas, "p.csv"))[0].pose()));
  }
  const auto decimal_comma = parse_pose_csv("image;x_m;y_m;z_m;qx;qy;qz;qw\na.png;1,5;2;3;0;0;0;1\n", "p.csv");
  ASSERT_FALSE(decimal_comma);
  EXPECT_NE(decimal_comma.error().line().find("line 2: x_m is '1,5'"), std::string::npos);
  EXPECT_NE(decimal_comma.error().line().find("decimal point"), std::string::npos);
}

TEST(PoseCsv, SaysWhichLineIsWrong) {
  const std::string header = "image,x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg\n";
  const auto why = [](const std::string& text) {
    const auto poses = parse_pose_csv(text, "p.csv");
    return poses ? std::string("accepted") : poses.error().line();
  };
  EXPECT_NE(why(header + "a.png,1,2,nan,0,0,0\n").find("p.csv line 2: z_mm is nan"), std::string::npos);
  EXPECT_NE(why(header + "a.png,1,2,3,0,0\n").find("line 2: has 6 fields"), std::string::npos);
  EXPECT_NE(why(header + "a.png,1,2,3,0,0,0\na.png,1,2,3,0,0,0\n").find("twice"), std::string::npos);
  EXPECT_NE(why("image,x,y,z,rx,ry,rz\n").find("no column"), std::string::npos);
  EXPECT_NE(why("").find("empty"), std::string::npos);
  EXPECT_NE(why(header).find("no pose"), std::string::npos);
  EXPECT_NE(why("image,x_m,y_m,z_m,qx,qy,qz,qw\na.png,1,2,3,0,0,0,0.5\n").find("length 0.5"), std::string::npos);
}

TEST(RctFiles, AreRead) {
  const auto list = parse_rct_list(
      "\xEF\xBB\xBF- pose: poses/0.yaml\n  image: images/0.png\n- image: i/1.png  # late\n  pose: p/1.yaml", "l");
  ASSERT_TRUE(list) << list.error().line();
  ASSERT_EQ(list->size(), 2U);
  EXPECT_EQ((*list)[1].image, "i/1.png");
  const auto pose = parse_rct_pose("x: 0.5\ny: -0.25\nz: 1\nqx: 0\nqy: 1\nqz: 0\nqw: 0\n", "p");
  ASSERT_TRUE(pose) << pose.error().line();
  EXPECT_TRUE(pose->pose().translation().isApprox(Eigen::Vector3d(0.5, -0.25, 1)));
  EXPECT_FALSE(parse_rct_pose("x: 0.5\n", "p"));
  EXPECT_FALSE(parse_rct_pose("x: nan\ny: 0\nz: 1\nqx: 0\nqy: 1\nqz: 0\nqw: 0\n", "p"));
  EXPECT_FALSE(parse_rct_list("- pose: p\n", "l"));
}

TEST(TouchedCsv, CountsFromZeroInWholeNumbers) {
  const auto touched = parse_touched_csv("col,row,x_mm,y_mm,z_mm\n0,5,1,2,3\n", "t.csv");
  ASSERT_TRUE(touched);
  EXPECT_EQ((*touched)[0].row, 5);
  EXPECT_FALSE(parse_touched_csv("col,row,x_mm,y_mm,z_mm\n0.5,5,1,2,3\n", "t.csv"));
  EXPECT_FALSE(parse_points_csv("u_px,v_px,x_mm,y_mm\n1,2,3,4\n", "p.csv"));
}

TEST(PoseFiles, AnyTextGivesFiniteValuesOrAnError) {
  std::mt19937 random(1);
  const std::string letters = "0123456789.,-+e\n\r \"#abnif:xyqw";
  const auto pick = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  for (int round = 0; round < 3000; ++round) {
    std::string tail;
    for (std::size_t n = pick(60); n > 0; --n) tail += letters[pick(letters.size())];
    (void)parse_rct_list(tail, "l");
    (void)parse_rct_pose(tail, "p");
    const auto poses = parse_pose_csv("image,x_m,y_m,z_m,qx,qy,qz,qw\na,1,2,3,0,0,0,1\n" + tail, "p");
    if (!poses) {
      EXPECT_EQ(poses.error().code, core::ErrorCode::unreadable);
      continue;
    }
    for (const ArmPose& p : *poses) EXPECT_TRUE(p.pose().matrix().allFinite()) << tail;
  }
}

}  // namespace
}  // namespace pickcell::poses
