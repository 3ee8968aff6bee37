#include "pickcell/robot/vispick_job.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

#include "pickcell/robot/hand_over.hpp"

namespace pickcell::robot {

namespace {

/// @n is the first variable's number plus n, three digits; {word} a setting.
constexpr std::string_view kTemplate = R"(/JOB
//NAME {name}
//POS
///NPOS 0,0,0,1,0,0
///TOOL {tool}
///POSTYPE BASE
///RECTAN
///RCONF 0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0
P00000={home},180.0000,0.0000,0.0000
//INST
///DATE 2026/11/22 08:00
///ATTR SC,RW
///GROUP1 RB1
NOP
SET B@0 0
SET B@2 0
' an accepted pick without outcome, or something in the gripper: no motion until a person has looked
JUMP *HELDU IF D@2>D@1
JUMP *HELDG IF IN#({input})=ON
*LOOP
MOVJ P000 VJ={home_joints}
*READY
SET B@2 1
*WAITPC
SET I@11 I@1
JUMP *FENCE IF I@11>I@2
JUMP *GO IF B@0=1
TIMER T=0.02
JUMP *WAITPC
' the fence: drops a waiting command and acknowledges, upwards only
*FENCE
SET B@0 0
SET I@2 I@11
JUMP *WAITPC
' take a command: copies first, the PC may rewrite its variables later
*GO
SET B@2 0
SET D@11 D@0
JUMP *STALE IF I@3<>I@2
JUMP *STALE IF D@11<>D@3
' a number of an earlier epoch is never taken, however late it comes
SET D@12 I@2
MUL D@12 {per_epoch}
JUMP *STALE IF D@11<=D@12
JUMP *DUP IF D@11<=D@2
SET P@11 P@0
SET P@12 P@1
SET D@2 D@11
SET B@0 2
' from here the sequence is used up, whatever comes
JUMP *FULL IF IN#({input})=ON
' grasp inside the window? element 1 2 3 is X Y Z in 0.001 mm
GETE D@10 P@11 (1)
JUMP *WINDOW IF D@10<{x_min}
JUMP *WINDOW IF D@10>{x_max}
GETE D@10 P@11 (2)
JUMP *WINDOW IF D@10<{y_min}
JUMP *WINDOW IF D@10>{y_max}
GETE D@10 P@11 (3)
JUMP *WINDOW IF D@10<{z_min}
ADD D@10 {approach}
JUMP *WINDOW IF D@10>{z_max}
SET P@10 P@11
SETE P@10 (3) D@10
' place inside the window?
GETE D@10 P@12 (1)
JUMP *WINDOW IF D@10<{x_min}
JUMP *WINDOW IF D@10>{x_max}
GETE D@10 P@12 (2)
JUMP *WINDOW IF D@10<{y_min}
JUMP *WINDOW IF D@10>{y_max}
GETE D@10 P@12 (3)
JUMP *WINDOW IF D@10<{z_min}
ADD D@10 {approach}
JUMP *WINDOW IF D@10>{z_max}
SET P@13 P@12
SETE P@13 (3) D@10
' pick
MOVJ P@10 VJ={joints}
MOVL P@11 V={final} PL=0
DOUT OT#({output}) ON
TIMER T=0.20
WAIT IN#({input})=ON T=1.00
MOVL P@10 V={travel}
JUMP *NOGRIP IF IN#({input})=OFF
' place: a joint move, because a straight line may turn T beyond its limit
MOVJ P@13 VJ={joints}
JUMP *LOST IF IN#({input})=OFF
MOVL P@12 V={final} PL=0
' done is only what was in the gripper to the end, also after a stop on the way
JUMP *LOST IF IN#({input})=OFF
DOUT OT#({output}) OFF
TIMER T=0.20
MOVL P@13 V={travel}
SET B@3 3
SET D@1 D@2
SET B@0 3
JUMP *LOOP
*WINDOW
SET B@1 1
SET B@3 9
SET D@1 D@2
SET B@0 9
JUMP *READY
*FULL
SET B@1 4
SET B@3 9
SET D@1 D@2
SET B@0 9
JUMP *READY
*NOGRIP
DOUT OT#({output}) OFF
SET B@1 2
SET B@3 9
SET D@1 D@2
SET B@0 9
JUMP *LOOP
*LOST
DOUT OT#({output}) OFF
SET B@1 3
SET B@3 9
SET D@1 D@2
SET B@0 9
JUMP *LOOP
' a repeated command never moves: its outcome again, or unknown
*DUP
JUMP *UNK IF D@11<>D@1
SET B@0 B@3
JUMP *READY
*UNK
SET B@1 7
SET B@0 9
JUMP *READY
*STALE
SET B@1 8
SET B@0 9
JUMP *READY
' wait for a person: the PC raises EPOCH anew after somebody has looked
*HELDU
SET B@1 7
JUMP *HELD
*HELDG
SET B@1 5
*HELD
SET I@4 I@1
*WAITOP
SET B@0 9
SET I@11 I@1
JUMP *SETTLED IF I@11>I@4
TIMER T=0.10
JUMP *WAITOP
*SETTLED
DOUT OT#({output}) OFF
JUMP *CLEAR IF D@2=D@1
SET B@3 9
SET B@1 7
SET D@1 D@2
*CLEAR
SET B@0 0
SET I@2 I@11
JUMP *LOOP
END
)";

std::string fixed(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

std::string micrometres(double mm) { return std::to_string(std::lround(mm * 1000)); }

void check(const VispickSettings& s) {
  const auto need = [](bool good, const char* what) {
    if (!good) throw std::invalid_argument(what);
  };
  constexpr std::string_view kAllowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  need(!s.name.empty() && s.name.size() <= 32 && s.name.find_first_not_of(kAllowed) == std::string::npos,
       "a job's name has at most 32 characters: A-Z, 0-9, _ and -");
  need(s.first_variable >= 1 && s.first_variable <= 86, "first variable outside 1..86");  // P000 is the home position
  need(s.tool >= 0 && s.tool <= 63, "tool number outside 0..63");
  need(s.gripper_output >= 1 && s.grip_sensor_input >= 1, "contact numbers begin at 1");
  for (std::size_t i = 0; i < 3; ++i) {
    need(std::isfinite(s.home_mm[i]) && s.window_min_mm[i] >= -10'000 && s.window_max_mm[i] <= 10'000 &&
             s.window_min_mm[i] < s.window_max_mm[i],
         "the window is no box");
  }
  need(s.approach_mm >= 0 && s.approach_mm <= 1000, "approach outside 0..1000 mm");
  for (const double pct : {s.home_pct, s.travel_pct})
    need(pct >= 0.01 && pct <= 100, "joint speed outside 0.01..100 %");
  need(s.travel_mm_s >= 0.1 && s.travel_mm_s <= 1500 && s.final_mm_s >= 0.1 && s.final_mm_s <= 1500,
       "speed outside 0.1..1500 mm/s");
}

std::map<std::string, std::string, std::less<>> words(const VispickSettings& s) {
  return {{"name", s.name},
          {"tool", std::to_string(s.tool)},
          {"home", fixed(s.home_mm[0], 3) + ',' + fixed(s.home_mm[1], 3) + ',' + fixed(s.home_mm[2], 3)},
          {"output", std::to_string(s.gripper_output)},
          {"input", std::to_string(s.grip_sensor_input)},
          {"x_min", micrometres(s.window_min_mm[0])},
          {"x_max", micrometres(s.window_max_mm[0])},
          {"y_min", micrometres(s.window_min_mm[1])},
          {"y_max", micrometres(s.window_max_mm[1])},
          {"z_min", micrometres(s.window_min_mm[2])},
          {"z_max", micrometres(s.window_max_mm[2])},
          {"approach", micrometres(s.approach_mm)},
          {"home_joints", fixed(s.home_pct, 2)},
          {"joints", fixed(s.travel_pct, 2)},
          {"travel", fixed(s.travel_mm_s, 1)},
          {"final", fixed(s.final_mm_s, 1)},
          {"per_epoch", std::to_string(HandOver::kPicksPerEpoch)}};
}

std::string variable_number(std::string_view& rest, int first) {
  int offset = 0;
  while (!rest.empty() && rest.front() >= '0' && rest.front() <= '9') {
    offset = offset * 10 + (rest.front() - '0');
    rest.remove_prefix(1);
  }
  const std::string digits = std::to_string(first + offset);
  return std::string(3 - std::min<std::size_t>(3, digits.size()), '0') + digits;
}

}  // namespace

std::string vispick_job(const VispickSettings& settings) {
  check(settings);
  const auto replacement = words(settings);
  std::string out;
  for (std::string_view rest = kTemplate; !rest.empty();) {
    const char c = rest.front();
    rest.remove_prefix(1);
    if (c == '@') {
      out += variable_number(rest, settings.first_variable);
    } else if (c == '{') {
      out += replacement.find(rest.substr(0, rest.find('}')))->second;
      rest.remove_prefix(rest.find('}') + 1);
    } else {
      out += c == '\n' ? "\r\n" : std::string(1, c);
    }
  }
  return out;
}

}  // namespace pickcell::robot
