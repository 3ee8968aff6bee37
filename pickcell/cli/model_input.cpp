#include "pickcell/cli/model_input.hpp"

#include <chrono>
#include <ctime>
#include <filesystem>

#include "pickcell/core/file.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/matches/model_file.hpp"

namespace pickcell::cli {

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

core::Result<matches::Taught> teach_file(const std::string& file, const std::string& mask_file,
                                         matches::TeachInput how) {
  const auto picture = image::load_grey(file);
  if (!picture) return tl::unexpected(picture.error());
  image::Image mask;
  if (!mask_file.empty()) {
    auto loaded = image::load_grey(mask_file);
    if (!loaded) return core::forward(loaded);
    mask = std::move(*loaded);
    how.mask = mask.view();
  }
  how.picture = picture->view();
  if (how.name.empty()) how.name = std::filesystem::path(file).stem().string();
  if (how.date.empty()) how.date = utc_now();
  auto taught = matches::teach(how);
  if (!taught) {
    core::Error error = std::move(taught.error());
    const std::string& which = error.what == "mask" && !mask_file.empty() ? mask_file : file;
    if (error.what == "template" || error.what == "mask")
      error.what = which;
    else
      error.what = "--" + error.what;
    return tl::unexpected(std::move(error));
  }
  return taught;
}

core::Result<matches::Model> load_model_or_template(const std::string& file, const BareTemplate& how) {
  auto bytes = core::read_file(file);
  if (!bytes) return core::forward(bytes);
  if (matches::looks_like_model(*bytes) || std::filesystem::path(file).extension() == ".pcm") {
    if (!how.mask_file.empty())
      return core::failure(core::ErrorCode::usage, "--mask", file + " is a taught model and has its own mask",
                           "give --mask with a bare picture, or teach the part again");
    return matches::decode_model(*bytes, file);
  }
  matches::TeachInput input;
  input.angle_deg = how.angle_deg;
  input.scale = how.scale;
  auto taught = teach_file(file, how.mask_file, input);
  if (!taught) return core::forward(taught);
  return std::move(taught->model);
}

}  // namespace pickcell::cli
