#pragma once
/// Answers that a scenario spoils, shared by the doors of the simulated controller.

#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace pickcell::sim {

/// What can go wrong with an answer; the command itself has been carried out.
enum class AnswerFault {
  drop,            ///< no result
  twice,           ///< the result two times
  late,            ///< after delay_s
  half_line,       ///< the first half of the result, then silence
  truncate,        ///< the first half of the result, then a TCP connection is closed
  reset_after_ok,  ///< TCP reset after the OK line; over UDP: no result
};

struct SpoiltAnswers {
  AnswerFault kind = AnswerFault::drop;
  int count = 1;        ///< this many answers
  std::string command;  ///< only to this command; empty: to any
  double delay_s = 2;   ///< wall time, for late
};

/// Thread-safe.
class AnswerFaults {
 public:
  void inject(SpoiltAnswers fault);
  /// The fault of the answer to this command, if any; counts it.
  [[nodiscard]] std::optional<SpoiltAnswers> next(std::string_view command);

 private:
  std::mutex mutex_;
  std::deque<SpoiltAnswers> faults_;
};

}  // namespace pickcell::sim
