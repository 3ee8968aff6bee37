#include "pickcell/cli/calibrate/pictures.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>
#include <ostream>
#include <thread>

#include "pickcell/core/clock.hpp"
#include "pickcell/core/date.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/poses/board_detect.hpp"

namespace pickcell::cli {

namespace {

core::Result<BoardPicture> find_board(const std::filesystem::path& path, const poses::Board& board) {
  auto picture = image::load_grey(path);
  if (!picture) return core::forward(picture);
  return BoardPicture{path, path.string(), picture->width(), picture->height(),
                      poses::detect_board(picture->view(), board, path.string())};
}

}  // namespace

core::Result<std::vector<BoardPicture>> find_boards(const std::vector<std::filesystem::path>& paths,
                                                    const poses::Board& board) {
  std::vector<std::optional<core::Result<BoardPicture>>> found(paths.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < paths.size(); i = next++) found[i] = find_board(paths[i], board);
  };
  std::vector<std::jthread> others(std::max(1u, std::thread::hardware_concurrency()) - 1);
  for (std::jthread& t : others) t = std::jthread(work);
  work();
  others.clear();
  std::vector<BoardPicture> out;
  for (auto& one : found) {
    if (!*one) return core::forward(*one);
    if (!(*one)->view && (*one)->view.error().code == core::ErrorCode::usage) return core::forward((*one)->view);
    out.push_back(std::move(**one));
  }
  return out;
}

core::Error no_board(const std::vector<BoardPicture>& pictures, const poses::Board& board) {
  const BoardPicture& first =
      *std::find_if(pictures.begin(), pictures.end(), [](const BoardPicture& p) { return !p.view; });
  core::Error error = first.view.error();
  if (const auto picture = image::load_grey(first.path); picture)
    if (const std::string seen = poses::what_else_is_seen(picture->view(), board); !seen.empty())
      error.why += "; " + seen;
  if (pictures.size() > 1) error.what += " (as in all " + std::to_string(pictures.size()) + " pictures)";
  return error;
}

core::Json left_out_json(const std::vector<poses::LeftOut>& left_out) {
  core::Json out = core::Json::array();
  for (const poses::LeftOut& l : left_out) {
    core::Json entry = core::Json::object();
    out.push(entry.set("image", l.image).set("reason", l.reason));
  }
  return out;
}

std::string today() { return core::iso_utc(core::RealClock().unix_us()); }

core::Json matrix_json(const Eigen::Matrix4d& matrix) {
  core::Json out = core::Json::array();
  for (int r = 0; r < 4; ++r) {
    core::Json row = core::Json::array();
    for (int c = 0; c < 4; ++c) row.push(matrix(r, c));
    out.push(row);
  }
  return out;
}

core::Error rejected(core::Error error, bool json, std::ostream& out) {
  if (json && error.code == core::ErrorCode::negative) {
    core::Json line = core::Json::object();
    out << line.set("verdict", "reject").set("why", error.line()).dump() << "\n";
  }
  return error;
}

}  // namespace pickcell::cli
