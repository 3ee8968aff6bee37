#include "pickcell/cell/halt.hpp"

namespace pickcell::cell {

using core::ErrorCode;

namespace {

struct Kind {
  const char* code;
  const char* remedy;  ///< when the error has none of its own
};

Kind kind_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::link:
      return {"LINK_LOST", "check the controller's power and the cable, then press Reset"};
    case ErrorCode::timeout:
      return {"LINK_TIMEOUT", "check the controller and the network, then press Reset"};
    case ErrorCode::refused:
      return {"ROBOT_REFUSED", "remove the cause at the controller, then press Reset"};
    case ErrorCode::safety:
      return {"SAFETY", "check the limits in the cell file"};
    case ErrorCode::device:
      return {"CAMERA", "check the camera and its cable, then press Reset"};
    case ErrorCode::unreadable:
      return {"RECORD", "check the disk of the state folder, then press Reset"};
    case ErrorCode::usage:
    case ErrorCode::negative:
      break;
  }
  return {"FAILED", "press Reset"};
}

}  // namespace

Halt halt_from(const core::Error& error, const std::string& doing) {
  const Kind kind = kind_of(error.code);
  std::string why = doing + ": " + (error.what.empty() ? error.why : error.what + ": " + error.why);
  return {Mode::fault, kind.code, std::move(why), error.remedy.empty() ? kind.remedy : error.remedy, false};
}

Halt halt_from(const Hindrance& hindrance) {
  return {Mode::fault, hindrance.code, hindrance.why, hindrance.remedy, false};
}

}  // namespace pickcell::cell
