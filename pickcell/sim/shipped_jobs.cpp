#include "pickcell/sim/shipped_jobs.hpp"

#include <cstddef>

/// Made from docs/inform/VISPICK.JBI by cmake/pickcell_embed.cmake.
extern const char pickcell_vispick_job[];
extern const std::size_t pickcell_vispick_job_size;

namespace pickcell::sim {

namespace {

std::string empty_job(const std::string& name) {
  return "/JOB\r\n//NAME " + name +
         "\r\n//POS\r\n///NPOS 0,0,0,0,0,0\r\n//INST\r\n///DATE 2026/11/22 08:00\r\n///ATTR SC,RW\r\n///GROUP1 RB1\r\n"
         "NOP\r\nEND\r\n";
}

}  // namespace

std::vector<std::string> shipped_jobs() {
  return {std::string(pickcell_vispick_job, pickcell_vispick_job_size), empty_job("TEST1"), empty_job("TEST2")};
}

}  // namespace pickcell::sim
