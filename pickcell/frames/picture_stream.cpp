#include "pickcell/frames/picture_stream.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>

#include "pickcell/image/codec.hpp"

namespace pickcell::frames {

using core::ErrorCode;
using core::failure;

namespace {

constexpr std::size_t kLongestLine = 512;
constexpr std::size_t kLargestFile = std::size_t{1} << 28;
constexpr std::string_view kY4m = "YUV4MPEG2";

/// The number at the start of the text, which is moved past it.
std::optional<int> number(std::string_view& text) {
  int value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

/// Length of the header of a binary PGM/PPM and of its pixels; unset while the header is not whole, 0 for none.
std::optional<std::size_t> pnm_length(std::string_view text) {
  std::size_t at = 2;
  std::size_t values[3] = {};
  for (std::size_t& value : values) {
    for (;; ++at) {  // blanks and comments
      if (at >= text.size()) return std::nullopt;
      if (text[at] == '#') {
        at = text.find('\n', at);
        if (at == std::string_view::npos) return std::nullopt;
      } else if (text[at] != ' ' && text[at] != '\n' && text[at] != '\r' && text[at] != '\t') {
        break;
      }
    }
    const std::size_t begin = at;
    for (; at < text.size() && text[at] >= '0' && text[at] <= '9' && at - begin < 6; ++at)
      value = value * 10 + static_cast<std::size_t>(text[at] - '0');
    if (at >= text.size()) return std::nullopt;
    if (at == begin) return 0;
  }
  if (values[0] < 1 || values[1] < 1 || values[0] > image::kMaxSidePx || values[1] > image::kMaxSidePx) return 0;
  if (values[2] < 1 || values[2] > 65535) return 0;
  return at + 1 + values[0] * values[1] * (text[1] == '6' ? 3 : 1) * (values[2] > 255 ? 2 : 1);
}

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

void PictureStream::feed(std::span<const std::byte> bytes) {
  if (begin_ > 0) {
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(begin_));
    begin_ = 0;
  }
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

void PictureStream::drop(std::size_t n) {
  begin_ += n;
  seen_ = 0;
}

PictureStream::Next PictureStream::fail(std::string why) {
  failed_ = true;
  return failure(ErrorCode::unreadable, name_, std::move(why), "give Y4M (8 bit), JPEG or PGM/PPM pictures in a row");
}

PictureStream::Next PictureStream::want_more() {
  if (bytes_.size() - begin_ > kLargestFile) return fail("a picture is larger than any that is accepted");
  if (ended_ && bytes_.size() > begin_) return fail("ends within a picture");
  return std::optional<image::Image>();
}

PictureStream::Next PictureStream::next() {
  if (failed_) return std::optional<image::Image>();
  const auto rest = as_text(std::span(bytes_).subspan(begin_));
  if (kind_ == Kind::unknown) {
    if (rest.size() < kY4m.size()) return want_more();
    if (rest.starts_with(kY4m))
      kind_ = Kind::y4m;
    else if (rest.starts_with("\xff\xd8"))
      kind_ = Kind::jpeg;
    else if (rest[0] == 'P' && (rest[1] == '5' || rest[1] == '6'))
      kind_ = Kind::pnm;
    else
      return fail("is no stream of pictures");
  }
  if (kind_ == Kind::y4m) return next_y4m();
  return kind_ == Kind::jpeg ? next_jpeg() : next_pnm();
}

std::optional<std::string> PictureStream::line(std::size_t from) const {
  const auto rest = as_text(std::span(bytes_).subspan(begin_ + from));
  const std::size_t end = rest.substr(0, kLongestLine).find('\n');
  if (end == std::string_view::npos) return std::nullopt;
  return std::string(rest.substr(0, end));
}

bool PictureStream::read_y4m_header(const std::string& header) {
  std::string_view chroma = "420";
  for (std::size_t at = header.find(' '); at != std::string::npos; at = header.find(' ', at + 1)) {
    std::string_view word = std::string_view(header).substr(at + 1);
    word = word.substr(0, word.find(' '));
    if (word.empty()) continue;
    const char key = word[0];
    word.remove_prefix(1);
    if (key == 'W') width_px_ = number(word).value_or(0);
    if (key == 'H') height_px_ = number(word).value_or(0);
    if (key == 'C') chroma = word;
    if (key != 'F') continue;
    const auto over = number(word);
    if (!over || word.empty() || word[0] != ':') continue;
    word.remove_prefix(1);
    const auto under = number(word);
    if (under && *over > 0 && *under > 0) fps_ = static_cast<double>(*over) / *under;
  }
  if (width_px_ < 1 || height_px_ < 1 || width_px_ > image::kMaxSidePx || height_px_ > image::kMaxSidePx) return false;
  const auto w = static_cast<std::size_t>(width_px_), h = static_cast<std::size_t>(height_px_);
  if (w * h > image::kMaxPixels) return false;
  // By name, for "420p10" and the like have samples of 16 bits.
  if (chroma == "420" || chroma == "420jpeg" || chroma == "420mpeg2" || chroma == "420paldv")
    chroma_bytes_ = (w + 1) / 2 * ((h + 1) / 2) * 2;
  else if (chroma == "422")
    chroma_bytes_ = (w + 1) / 2 * h * 2;
  else if (chroma == "444")
    chroma_bytes_ = w * h * 2;
  else if (chroma == "mono")
    chroma_bytes_ = 0;
  else
    return false;
  return true;
}

PictureStream::Next PictureStream::next_y4m() {
  if (width_px_ == 0) {
    const auto header = line(0);
    if (!header) return bytes_.size() - begin_ > kLongestLine ? fail("has no Y4M header") : want_more();
    if (!read_y4m_header(*header)) return fail("is a kind of Y4M that is not understood: " + *header);
    drop(header->size() + 1);
  }
  const std::size_t left = bytes_.size() - begin_;
  if (left == 0) return want_more();
  const auto header = line(0);
  if (!header) return left > kLongestLine ? fail("has no frame where one should be") : want_more();
  if (!header->starts_with("FRAME")) return fail("has no frame where one should be");
  const auto w = static_cast<std::size_t>(width_px_), h = static_cast<std::size_t>(height_px_);
  const std::size_t length = header->size() + 1 + w * h + chroma_bytes_;
  if (left < length) return want_more();
  const auto* luma = reinterpret_cast<const std::uint8_t*>(bytes_.data() + begin_ + header->size() + 1);
  image::Image out(image::ImageView(luma, width_px_, height_px_, width_px_));
  drop(length);
  return std::optional<image::Image>(std::move(out));
}

PictureStream::Next PictureStream::next_jpeg() {
  const auto rest = as_text(std::span(bytes_).subspan(begin_));
  if (rest.empty()) return want_more();
  if (rest.size() >= 2 && !rest.starts_with("\xff\xd8")) return fail("has no JPEG where one should be");
  // Within a JPEG an FF of its data is followed by 00 or a restart marker, so that FF D9 ends it. (Thumbnails inside of
  // headers would be mistaken; cameras send none.)
  const std::size_t end = rest.find("\xff\xd9", std::max<std::size_t>(seen_, 2));
  if (end == std::string_view::npos) {
    seen_ = rest.size() - 1;
    return want_more();
  }
  auto picture = image::decode_grey(std::span(bytes_).subspan(begin_, end + 2), name_);
  if (!picture) return fail(picture.error().why);
  drop(end + 2);
  return std::optional<image::Image>(std::move(*picture));
}

PictureStream::Next PictureStream::next_pnm() {
  const auto rest = as_text(std::span(bytes_).subspan(begin_));
  if (rest.size() < 3) return want_more();
  if (rest[0] != 'P' || (rest[1] != '5' && rest[1] != '6')) return fail("has no PGM or PPM where one should be");
  const auto length = pnm_length(rest);
  if (!length) return rest.size() > kLongestLine ? fail("has a header without an end") : want_more();
  if (*length == 0) return fail("has a PGM or PPM of impossible size");
  if (rest.size() < *length) return want_more();
  auto picture = image::decode_grey(std::span(bytes_).subspan(begin_, *length), name_);
  if (!picture) return fail(picture.error().why);
  drop(*length);
  return std::optional<image::Image>(std::move(*picture));
}

}  // namespace pickcell::frames
