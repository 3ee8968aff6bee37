#pragma once
/// How ordinary failure travels: a Result holds a value or an Error that says what failed, why, and what to do about
/// it. A caller's fault (a broken precondition) is thrown instead.

#include <string>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

namespace pickcell::core {

/// What kind of failure; decides the exit code of the command line (docs/interfaces.md).
enum class ErrorCode {
  usage,       ///< the request itself is wrong: unknown option, value out of range
  unreadable,  ///< a file or its content cannot be read or written, or is damaged
  negative,    ///< it ran, but the asked-for result is not there: no board found, calibration rejected
  device,      ///< a camera or another device failed
  link,        ///< connection refused or lost
  timeout,     ///< no answer within the deadline
  refused,     ///< the other side understood and said no
  safety,      ///< outside a limit that protects the arm or people
};

/// One failure, in words for a person. Printed as `pickcell: WHAT: why; remedy`.
struct Error {
  ErrorCode code;
  std::string what;                ///< the thing that failed: a file, a host, a command
  std::string why;                 ///< the reason
  std::string remedy;              ///< what to do; may be empty
  std::vector<std::string> trail;  ///< the last messages exchanged, oldest first, where there are any

  /// `WHAT: why; remedy` on one line: line ends inside are replaced by blanks.
  [[nodiscard]] std::string line() const;
};

/// 2 for usage and unreadable input, 3 for device, link, timeout, refused and safety, 1 for a negative result.
[[nodiscard]] int exit_code(ErrorCode code);

template <class T>
class [[nodiscard]] Result : public tl::expected<T, Error> {
 public:
  using tl::expected<T, Error>::expected;
};

using Status = Result<void>;

[[nodiscard]] inline tl::unexpected<Error> failure(ErrorCode code, std::string what, std::string why,
                                                   std::string remedy = {}) {
  return tl::unexpected<Error>(Error{code, std::move(what), std::move(why), std::move(remedy), {}});
}

/// Hands an error on unchanged: `if (!r) return forward(r);`
template <class T>
[[nodiscard]] tl::unexpected<Error> forward(Result<T>& failed) {
  return tl::unexpected<Error>(std::move(failed.error()));
}

}  // namespace pickcell::core
