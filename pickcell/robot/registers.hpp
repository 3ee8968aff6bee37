#pragma once
/// The controller variables of the hand-over, by what they mean. Source: docs/yaskawa-protocols.md 4.1; docs/robots.md.

#include <cstdint>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/position.hpp"

namespace pickcell::robot {

/// Scalars. The comment names the variable when the first one is number 10 (the default), and who writes it.
enum class Register {
  command,          ///< B010  PC sets 1; job sets 0 none, 2 taken, 3 done, 9 refused
  reason,           ///< B011  job: why 9, see RefusalReason
  clear_of_camera,  ///< B012  job: 1 = image allowed
  result,           ///< B013  job: 3 or 9, of the sequence in `done`
  part_class,       ///< I010  PC
  epoch,            ///< I011  PC: the fence, upwards only
  epoch_ack,        ///< I012  job: the fence as acknowledged by its waiting loop
  command_epoch,    ///< I013  PC: epoch of this command
  held_epoch,       ///< I014  job: EPOCH when it began to wait for a person; a higher one lets it go on
  sequence,         ///< D010  PC: number of this pick, never used twice; above 10000 * epoch
  done,             ///< D011  job: sequence last finished
  accepted,         ///< D012  job: sequence last accepted, set before any motion
  sequence_copy,    ///< D013  PC: written first; the job takes nothing while it differs from `sequence`
};
constexpr int kRegisters = 13;

enum class PoseRegister {
  grasp,  ///< P010
  place,  ///< P011
};

/// Values of Register::reason (our job VISPICK).
enum RefusalReason {
  kOutsideWindow = 1,
  kNothingGripped = 2,
  kLostOnTheWay = 3,
  kGripperNotEmpty = 4,
  kHeldGripperFull = 5,  ///< at the start of the job: waits for a person
  kOutcomeUnknown = 7,   ///< an accepted pick was interrupted: waits for a person
  kStale = 8,            ///< the command belongs to an older epoch or is half written
};

/// Reads and writes, each confirmed by the controller before the call returns. Nothing is ever repeated by itself.
class Registers {
 public:
  virtual ~Registers() = default;
  [[nodiscard]] virtual core::Result<std::int32_t> read(Register which) = 0;
  [[nodiscard]] virtual core::Status write(Register which, std::int32_t value) = 0;
  [[nodiscard]] virtual core::Result<VariablePosition> read_pose(PoseRegister which) = 0;
  [[nodiscard]] virtual core::Status write_pose(PoseRegister which, const CartesianPosition& position) = 0;
};

}  // namespace pickcell::robot
