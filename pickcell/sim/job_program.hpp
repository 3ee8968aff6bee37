#pragma once
/// A taught job as INFORM text, parsed into instructions one per line (docs/yaskawa-protocols 4.2): the subset that
/// vision cells use. Pure: no state, no clock.

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "pickcell/sim/position.hpp"

namespace pickcell::sim {

/// A variable, contact or constant in an instruction.
struct Operand {
  enum class Kind : std::uint8_t { none, number, text, B, I, D, R, S, P, C, IN, OT };
  Kind kind = Kind::none;
  int index = 0;
  double number = 0;  ///< constants; ON is 1, OFF is 0
  std::string text;
};

enum class Compare : std::uint8_t { equal, not_equal, less, greater, less_equal, greater_equal };

/// Comparisons joined by AND, or by OR; never both.
struct Condition {
  struct Term {
    Operand left;
    Compare compare = Compare::equal;
    Operand right;
  };
  std::vector<Term> terms;
  bool any = false;
};

enum class Op : std::uint8_t {
  nop,
  end,
  label,
  comment,
  jump,
  call,
  ret,
  set,
  add,
  sub,
  mul,
  div,
  inc,
  dec,
  get_element,
  set_element,
  move_joint,
  move_line,
  timer,
  output,
  wait,
  pause,
  if_then,
  else_if,
  otherwise,
  end_if,
  while_do,
  end_while
};

/// One line after //INST.
struct Instruction {
  Op op = Op::nop;
  Operand a, b;                        ///< destination and source, or the position of a move
  int element = 0;                     ///< GETE, SETE: 1..6
  std::optional<Condition> condition;  ///< of IF, WAIT, IFTHENEXP, WHILEEXP
  std::size_t target = 0;              ///< line to go to: label, next branch when the test fails, head of the loop
  std::size_t exit = 0;                ///< of a branch that was run: its ENDIF
  double value = 0;                    ///< VJ in %, V in mm/s, VR in deg/s, T in s
  bool turning = false;                ///< MOVL with VR
  std::string text;                    ///< label of JUMP, job of CALL
};

struct JobProgram {
  std::string name;
  std::string text;                     ///< as loaded
  std::vector<Instruction> lines;       ///< line 0 is NOP, the last one END
  std::map<int, Position> taught;       ///< C
  std::map<int, Position> p_variables;  ///< P of //POS: loaded into the controller's P variables
  /// Number of motion instructions up to and including a line.
  [[nodiscard]] int step_at(std::size_t line) const;
};

/// Why a job text was not taken; numbers as in docs/yaskawa-protocols 2.7.
struct JobError {
  int number =
      0;         ///< 5110 syntax, 5120 position data, 5130 NOP or END missing, 4190 job name, 4200 label, 4230 unknown
  int line = 0;  ///< of the text, from 1
  std::string why;
};

/// Lines must end with CR LF, as on a controller: with bare LF its NOP is not found (5130).
[[nodiscard]] tl::expected<JobProgram, JobError> parse_job(std::string_view text);

}  // namespace pickcell::sim
