#include "pickcell/frames/pixel_format.hpp"

#include <cstdio>

namespace pickcell::frames {

namespace {

constexpr PixelFormat whole(std::uint32_t code, std::string_view name, int bits, Mosaic mosaic = Mosaic::none) {
  return {code, name, bits > 8 ? 16 : 8, bits, Packing::whole, mosaic};
}
constexpr PixelFormat lsb(std::uint32_t code, std::string_view name, int bits, Mosaic mosaic = Mosaic::none) {
  return {code, name, bits, bits, Packing::lsb, mosaic};
}
constexpr PixelFormat gige(std::uint32_t code, std::string_view name, int bits, Mosaic mosaic = Mosaic::none) {
  return {code, name, 12, bits, Packing::gige, mosaic};
}
constexpr PixelFormat colour(std::uint32_t code, std::string_view name, int bytes, int r, int g, int b) {
  return {code, name, 8 * bytes, 8, Packing::interleaved, Mosaic::none, r, g, b, -1};
}
constexpr PixelFormat luma(std::uint32_t code, std::string_view name, int bytes, int y) {
  return {code, name, 8 * bytes, 8, Packing::interleaved, Mosaic::none, -1, -1, -1, y};
}

constexpr PixelFormat kFormats[] = {
    whole(kMono8, "Mono8", 8),
    whole(kMono10, "Mono10", 10),
    whole(kMono12, "Mono12", 12),
    whole(0x01100025, "Mono14", 14),
    whole(kMono16, "Mono16", 16),
    lsb(0x010a0046, "Mono10p", 10),
    lsb(0x010c0047, "Mono12p", 12),
    gige(0x010c0004, "Mono10Packed", 10),
    gige(0x010c0006, "Mono12Packed", 12),
    whole(0x01080008, "BayerGR8", 8, Mosaic::gr),
    whole(0x01080009, "BayerRG8", 8, Mosaic::rg),
    whole(0x0108000a, "BayerGB8", 8, Mosaic::gb),
    whole(0x0108000b, "BayerBG8", 8, Mosaic::bg),
    whole(0x0110000c, "BayerGR10", 10, Mosaic::gr),
    whole(0x0110000d, "BayerRG10", 10, Mosaic::rg),
    whole(0x0110000e, "BayerGB10", 10, Mosaic::gb),
    whole(0x0110000f, "BayerBG10", 10, Mosaic::bg),
    whole(0x01100010, "BayerGR12", 12, Mosaic::gr),
    whole(0x01100011, "BayerRG12", 12, Mosaic::rg),
    whole(0x01100012, "BayerGB12", 12, Mosaic::gb),
    whole(0x01100013, "BayerBG12", 12, Mosaic::bg),
    whole(0x0110002e, "BayerGR16", 16, Mosaic::gr),
    whole(0x0110002f, "BayerRG16", 16, Mosaic::rg),
    whole(0x01100030, "BayerGB16", 16, Mosaic::gb),
    whole(0x01100031, "BayerBG16", 16, Mosaic::bg),
    lsb(0x010a0056, "BayerGR10p", 10, Mosaic::gr),
    lsb(0x010a0058, "BayerRG10p", 10, Mosaic::rg),
    lsb(0x010a0054, "BayerGB10p", 10, Mosaic::gb),
    lsb(0x010a0052, "BayerBG10p", 10, Mosaic::bg),
    lsb(0x010c0057, "BayerGR12p", 12, Mosaic::gr),
    lsb(0x010c0059, "BayerRG12p", 12, Mosaic::rg),
    lsb(0x010c0055, "BayerGB12p", 12, Mosaic::gb),
    lsb(0x010c0053, "BayerBG12p", 12, Mosaic::bg),
    gige(0x010c0026, "BayerGR10Packed", 10, Mosaic::gr),
    gige(0x010c0027, "BayerRG10Packed", 10, Mosaic::rg),
    gige(0x010c0028, "BayerGB10Packed", 10, Mosaic::gb),
    gige(0x010c0029, "BayerBG10Packed", 10, Mosaic::bg),
    gige(0x010c002a, "BayerGR12Packed", 12, Mosaic::gr),
    gige(0x010c002b, "BayerRG12Packed", 12, Mosaic::rg),
    gige(0x010c002c, "BayerGB12Packed", 12, Mosaic::gb),
    gige(0x010c002d, "BayerBG12Packed", 12, Mosaic::bg),
    colour(kRgb8, "RGB8", 3, 0, 1, 2),
    colour(kBgr8, "BGR8", 3, 2, 1, 0),
    colour(0x02200016, "RGBa8", 4, 0, 1, 2),
    colour(0x02200017, "BGRa8", 4, 2, 1, 0),
    luma(kYuyv, "YUV422_8", 2, 0),
    luma(kUyvy, "YUV422_8_UYVY", 2, 1),
};

}  // namespace

const PixelFormat* pixel_format(std::uint32_t code) {
  for (const PixelFormat& format : kFormats)
    if (format.code == code) return &format;
  return nullptr;
}

const PixelFormat* pixel_format(std::string_view name) {
  for (const PixelFormat& format : kFormats)
    if (format.name == name) return &format;
  return nullptr;
}

std::string format_name(std::uint32_t code) {
  if (const PixelFormat* format = pixel_format(code)) return std::string(format->name);
  if (code == kJpeg) return "JPEG";
  char text[16];
  std::snprintf(text, sizeof text, "0x%08x", code);
  return text;
}

std::string known_formats() {
  std::string list;
  for (const PixelFormat& format : kFormats) list += (list.empty() ? "" : ", ") + std::string(format.name);
  return list;
}

}  // namespace pickcell::frames
