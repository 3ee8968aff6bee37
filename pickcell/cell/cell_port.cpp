#include "pickcell/cell/cell_port.hpp"

namespace pickcell::cell {

const char* name(Mode mode) {
  switch (mode) {
    case Mode::idle:
      return "idle";
    case Mode::running:
      return "running";
    case Mode::stopping:
      return "stopping";
    case Mode::fault:
      return "fault";
  }
  return "fault";
}

const char* name(DetectionState state) {
  switch (state) {
    case DetectionState::found:
      return "found";
    case DetectionState::queued:
      return "queued";
    case DetectionState::picking:
      return "picking";
    case DetectionState::placed:
      return "placed";
    case DetectionState::missed:
      return "missed";
    case DetectionState::unknown:
      return "unknown";
    case DetectionState::rejected:
      return "rejected";
  }
  return "unknown";
}

}  // namespace pickcell::cell
