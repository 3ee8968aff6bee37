#include "pickcell/frames/camera_list.hpp"

#include "pickcell/frames/open_source.hpp"
#ifdef PICKCELL_WITH_ARAVIS
#include "pickcell/frames/aravis_device.hpp"
#endif
#ifdef PICKCELL_WITH_V4L2
#include "pickcell/frames/v4l2_device.hpp"
#endif

namespace pickcell::frames {

std::vector<ListedCamera> list_cameras() {
  std::vector<ListedCamera> out;
#ifdef PICKCELL_WITH_ARAVIS
  for (ListedCamera& c : find_aravis_cameras()) out.push_back(std::move(c));
#endif
#ifdef PICKCELL_WITH_V4L2
  for (ListedCamera& c : find_v4l2_cameras()) out.push_back(std::move(c));
#endif
  return out;
}

core::Result<std::vector<std::pair<std::string, std::string>>> camera_features(const std::string& source) {
  if (auto known = check_source(source); !known) return core::forward(known);
#ifdef PICKCELL_WITH_ARAVIS
  if (source.starts_with("aravis:")) return aravis_features(source.substr(7));
#endif
#ifdef PICKCELL_WITH_V4L2
  if (source.starts_with("v4l2:")) return v4l2_controls(source.substr(5));
#endif
  return core::failure(core::ErrorCode::usage, source, "has no features", "leave --features out");
}

}  // namespace pickcell::frames
