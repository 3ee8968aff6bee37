#include "pickcell/poses/board.hpp"

#include <gtest/gtest.h>

#include <set>

namespace pickcell::poses {
namespace {

TEST(BoardText, GivesKindCountsAndLengthsInMetres) {
  const auto board = parse_board("charuco:5x7:36.195mm:18.256mm:6X6_250");
  ASSERT_TRUE(board);
  EXPECT_EQ(board->kind, BoardKind::charuco);
  EXPECT_EQ(board->point_cols(), 4);
  EXPECT_EQ(board->point_rows(), 6);
  EXPECT_DOUBLE_EQ(board->spacing_m, 0.036195);
  EXPECT_DOUBLE_EQ(board->marker_m, 0.018256);
  EXPECT_EQ(board->dictionary, "6X6_250");
  EXPECT_DOUBLE_EQ(parse_board("chessboard:9x6:0.025m")->spacing_m, 0.025);
}

TEST(BoardText, WithoutUnitOrWithOtherFaultsIsRefused) {
  for (const char* text : {"", "chessboard", "chessboard:9x6", "chessboard:9x6:25", "chessboard:9:25mm",
                           "sheet:9x6:25mm", "chessboard:0x6:25mm", "chessboard:9x6:-25mm", "chessboard:9x6:25mm:3",
                           "circles:1x1:2mm", "charuco:5x7:36mm:40mm:6X6_250", "charuco:5x7:36mm:18mm",
                           "chessboard:9x9999999999:25mm", "chessboard:9x6:nanmm", "chessboard:9x6:1e9m"}) {
    const auto board = parse_board(text);
    ASSERT_FALSE(board) << text;
    EXPECT_EQ(board.error().code, core::ErrorCode::usage);
    EXPECT_FALSE(board.error().remedy.empty());
  }
}

TEST(BoardSymmetries, AreRigidTurnsThatKeepTheBoard) {
  for (const char* text :
       {"circles:10x10:25mm", "circles:7x5:25mm", "acircles:4x11:20mm", "acircles:4x10:20mm", "chessboard:9x6:25mm",
        "chessboard:8x6:25mm", "chessboard:8x8:25mm", "chessboard:7x7:25mm"}) {
    const auto board = parse_board(text);
    const auto points = board_points_m(*board);
    for (const auto& turn : board_symmetries(*board)) {
      EXPECT_EQ(std::set<int>(turn.begin(), turn.end()).size(), points.size());
      // Distances and handedness stay.
      const auto at = [&](std::size_t i) { return points[static_cast<std::size_t>(turn[i])]; };
      const Eigen::Vector2d a = points[1] - points[0], b = points.back() - points[0];
      const Eigen::Vector2d c = at(1) - at(0), d = at(points.size() - 1) - at(0);
      EXPECT_NEAR(a.norm(), c.norm(), 1e-12) << text;
      EXPECT_NEAR(a.x() * b.y() - a.y() * b.x(), c.x() * d.y() - c.y() * d.x(), 1e-12) << text;
    }
  }
  EXPECT_EQ(board_symmetries(*parse_board("chessboard:9x6:25mm")).size(), 1U);
  EXPECT_EQ(board_symmetries(*parse_board("circles:10x10:25mm")).size(), 4U);
}

}  // namespace
}  // namespace pickcell::poses
