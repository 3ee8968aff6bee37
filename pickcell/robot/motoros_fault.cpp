#include "pickcell/robot/motoros_fault.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

namespace pickcell::robot {

namespace {

struct Row {
  std::int32_t code;
  std::string_view meaning, remedy;
};

constexpr std::string_view kOurs = "report this: the message is built by pickcell";
constexpr std::string_view kRemote = "turn the key to REMOTE and select command remote (pseudo-input screen)";

constexpr Row kResults[] = {
    {1, "busy", "send it again"},
    {2, "refused", "see the state of the controller"},
    {3, "invalid", kOurs},
    {4, "alarm", "read the alarm, remove its cause, then reset"},
    {5, "not ready", "see the state of the controller"},
    {6, "the controller's own call failed", "see the message on the pendant"},
};

constexpr Row kSubcodes[] = {
    {3000, "unspecified", kOurs},
    {3001, "wrong message size", kOurs},
    {3002, "wrong header", kOurs},
    {3003, "unknown message type", "this MotoROS may be too old"},
    {3004, "no such control group", "configure the group of the robot"},
    {3005, "wrong sequence number", kOurs},
    {3006, "unknown command", "this MotoROS may be too old"},
    {3010, "bad data", kOurs},
    {3011, "the trajectory does not start where the arm is", "read the position again; the arm may have been moved"},
    {3012, "position outside the limits", "check the target against the reach of the arm"},
    {3013, "an axis would be too fast", "lower the speed"},
    {3014, "acceleration too great", "lower the speed"},
    {3015, "time, position or velocity missing", kOurs},
    {3016, "bad time", kOurs},
    {3017, "no such tool", "tools are 0 to 63"},
    {5000, "unspecified", "see the pendant"},
    {5001, "the controller is in alarm", "read the alarm, remove its cause, then reset"},
    {5002, "the controller reports an error", "see the pendant, then reset"},
    {5003, "emergency stop", "release the emergency stop"},
    {5004, "not in play mode", "turn the key switch to REMOTE (play)"},
    {5005, "command remote is not set", kRemote},
    {5006, "servo power is off", "switch the servo on"},
    {5007, "held", "release the hold"},
    {5008, "the job INIT_ROS does not run", "start the trajectory mode; is INIT_ROS on the controller?"},
    {5009, "another job runs, or INIT_ROS is not at its wait", "let the other job end, then start again"},
    {5010, "the skill was not sent", "check INIT_ROS (DX100 needs SKILLSND)"},
    {5011, "force limiting is active", "clear the collision, then start the trajectory mode again"},
    {5012, "the controller rejected an increment", "start the trajectory mode again"},
};

constexpr Row kIo[] = {
    {1001, "this address cannot be read", "check the contact number against the controller"},
    {1002, "this address cannot be written", "network inputs, general outputs and registers 0 to 559 can"},
    {1003, "this value is not possible there", "a bit takes 0 or 1, a group 0 to 255, a register 0 to 65535"},
    {1004, "the controller could not read it", "see the message on the pendant"},
    {1005, "the controller could not write it", "see the message on the pendant"},
};

template <std::size_t N>
const Row* find(const Row (&rows)[N], std::int32_t code) {
  const Row* row = std::ranges::find(rows, code, &Row::code);
  return row == std::end(rows) ? nullptr : row;
}

}  // namespace

MotoFault moto_fault(std::int32_t result, std::int32_t subcode) {
  const Row* high = find(kResults, result);
  const Row* low = find(kSubcodes, subcode);
  MotoFault fault;
  fault.meaning = high ? std::string(high->meaning) : "result " + std::to_string(result);
  fault.remedy = low ? low->remedy : high ? high->remedy : "see the pendant";
  if (subcode != 0) fault.meaning += " (" + std::to_string(subcode) + ")";
  if (low) fault.meaning += ": " + std::string(low->meaning);
  return fault;
}

MotoFault moto_io_fault(std::int32_t result) {
  const Row* row = find(kIo, result);
  if (!row) return {"I/O result " + std::to_string(result), "see the pendant"};
  return {std::string(row->meaning) + " (" + std::to_string(result) + ")", std::string(row->remedy)};
}

}  // namespace pickcell::robot
