#include "pickcell/poses/board.hpp"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <optional>

namespace pickcell::poses {

namespace {

constexpr int kMaxSide = 200;
constexpr const char* kForm =
    "write chessboard:COLSxROWS:SQUARE, circles:COLSxROWS:SPACING, acircles:COLSxROWS:SPACING or "
    "charuco:COLSxROWS:SQUARE:MARKER:DICT, lengths with mm or m, like chessboard:9x6:25mm";

tl::unexpected<core::Error> refuse(std::string_view text, const std::string& why) {
  return core::failure(core::ErrorCode::usage, "board '" + std::string(text) + "'", why, kForm);
}

std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> out;
  while (true) {
    const std::size_t at = text.find(':');
    out.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return out;
    text.remove_prefix(at + 1);
  }
}

template <class T>
std::optional<T> number(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// A length in metres; needs a unit.
std::optional<double> length_m(std::string_view text) {
  double unit = 0;
  if (text.ends_with("mm")) {
    unit = 1e-3;
    text.remove_suffix(2);
  } else if (text.ends_with("m")) {
    unit = 1;
    text.remove_suffix(1);
  }
  const auto value = number<double>(text);
  if (unit == 0 || !value || !(*value * unit > 1e-5) || !(*value * unit < 10)) return std::nullopt;
  return *value * unit;
}

core::Status read_counts(Board& board, std::string_view text, std::string_view counts) {
  const std::size_t x = counts.find('x');
  const auto cols = number<int>(counts.substr(0, x));
  const auto rows = x == std::string_view::npos ? std::nullopt : number<int>(counts.substr(x + 1));
  if (!cols || !rows) return refuse(text, "'" + std::string(counts) + "' is not COLSxROWS");
  board.cols = *cols;
  board.rows = *rows;
  const int least = board.kind == BoardKind::charuco ? 3 : 2;
  if (*cols < least || *rows < least || *cols > kMaxSide || *rows > kMaxSide || board.points() < 4)
    return refuse(text, "such a board has too few or too many points");
  return {};
}

std::optional<BoardKind> kind_of(std::string_view name) {
  if (name == "chessboard") return BoardKind::chessboard;
  if (name == "circles") return BoardKind::circles;
  if (name == "acircles") return BoardKind::asymmetric_circles;
  if (name == "charuco") return BoardKind::charuco;
  return std::nullopt;
}

}  // namespace

core::Result<Board> parse_board(std::string_view text) {
  const auto fields = split(text);
  const auto kind = kind_of(fields[0]);
  if (!kind) return refuse(text, "'" + std::string(fields[0]) + "' is no kind of board");
  Board board;
  board.kind = *kind;
  board.text = text;
  const std::size_t wanted = *kind == BoardKind::charuco ? 5 : 3;
  if (fields.size() != wanted) return refuse(text, "it has " + std::to_string(fields.size()) + " fields");
  if (auto counts = read_counts(board, text, fields[1]); !counts) return core::forward(counts);
  const auto spacing = length_m(fields[2]);
  if (!spacing) return refuse(text, "'" + std::string(fields[2]) + "' is no length with its unit");
  board.spacing_m = *spacing;
  if (*kind != BoardKind::charuco) return board;
  const auto marker = length_m(fields[3]);
  if (!marker) return refuse(text, "'" + std::string(fields[3]) + "' is no length with its unit");
  if (*marker >= *spacing) return refuse(text, "the marker is not smaller than its square");
  board.marker_m = *marker;
  board.dictionary = fields[4];
  if (board.dictionary.starts_with("DICT_")) board.dictionary.erase(0, 5);
  return board;
}

std::vector<Eigen::Vector2d> board_points_m(const Board& board) {
  std::vector<Eigen::Vector2d> out;
  for (int row = 0; row < board.point_rows(); ++row)
    for (int col = 0; col < board.point_cols(); ++col) {
      const bool staggered = board.kind == BoardKind::asymmetric_circles;
      const int x = staggered ? 2 * col + row % 2 : col;
      out.emplace_back(x * board.spacing_m, row * board.spacing_m);
    }
  return out;
}

std::vector<std::vector<int>> board_symmetries(const Board& board) {
  const int cols = board.point_cols(), rows = board.point_rows();
  std::vector<int> same(static_cast<std::size_t>(board.points()));
  std::iota(same.begin(), same.end(), 0);
  const std::vector<int> half(same.rbegin(), same.rend());
  std::vector<std::vector<int>> out{same};
  switch (board.kind) {
    case BoardKind::charuco:
      return out;
    case BoardKind::asymmetric_circles:
      if (rows % 2 == 0) out.push_back(half);
      return out;
    case BoardKind::chessboard:
      if ((cols + rows) % 2 == 1) return out;
      break;
    case BoardKind::circles:
      break;
  }
  out.push_back(half);
  // A quarter turn: a square board, and a chessboard whose corner squares then all have one colour.
  if (cols != rows || (board.kind == BoardKind::chessboard && cols % 2 == 1)) return out;
  std::vector<int> quarter(same.size());
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col)
      quarter[static_cast<std::size_t>(row * cols + col)] = col * cols + (cols - 1 - row);
  out.push_back(quarter);
  std::reverse(quarter.begin(), quarter.end());
  out.push_back(quarter);
  return out;
}

BoardView renumbered(const BoardView& view, const std::vector<int>& new_index) {
  std::vector<std::pair<int, Eigen::Vector2d>> points;
  for (std::size_t i = 0; i < view.ids.size(); ++i)
    points.emplace_back(new_index[static_cast<std::size_t>(view.ids[i])], view.pixels[i]);
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  BoardView out;
  out.width_px = view.width_px;
  out.height_px = view.height_px;
  for (const auto& [id, pixel] : points) {
    out.ids.push_back(id);
    out.pixels.push_back(pixel);
  }
  return out;
}

}  // namespace pickcell::poses
