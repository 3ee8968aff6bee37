#include "pickcell/matches/model_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "pickcell/core/file.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/matches/limits.hpp"

namespace pickcell::matches {

namespace {

using Bytes = std::span<const std::byte>;

constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'P', 'C', 'M', '\r', '\n', 0x1a, '\n'};
constexpr std::size_t kHeaderBytes = kMagic.size() + 8;
constexpr std::size_t kCrcBytes = 4;
constexpr std::uint32_t kMaxText = 4096;
constexpr std::uint32_t kMaxList = 4096;

class Writer {
 public:
  void u8(std::uint8_t v) { out_.push_back(std::byte{v}); }
  void u32(std::uint32_t v) {
    for (int shift = 0; shift < 32; shift += 8) u8(static_cast<std::uint8_t>(v >> shift));
  }
  void f64(double v) {
    const auto bits = std::bit_cast<std::uint64_t>(v);
    u32(static_cast<std::uint32_t>(bits));
    u32(static_cast<std::uint32_t>(bits >> 32));
  }
  void text(const std::string& v) {
    if (v.size() > kMaxText) throw std::invalid_argument("model text longer than 4096 bytes");
    u32(static_cast<std::uint32_t>(v.size()));
    for (const char c : v) u8(static_cast<std::uint8_t>(c));
  }
  void list_size(std::size_t n) {
    if (n > kMaxList) throw std::invalid_argument("model list longer than 4096");
    u32(static_cast<std::uint32_t>(n));
  }
  void picture(const image::Image& v) {
    u32(static_cast<std::uint32_t>(v.width()));
    u32(static_cast<std::uint32_t>(v.height()));
    for (int y = 0; y < v.height(); ++y)
      append(std::as_bytes(std::span(v.row(y), static_cast<std::size_t>(v.width()))));
  }
  void range(Range v) {
    f64(v.lo);
    f64(v.hi);
  }
  void append(Bytes bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }
  [[nodiscard]] const std::vector<std::byte>& bytes() const { return out_; }

 private:
  std::vector<std::byte> out_;
};

/// Reads from a span and remembers when it was asked for more than there is; values are then zero.
class Reader {
 public:
  explicit Reader(Bytes bytes) : bytes_(bytes) {}

  std::uint8_t u8() { return has(1) ? std::to_integer<std::uint8_t>(bytes_[at_++]) : std::uint8_t{0}; }
  std::uint32_t u32() {
    std::uint32_t v = 0;
    if (!has(4)) return 0;
    for (int shift = 0; shift < 32; shift += 8) v |= std::uint32_t{u8()} << shift;
    return v;
  }
  double f64() {
    const std::uint64_t low = u32();
    const std::uint64_t high = u32();
    const double v = std::bit_cast<double>(high << 32 | low);
    if (!std::isfinite(v)) fine_ = false;
    return v;
  }
  std::string text() {
    const std::uint32_t size = u32();
    if (size > kMaxText || !has(size)) return fail(), std::string();
    const auto* begin = reinterpret_cast<const char*>(bytes_.data() + at_);
    at_ += size;
    return {begin, begin + size};
  }
  /// Number of entries of at least entry_bytes each.
  std::size_t list_size(std::size_t entry_bytes) {
    const std::uint32_t n = u32();
    if (n > kMaxList || !has(n * entry_bytes)) return fail(), std::size_t{0};
    return n;
  }
  image::Image picture() {
    const std::uint32_t width = u32();
    const std::uint32_t height = u32();
    constexpr std::uint32_t kSide = image::kMaxSidePx;
    if (width > kSide || height > kSide || !has(std::size_t{width} * height)) return fail(), image::Image();
    image::Image out(static_cast<int>(width), static_cast<int>(height));
    for (int y = 0; y < out.height(); ++y, at_ += width)
      std::transform(bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                     bytes_.begin() + static_cast<std::ptrdiff_t>(at_ + width), out.row(y),
                     [](std::byte b) { return std::to_integer<std::uint8_t>(b); });
    return out;
  }
  Range range() {
    const double lo = f64();
    return {lo, f64()};
  }
  [[nodiscard]] bool fine() const { return fine_; }
  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }

 private:
  bool has(std::size_t n) {
    if (n > bytes_.size() - at_) fine_ = false;
    return fine_;
  }
  void fail() { fine_ = false; }

  Bytes bytes_;
  std::size_t at_ = 0;
  bool fine_ = true;
};

void write_payload(Writer& out, const Model& m) {
  out.text(m.name);
  out.text(m.date);
  out.picture(m.picture);
  out.picture(m.mask);
  for (const double v : {m.ref_x_px, m.ref_y_px, m.roi_x_px, m.roi_y_px}) out.f64(v);
  out.range(m.angle_deg);
  out.range(m.scale);
  out.f64(m.height_m);
  out.list_size(m.grasps.size());
  for (const Grasp& g : m.grasps) {
    for (const double v : {g.x_px, g.y_px, g.angle_deg}) out.f64(v);
    out.u8(g.sym180 ? 1 : 0);
  }
  out.u32(static_cast<std::uint32_t>(m.learnt.symmetry_order));
  out.list_size(m.learnt.ambiguous_deg.size());
  for (const double v : m.learnt.ambiguous_deg) out.f64(v);
  out.f64(m.learnt.second_best_self_match);
  out.f64(m.learnt.suggested_min_score);
}

