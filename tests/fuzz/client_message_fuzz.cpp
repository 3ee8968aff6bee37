// Whatever a page sends over the WebSocket: parsed within its limits, or refused.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "pickcell/server/client_message.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pickcell::server;
  const auto parsed = parse_client_message({reinterpret_cast<const char*>(data), size});
  if (!parsed) return parsed.error().why.empty() ? std::abort(), 0 : 0;
  if (const auto* subscribe = std::get_if<Subscribe>(&*parsed); subscribe != nullptr && subscribe->video) {
    const VideoRequest& v = *subscribe->video;
    const bool within = v.camera == 0 && v.max_width_px >= 160 && v.max_width_px <= 4096 && v.max_fps >= 0.2 &&
                        v.max_fps <= 60 && v.quality >= 30 && v.quality <= 95;
    if (!within) std::abort();
  }
  return 0;
}
