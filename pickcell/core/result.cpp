#include "pickcell/core/result.hpp"

#include <algorithm>

namespace pickcell::core {

std::string Error::line() const {
  std::string text = what + ": " + why;
  if (!remedy.empty()) text += "; " + remedy;
  std::replace_if(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return text;
}

int exit_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::usage:
    case ErrorCode::unreadable:
      return 2;
    case ErrorCode::negative:
      return 1;
    case ErrorCode::device:
    case ErrorCode::link:
    case ErrorCode::timeout:
    case ErrorCode::refused:
    case ErrorCode::safety:
      return 3;
  }
  return 2;
}

}  // namespace pickcell::core
