#include "pickcell/image/codec.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "pickcell/core/file.hpp"
#include "pickcell/image/formats.hpp"

namespace pickcell::image {

namespace formats {

core::Status check_size(std::int64_t width, std::int64_t height, const std::string& name) {
  const std::string size = std::to_string(width) + "x" + std::to_string(height) + " pixels";
  if (width < 1 || height < 1) return damaged(name, "picture of " + size);
  if (width > kMaxSidePx || height > kMaxSidePx || static_cast<std::size_t>(width * height) > kMaxPixels)
    return core::failure(core::ErrorCode::unreadable, name, "picture of " + size + " is too large",
                         "use at most " + std::to_string(kMaxSidePx) + " pixels a side and " +
                             std::to_string(kMaxPixels >> 20) + " megapixels");
  return {};
}

tl::unexpected<core::Error> damaged(const std::string& name, const std::string& why) {
  return core::failure(core::ErrorCode::unreadable, name, "truncated or damaged picture: " + why,
                       "copy or export the file again");
}

}  // namespace formats

namespace {

bool starts_with(formats::Bytes bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin(),
                                                    [](char c, std::byte b) { return static_cast<std::byte>(c) == b; });
}

}  // namespace

core::Result<Image> decode_grey(std::span<const std::byte> bytes, const std::string& name) {
  if (bytes.empty()) return core::failure(core::ErrorCode::unreadable, name, "the file is empty");
  if (starts_with(bytes, "\x89PNG\r\n\x1a\n")) return formats::decode_png(bytes, name);
  if (starts_with(bytes, "\xff\xd8\xff")) return formats::decode_jpeg(bytes, name);
  if (starts_with(bytes, "BM")) return formats::decode_bmp(bytes, name);
  if (starts_with(bytes, "P5") || starts_with(bytes, "P6")) return formats::decode_pnm(bytes, name);
  return core::failure(core::ErrorCode::unreadable, name, "not a PNG, JPEG, BMP or binary PGM/PPM picture",
                       "convert it to PNG");
}

core::Result<Image> load_grey(const std::filesystem::path& path) {
  auto bytes = core::read_file(path);
  if (!bytes) return core::forward(bytes);
  return decode_grey(*bytes, path.string());
}

}  // namespace pickcell::image
