#include "pickcell/sim/answer_faults.hpp"

#include <algorithm>
#include <utility>

namespace pickcell::sim {

void AnswerFaults::inject(SpoiltAnswers fault) {
  const std::lock_guard lock(mutex_);
  faults_.push_back(std::move(fault));
}

std::optional<SpoiltAnswers> AnswerFaults::next(std::string_view command) {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(faults_.begin(), faults_.end(),
                                  [&](const SpoiltAnswers& f) { return f.command.empty() || f.command == command; });
  if (found == faults_.end()) return std::nullopt;
  SpoiltAnswers fault = *found;
  if (--found->count <= 0) faults_.erase(found);
  return fault;
}

}  // namespace pickcell::sim
