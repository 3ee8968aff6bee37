#pragma once
/// One connection to the simulated Ethernet Server as a byte parser: no sockets, no controller
/// (docs/yaskawa-protocols 1.1).

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace pickcell::sim {

/// Takes what a client sends, in pieces of any size, and says what to do next. Lines may end with CR, LF or CRLF; one
/// LF left over after operands is swallowed; empty lines between commands are ignored. Operands are exactly as many
/// bytes as the header announced: until they are there, nothing happens.
class Tcp80Session {
 public:
  static constexpr std::size_t kLongestLine = 256;
  static constexpr std::size_t kLongestOperands = 2048;

  /// banner: NX, DX or YR.
  explicit Tcp80Session(std::string banner) : banner_(std::move(banner)) {}

  struct Command {
    std::string name;
    std::string operands;
  };
  /// Send `say`; then carry out `command` and send its answer; then close when `close`.
  struct Step {
    std::string say;
    std::optional<Command> command;
    bool close = false;
  };

  void feed(std::string_view bytes);
  /// Bytes taken and not yet used: more than kEnough means the host should wait.
  [[nodiscard]] std::size_t backlog() const { return bytes_.size(); }
  static constexpr std::size_t kEnough = 4 * kLongestOperands;
  /// Nothing when more bytes are needed, or after a step that closed.
  [[nodiscard]] std::optional<Step> next();

 private:
  enum class State { greeting, header, operands, closed };
  [[nodiscard]] std::optional<std::string> take_line();
  [[nodiscard]] Step greet(std::string_view line);
  [[nodiscard]] Step header(std::string_view line);
  [[nodiscard]] Step refuse(std::string text);
  [[nodiscard]] Step command(std::string operands);

  std::string banner_;
  std::string bytes_;
  State state_ = State::greeting;
  bool swallow_lf_ = false;
  std::string pending_name_;
  std::size_t pending_size_ = 0;
  int commands_left_ = 1;  ///< -1: no limit
};

}  // namespace pickcell::sim
