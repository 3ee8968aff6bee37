#include <map>
#include <stdexcept>
#include <string>

#include "pickcell/sim/shape.hpp"

namespace pickcell::sim {

namespace {

/// Polylines on a grid 4 wide and 6 high (digit pairs x y, y up), separated by blanks.
const std::map<char, const char*>& strokes() {
  static const std::map<char, const char*> kTable{{'0', "011030414536160501"},
                                                  {'1', "152620 1030"},
                                                  {'2', "05163645440040"},
                                                  {'3', "0516364544334241301001"},
                                                  {'4', "30360242"},
                                                  {'5', "460603334241301001"},
                                                  {'6', "453616050110304142331302"},
                                                  {'7', "064620"},
                                                  {'8', "13040516364544331302011030414233"},
                                                  {'9', "011030414536160504133344"},
                                                  {'A', "002640 1232"},
                                                  {'B', "00063645443303 3342413000"},
                                                  {'C', "4536160501103041"},
                                                  {'D', "00062644422000"},
                                                  {'E', "46060040 0333"},
                                                  {'F', "460600 0333"},
                                                  {'G', "45361605011030414323"},
                                                  {'H', "0006 4046 0343"},
                                                  {'I', "2026 1030 1636"},
                                                  {'J', "4641301001"},
                                                  {'K', "0006 460340"},
                                                  {'L', "060040"},
                                                  {'M', "0006234640"},
                                                  {'N', "00064046"},
                                                  {'O', "011030414536160501"},
                                                  {'P', "00063645443303"},
                                                  {'Q', "011030414536160501 2240"},
                                                  {'R', "00063645443303 2340"},
                                                  {'S', "453616050413334241301001"},
                                                  {'T', "2026 0646"},
                                                  {'U', "060110304146"},
                                                  {'V', "062046"},
                                                  {'W', "0610233046"},
                                                  {'X', "0046 0640"},
                                                  {'Y', "062346 2320"},
                                                  {'Z', "06460040"},
                                                  {'-', "1333"},
                                                  {'.', "2021"},
                                                  {'/', "0046"},
                                                  {' ', ""}};
  return kTable;
}

}  // namespace

Shape lettering(std::string_view text, double h, double stroke) {
  const double unit = h / 6, advance = 5.6 * unit;
  const double left = -(advance * static_cast<double>(text.size()) - 1.6 * unit) / 2;
  std::vector<Shape> lines;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto found = strokes().find(text[i]);
    if (found == strokes().end()) throw std::invalid_argument(std::string("no strokes for the character ") + text[i]);
    const std::string path = found->second;
    const auto at = [&](std::size_t k) {
      return Point2(left + advance * static_cast<double>(i) + unit * (path[k] - '0'),
                    unit * (path[k + 1] - '0') - h / 2);
    };
    for (std::size_t k = 0; k + 1 < path.size(); k += path[k] == ' ' ? 1 : 2) {
      if (path[k] == ' ') continue;
      if (k + 3 < path.size() && path[k + 2] != ' ') lines.push_back(capsule(at(k), at(k + 2), stroke / 2));
    }
  }
  if (lines.empty()) throw std::invalid_argument("lettering without a visible character");
  return join(std::move(lines));
}

}  // namespace pickcell::sim
