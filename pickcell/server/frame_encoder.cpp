#include "pickcell/server/frame_encoder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pickcell/image/codec.hpp"
#include "pickcell/server/frame_message.hpp"
#include "pickcell/server/messages.hpp"
#include "pickcell/server/shrink.hpp"

namespace pickcell::server {

namespace {

constexpr std::size_t kKept = 8;  // four subscribers with a width each, for the newest picture and the one before

template <class T>
void keep(std::vector<T>& cache, T made) {
  if (cache.size() >= kKept) cache.erase(cache.begin());
  cache.push_back(std::move(made));
}

}  // namespace

SharedBytes FrameEncoder::jpeg(const std::shared_ptr<const image::Image>& picture, int max_width_px, int quality) {
  const int width = std::min({max_width_px, picture->width(), kMaxShownSidePx});
  for (const Jpeg& j : jpegs_)
    if (j.picture == picture && j.width_px == width && j.quality == quality) return j.bytes;
  const auto bytes = width == picture->width() ? image::encode_jpeg(picture->view(), quality)
                                               : image::encode_jpeg(shrink(picture->view(), width).view(), quality);
  ++jpegs_made_;
  auto shared = std::make_shared<const std::vector<std::byte>>(bytes);
  keep(jpegs_, Jpeg{picture, width, quality, shared});
  return shared;
}

SharedBytes FrameEncoder::message(const ShownFramePtr& shown, int max_width_px, int quality) {
  const image::Image& picture = *shown->frame.picture;
  const int width = std::min({max_width_px, picture.width(), kMaxShownSidePx});
  for (const Message& m : messages_)
    if (m.shown == shown && m.width_px == width && m.quality == quality) return m.bytes;
  const SharedBytes coded = jpeg(shown->frame.picture, width, quality);
  const double scale = static_cast<double>(width) / picture.width();
  FrameHeader header;
  header.frame_id = wire_frame_id(*shown);
  header.exposed_unix_us = static_cast<std::uint64_t>(std::max<std::int64_t>(0, shown->frame.exposed_unix_us));
  header.width_px = width;
  header.height_px = std::max(1, static_cast<int>(std::lround(picture.height() * scale)));
  header.scale_permille = std::max(1, static_cast<int>(std::lround(scale * 1000)));
  header.flags = shown->frame.simulated ? kFlagSimulated : std::uint16_t{0};
  auto bytes =
      std::make_shared<const std::vector<std::byte>>(encode_frame_message(header, overlay_json(*shown).dump(), *coded));
  keep(messages_, Message{shown, width, quality, bytes});
  return bytes;
}

}  // namespace pickcell::server
