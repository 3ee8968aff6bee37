#include "pickcell/poses/calibration_report.hpp"

namespace pickcell::poses {
core::Status write_camera_report(const std::filesystem::path&, const Board&, const CameraFit&) { return {}; }
core::Status write_handeye_report(const std::filesystem::path&, const Board&, const HandeyeFit&) { return {}; }
}  // namespace pickcell::poses
