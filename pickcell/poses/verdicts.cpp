#include "pickcell/poses/verdicts.hpp"

#include <cstdio>

namespace pickcell::poses {

Verdict judge(double value, const Bounds& bounds) {
  if (value <= bounds.excellent) return Verdict::excellent;
  if (value <= bounds.good) return Verdict::good;
  if (value <= bounds.usable) return Verdict::usable;
  return Verdict::reject;  // NaN too
}

void Judgement::add(Verdict verdict, std::string words) {
  if (verdict > worst_) worst_ = verdict;
  measures_.push_back({verdict, std::move(words)});
}

std::string Judgement::why() const {
  std::string out;
  for (const Measure& m : measures_)
    if (m.verdict == worst_) out += (out.empty() ? "" : "; ") + m.words;
  return out;
}

std::string figure(double value, int digits) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.*f", digits, value);
  return buffer;
}

}  // namespace pickcell::poses
