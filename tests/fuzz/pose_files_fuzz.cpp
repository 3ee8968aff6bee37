// Files of arm poses and touched points: any text, behind a valid header.

#include <cstdlib>
#include <string>

#include "pickcell/poses/board.hpp"
#include "pickcell/poses/pose_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pickcell::poses;
  if (size == 0) return 0;
  const std::string text(data + 1, data + size);
  switch (data[0] % 7) {
    case 0: {
      const auto poses = parse_pose_csv("image,x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg\n" + text, "fuzz");
      if (poses)
        for (const ArmPose& p : *poses)
          if (!p.position_m.allFinite() || !p.angles_deg.allFinite()) std::abort();
      break;
    }
    case 1:
      (void)parse_pose_csv(text, "fuzz");
      break;
    case 2:
      (void)parse_points_csv("u_px,v_px,x_mm,y_mm,z_mm\n" + text, "fuzz");
      break;
    case 3:
      (void)parse_touched_csv("col,row,x_mm,y_mm,z_mm\n" + text, "fuzz");
      break;
    case 4:
      (void)parse_rct_list(text, "fuzz");
      break;
    case 5:
      (void)parse_rct_pose(text, "fuzz");
      break;
    default:
      if (const auto board = parse_board(text)) {
        if (board_points_m(*board).size() != static_cast<std::size_t>(board->points())) std::abort();
        (void)board_symmetries(*board);
      }
  }
  return 0;
}
