#include "pickcell/poses/calibration_report.hpp"

namespace pickcell::poses {
core::Status write_camera_report(const std::filesystem::path&, const Board&, const CameraFit&) { return {}; }
}  // namespace pickcell::poses
