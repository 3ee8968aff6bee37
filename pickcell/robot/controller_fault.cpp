#include "pickcell/robot/controller_fault.hpp"

#include <algorithm>
#include <iterator>

namespace pickcell::robot {
namespace {

constexpr std::string_view kOurs = "report this: the request is built by pickcell";
constexpr std::string_view kWait = "wait until the other command has ended and try again";
constexpr std::string_view kLook = "see the message on the pendant";
constexpr std::string_view kJobFile = "check the job file: CRLF line ends, NOP first, END last";

// Sorted by code.
constexpr ControllerFault kFaults[] = {
    {0x1010, "bad command", kOurs},
    {0x1011, "wrong number of operands", kOurs},
    {0x1012, "operand out of range", "check variable numbers, contact numbers and speeds against the controller"},
    {0x1013, "wrong operand length", kOurs},
    {0x1020, "too many files on the controller", "delete jobs that are not needed"},
    {0x2010, "the robot is moving", "wait until the job or move has ended, or hold it"},
    {0x2020, "held from the pendant", "release HOLD on the pendant"},
    {0x2030, "held from the panel", "release HOLD on the playback panel"},
    {0x2040, "held by an external signal", "release the external hold input"},
    {0x2050, "held by command", "release the hold (Reset)"},
    {0x2060, "an error or alarm is present", "read the alarm, remove its cause, then Reset"},
    {0x2070, "servo power is off", "switch the servo on"},
    {0x2080, "wrong mode", "turn the key switch to REMOTE (play)"},
    {0x2090, "the file is in use", kWait},
    {0x2100, "command remote is not set",
     "select command remote on the pseudo-input screen and turn the key to REMOTE"},
    {0x2110, "the data cannot be accessed", kLook},
    {0x2120, "the data cannot be loaded", kLook},
    {0x2130, "the data is being edited", "leave the editor on the pendant"},
    {0x2150, "coordinate conversion is running", kWait},
    {0x3010, "the servo must be switched on first", "switch the servo on"},
    {0x3040, "the home position is not confirmed", "carry out the home position check at the pendant"},
    {0x3050, "the position is not confirmed", "carry out the position check (second home) at the pendant"},
    {0x3070, "no current value", kLook},
    {0x3220, "the panel is locked: mode cannot change", "release the panel lock"},
    {0x3230, "the panel is locked: start is forbidden", "release the panel lock"},
    {0x3350, "the user frame is not taught", "teach the user frame or configure the base frame"},
    {0x3360, "the user frame is broken", "teach the user frame again"},
    {0x3370, "control group mismatch", "use a job of the robot's control group"},
    {0x3380, "base axis mismatch", "use a job of the robot's control group"},
    {0x3390, "relative job refused", kLook},
    {0x3400, "master call refused", kLook},
    {0x3410, "master call refused", kLook},
    {0x3420, "master call refused", kLook},
    {0x3430, "calibration refused", kLook},
    {0x3450, "the servo cannot be switched on", "check emergency stops, doors and the external-servo-on input"},
    {0x3460, "the frame cannot be set", kLook},
    {0x4010, "job memory is full", "delete jobs that are not needed"},
    {0x4012, "position memory is full", "delete jobs that are not needed"},
    {0x4020, "editing is forbidden", "release the edit lock of the job"},
    {0x4030, "the job name exists already", "delete the old job first"},
    {0x4040, "no such job", "load VISPICK.JBI onto the controller"},
    {0x4060, "no job to run is set", "select the job on the pendant"},
    {0x4120, "position data is broken", "load the job again"},
    {0x4130, "position data is missing",
     "write the position variable or teach the step; of a move: choose a place within reach"},
    {0x4140, "wrong type of position variable", "the P variables of the hand-over must be cartesian or unused"},
    {0x4150, "END of a job that is not the master", kJobFile},
    {0x4170, "instruction data is broken", "load the job again"},
    {0x4190, "bad character in a job name", "job names: at most 32 characters, upper case"},
    {0x4200, "bad character in a label", kJobFile},
    {0x4230, "an instruction this controller does not have", kJobFile},
    {0x4420, "conversion of a relative job failed", kLook},
    {0x4430, "conversion of a relative job failed", kLook},
    {0x4480, "conversion of a relative job failed", kLook},
    {0x4490, "conversion of a relative job failed", kLook},
    {0x5110, "syntax error in an instruction", kJobFile},
    {0x5120, "error in position data", kJobFile},
    {0x5130, "NOP or END is missing", kJobFile},
    {0x5170, "format error", kJobFile},
    {0x5180, "wrong number of data", kJobFile},
    {0x5200, "data out of range", kJobFile},
    {0x5310, "syntax error", kJobFile},
    {0x5340, "error in a pseudo instruction", kJobFile},
    {0x5370, "error in a condition file", kLook},
    {0x5390, "error in job data", kJobFile},
    {0x5430, "error in system data", kLook},
    {0x5480, "wrong welder type", kLook},
    {0xA000, "unknown command", kOurs},
    {0xA001, "there is no such number", "check the number of the variable, contact or task against the controller"},
    {0xA002, "unknown attribute", kOurs},
    {0xA100, "answer too large", kOurs},
    {0xA101, "answer too large", kOurs},
    {0xB001, "position variable undefined", "write the position variable first"},
    {0xB002, "use of this position variable is forbidden", kLook},
    {0xB003, "position data has the wrong size", kOurs},
    {0xB004, "position data out of range", "check the pose against the reach of the arm"},
    {0xB005, "position variable undefined", "write the position variable first"},
    {0xB006, "wrong application", kLook},
    {0xB007, "wrong type of position", kOurs},
    {0xB008, "wrong control group", kLook},
    {0xB009, "wrong speed", "lower the speed"},
    {0xB00A, "speed missing", kOurs},
    {0xB00B, "wrong coordinate frame", "check the configured frame number"},
    {0xB00C, "wrong form", "check the configured form"},
    {0xB00D, "wrong tool number", "check the configured tool number"},
    {0xB00E, "wrong user frame", "check the configured user frame"},
    {0xD8F1, "busy with another command", kWait},
    {0xD8FA, "busy, exclusive control", kWait},
    {0xE28B, "file transfer timed out", "try again"},
    {0xE28C, "the file cannot be overwritten", "delete it first"},
    {0xE29C, "the file is empty or missing", "check the file name"},
    {0xE2A7, "the file is not in the list", "check the file name"},
    {0xE2AF, "the file cannot be deleted", "check that the job is not in use"},
    {0xE2B2, "file transfer needs remote mode", "turn the key switch to REMOTE"},
    {0xE2B3, "file not found", "check the file name"},
    {0xE2B4, "file name too long", "shorten it to 32 characters"},
    {0xE444, "busy with another command", kWait},
    {0xE49D, "frame of size 0", kOurs},
    {0xE49E, "frame too long", kOurs},
    {0xE4A1, "wrong block number", kOurs},
    {0xE4A2, "wrong ACK field", kOurs},
    {0xE4A3, "wrong division", kOurs},
    {0xE4A5, "wrong header size", kOurs},
    {0xE4A6, "wrong identifier", kOurs},
    {0xE4A7, "sizes differ", kOurs},
    {0xFFF6, "too many requests", "poll more slowly"},
    {0xFFFE, "the controller left remote mode", "turn the key switch to REMOTE"},
};

}  // namespace

ControllerFault controller_fault(std::uint16_t code) {
  const auto* found = std::ranges::lower_bound(kFaults, code, {}, &ControllerFault::code);
  if (found != std::end(kFaults) && found->code == code) return *found;
  if (code >= 0x6010 && code <= 0x6140) return {code, "robot in operation, or a device or backup fault", kLook};
  if (code >= 0xC001 && code <= 0xCFFF) return {code, "internal error of the controller", kLook};
  return {code, "unknown refusal", kLook};
}

}  // namespace pickcell::robot