Model read_payload(Reader& in) {
  Model m;
  m.name = in.text();
  m.date = in.text();
  m.picture = in.picture();
  m.mask = in.picture();
  for (double* v : {&m.ref_x_px, &m.ref_y_px, &m.roi_x_px, &m.roi_y_px}) *v = in.f64();
  m.angle_deg = in.range();
  m.scale = in.range();
  m.height_m = in.f64();
  m.grasps.resize(in.list_size(25));
  for (Grasp& g : m.grasps) {
    for (double* v : {&g.x_px, &g.y_px, &g.angle_deg}) *v = in.f64();
    g.sym180 = in.u8() != 0;
  }
  m.learnt.symmetry_order = static_cast<int>(std::min<std::uint32_t>(in.u32(), 1u << 30));
  m.learnt.ambiguous_deg.resize(in.list_size(8));
  for (double& v : m.learnt.ambiguous_deg) v = in.f64();
  m.learnt.second_best_self_match = in.f64();
  m.learnt.suggested_min_score = in.f64();
  return m;
}

/// What teach guarantees, so that engines need not ask again. "" when all is well.
std::string contradiction(const Model& m) {
  if (m.picture.empty()) return "it holds no template picture";
  const bool masked = m.mask.width() != 0 || m.mask.height() != 0;
  if (masked && (m.mask.width() != m.picture.width() || m.mask.height() != m.picture.height()))
    return "its mask is not of the template's size";
  if (auto angles = check_angle_range("angles", m.angle_deg); !angles) return angles.error().why;
  if (auto scales = check_scale_range("scales", m.scale); !scales) return scales.error().why;
  if (m.learnt.symmetry_order < 1 || m.learnt.symmetry_order > 360) return "its symmetry order is not 1 to 360";
  if (m.learnt.suggested_min_score < 0 || m.learnt.suggested_min_score > 1) return "its threshold is not 0 to 1";
  return {};
}

tl::unexpected<core::Error> refuse(const std::string& name, const std::string& why) {
  return core::failure(core::ErrorCode::unreadable, name, why, "teach the part again or copy the file again");
}

}  // namespace

bool looks_like_model(Bytes bytes) {
  return bytes.size() >= kMagic.size() && std::equal(kMagic.begin(), kMagic.end(), bytes.begin(),
                                                     [](std::uint8_t m, std::byte b) { return std::byte{m} == b; });
}

std::vector<std::byte> encode_model(const Model& model) {
  Writer payload;
  write_payload(payload, model);
  Writer out;
  for (const std::uint8_t m : kMagic) out.u8(m);
  out.u32(kModelFileVersion);
  out.u32(static_cast<std::uint32_t>(payload.bytes().size()));
  out.append(payload.bytes());
  out.u32(core::crc32(out.bytes()));
  return out.bytes();
}

core::Result<Model> decode_model(Bytes bytes, const std::string& name) {
  if (!looks_like_model(bytes)) return refuse(name, "not a pickcell model, or its beginning is damaged");
  if (bytes.size() < kHeaderBytes + kCrcBytes) return refuse(name, "the model file is truncated");
  Reader header(bytes.subspan(kMagic.size(), 8));
  const std::uint32_t version = header.u32();
  if (version != kModelFileVersion)
    return core::failure(core::ErrorCode::unreadable, name,
                         "a model of version " + std::to_string(version) + ", this program reads version " +
                             std::to_string(kModelFileVersion),
                         "teach the part again with this program");
  if (header.u32() != bytes.size() - kHeaderBytes - kCrcBytes)
    return refuse(name, "the model file is truncated or damaged (its length does not fit)");
  if (Reader(bytes.last(kCrcBytes)).u32() != core::crc32(bytes.first(bytes.size() - kCrcBytes)))
    return refuse(name, "the model file is damaged (its checksum does not fit)");
  Reader payload(bytes.subspan(kHeaderBytes, bytes.size() - kHeaderBytes - kCrcBytes));
  Model model = read_payload(payload);
  if (!payload.fine() || !payload.at_end()) return refuse(name, "the model file's fields do not fit its length");
  if (const std::string why = contradiction(model); !why.empty()) return refuse(name, "not a valid model: " + why);
  return model;
}

core::Result<Model> load_model(const std::filesystem::path& path) {
  auto bytes = core::read_file(path);
  if (!bytes) return core::forward(bytes);
  return decode_model(*bytes, path.string());
}

core::Status save_model(const std::filesystem::path& path, const Model& model) {
  return core::write_file_atomically(path, encode_model(model));
}

}  // namespace pickcell::matches
