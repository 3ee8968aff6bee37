#include "pickcell/matches/match.hpp"

namespace pickcell::matches {

const char* name(RejectReason reason) {
  switch (reason) {
    case RejectReason::score:
      return "score";
    case RejectReason::overlap:
      return "overlap";
    case RejectReason::contrast:
      return "contrast";
    case RejectReason::border:
      return "border";
    case RejectReason::budget:
      return "budget";
    case RejectReason::scale:
      return "scale";
    case RejectReason::limit:
      return "limit";
  }
  return "score";
}

const char* name(Stage stage) {
  switch (stage) {
    case Stage::coarse:
      return "coarse";
    case Stage::fine:
      return "fine";
    case Stage::final:
      return "final";
    case Stage::circular:
      return "circular";
    case Stage::radial:
      return "radial";
    case Stage::templates:
      return "template";
    case Stage::robust:
      return "robust";
    case Stage::merge:
      return "merge";
  }
  return "final";
}

}  // namespace pickcell::matches
