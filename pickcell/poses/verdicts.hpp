#pragma once
/// Which figure deserves which verdict (docs/calibration.md), and the worst of several.

#include <string>
#include <vector>

#include "pickcell/poses/calibration.hpp"

namespace pickcell::poses {

/// Bounds of one measure; beyond usable it is a reject. Smaller is better.
struct Bounds {
  double excellent, good, usable;
};

[[nodiscard]] Verdict judge(double value, const Bounds& bounds);

/// Measures that together give a verdict: the worst one decides and is named.
class Judgement {
 public:
  /// words: the measure with its figure, "hold-out error 0.21 px".
  void add(Verdict verdict, std::string words);
  [[nodiscard]] Verdict verdict() const { return worst_; }
  /// The words of every measure that stands at the worst verdict, joined by "; ".
  [[nodiscard]] std::string why() const;

 private:
  struct Measure {
    Verdict verdict;
    std::string words;
  };
  std::vector<Measure> measures_;
  Verdict worst_ = Verdict::excellent;
};

/// A number in words with so many digits after the point.
[[nodiscard]] std::string figure(double value, int digits);

}  // namespace pickcell::poses
