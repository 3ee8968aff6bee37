// Binary PGM (P5) and PPM (P6), 8 and 16 bit. Source: netpbm, pgm(5) and ppm(5).

#include <optional>

#include "pickcell/image/formats.hpp"

namespace pickcell::image::formats {

namespace {

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// Reads the numbers of the header; comments run from # to the end of the line.
class HeaderReader {
 public:
  explicit HeaderReader(Bytes bytes) : bytes_(bytes) {}

  std::optional<std::int64_t> number() {
    skip_space();
    std::int64_t value = 0;
    int digits = 0;
    for (; at_ < bytes_.size() && peek() >= '0' && peek() <= '9'; ++at_, ++digits) {
      if (digits == 9) return std::nullopt;
      value = value * 10 + (peek() - '0');
    }
    return digits > 0 ? std::optional(value) : std::nullopt;
  }

  /// Exactly one white space stands between the header and the samples.
  std::optional<Bytes> samples() {
    if (at_ >= bytes_.size() || !is_space(peek())) return std::nullopt;
    return bytes_.subspan(at_ + 1);
  }

 private:
  [[nodiscard]] char peek() const { return std::to_integer<char>(bytes_[at_]); }
  void skip_space() {
    while (at_ < bytes_.size() && (is_space(peek()) || peek() == '#')) {
      if (peek() == '#')
        while (at_ < bytes_.size() && peek() != '\n') ++at_;
      else
        ++at_;
    }
  }

  Bytes bytes_;
  std::size_t at_ = 2;  // behind P5 or P6
};

/// One sample as 8 bit, rounded.
std::uint8_t sample(Bytes samples, std::size_t index, std::uint32_t maximum) {
  std::uint32_t value = maximum < 256 ? std::to_integer<std::uint32_t>(samples[index])
                                      : std::to_integer<std::uint32_t>(samples[2 * index]) << 8 |
                                            std::to_integer<std::uint32_t>(samples[2 * index + 1]);
  if (value > maximum) value = maximum;
  return static_cast<std::uint8_t>((value * 255 + maximum / 2) / maximum);
}

}  // namespace

core::Result<Image> decode_pnm(Bytes bytes, const std::string& name) {
  HeaderReader header(bytes);
  const auto width = header.number();
  const auto height = header.number();
  const auto maximum = header.number();
  const auto samples = header.samples();
  if (!width || !height || !maximum || !samples || *maximum < 1 || *maximum > 65535)
    return damaged(name, "the PGM/PPM header is not complete");
  if (auto size = check_size(*width, *height, name); !size) return core::forward(size);
  const std::size_t channels = std::to_integer<char>(bytes[1]) == '6' ? 3 : 1;
  const auto most = static_cast<std::uint32_t>(*maximum);
  const std::size_t count = static_cast<std::size_t>(*width) * static_cast<std::size_t>(*height) * channels;
  if (samples->size() < count * (most < 256 ? 1 : 2)) return damaged(name, "the file ends too early");
  Image out(static_cast<int>(*width), static_cast<int>(*height));
  std::size_t i = 0;
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x, i += channels)
      out.row(y)[x] =
          channels == 1 ? sample(*samples, i, most)
                        : luma(sample(*samples, i, most), sample(*samples, i + 1, most), sample(*samples, i + 2, most));
  return out;
}

}  // namespace pickcell::image::formats
