#pragma once
/// Drives the hand-over against real registers and a real journal, and waits, on the caller's seat, for a job that
/// takes its time. Independent of the protocol that carries the registers.

#include <functional>
#include <optional>
#include <vector>

#include "pickcell/core/clock.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/robot/hand_over.hpp"
#include "pickcell/robot/journal.hpp"
#include "pickcell/robot/registers.hpp"

namespace pickcell::robot {

/// A pick as it goes to the controller.
struct PickCommand {
  CartesianPosition grasp, place;
  int part_class = 0;
  JournalRow row;  ///< detection, slot, model; the rest is filled in
};

/// One thread at a time. Errors: whatever registers and journal return (then connect() again); refused when a person
/// must look first (then confirm()); timeout when the job does not acknowledge the fence.
class PickSession {
 public:
  static constexpr core::Duration kPoll = std::chrono::milliseconds(50);
  static constexpr core::Duration kFenceTimeout = std::chrono::seconds(60);

  /// All three must outlive the session.
  PickSession(Registers& registers, Journal& journal, const core::Clock& clock)
      : registers_(registers), journal_(journal), clock_(clock) {}

  /// Reads back and raises the fence; does not wait. Refused when the journal does not know the controller's past.
  [[nodiscard]] core::Status connect();
  /// Waits until the fence is acknowledged and everything open is settled. While `job_runs` says that the job stands,
  /// there is nothing to wait for: returns, and the phase stays fencing.
  [[nodiscard]] core::Status settle(core::Seat& seat, const std::function<core::Result<bool>()>& job_runs);
  /// Raises the fence from ready or running; settle() next.
  [[nodiscard]] core::Status fence();
  /// A person has looked; settle() next.
  [[nodiscard]] core::Status confirm();
  [[nodiscard]] core::Result<std::int32_t> submit(const PickCommand& command);
  /// One look at the controller: the outcome of the submitted pick, or nothing while it runs.
  [[nodiscard]] core::Result<std::optional<Outcome>> outcome();
  /// What connect, settle, fence and confirm found out.
  [[nodiscard]] std::vector<Outcome> take_settled();
  /// The link broke: nothing is known until connect().
  void lost() { hand_over_.lost(); }

  [[nodiscard]] HandOverPhase phase() const { return hand_over_.phase(); }

 private:
  [[nodiscard]] core::Status drive();
  [[nodiscard]] core::Result<std::int32_t> perform(const HandOverStep& step);
  [[nodiscard]] core::Status verify(PoseRegister which, const CartesianPosition& wanted);
  [[nodiscard]] core::Status stopped() const;

  Registers& registers_;
  Journal& journal_;
  const core::Clock& clock_;
  HandOver hand_over_;
  PickCommand command_;
  std::vector<Outcome> settled_;
};

}  // namespace pickcell::robot
