#include "pickcell/sim/job_program.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "pickcell/core/file.hpp"

namespace pickcell::sim {
namespace {

std::string crlf(std::string text) {
  std::string out;
  for (const char c : text) out += c == '\n' ? std::string("\r\n") : std::string(1, c);
  return out;
}

std::filesystem::path shipped_job() {
  return std::filesystem::path(PICKCELL_SOURCE_DIR) / "docs" / "inform" / "VISPICK.JBI";
}

std::string job(const std::string& instructions, const std::string& pos = {}) {
  return crlf("/JOB\n//NAME TEST\n//POS\n" + pos + "//INST\n///DATE 2026/11/22 08:00\nNOP\n" + instructions + "END\n");
}

int refused_with(const std::string& text) {
  const auto parsed = parse_job(text);
  return parsed ? 0 : parsed.error().number;
}

TEST(JobProgram, ReadsTheShippedPickJob) {
  const auto text = core::read_text_file(shipped_job());
  ASSERT_TRUE(text.has_value());
  const auto parsed = parse_job(*text);
  ASSERT_TRUE(parsed.has_value()) << parsed.error().line << " " << parsed.error().why;
  EXPECT_EQ(parsed->name, "VISPICK");
  EXPECT_EQ(parsed->lines.front().op, Op::nop);
  EXPECT_EQ(parsed->lines.back().op, Op::end);
  ASSERT_TRUE(parsed->p_variables.contains(0));
  EXPECT_EQ(parsed->p_variables.at(0).tool, 1);
}

TEST(JobProgram, KeepsOneInstructionPerLineAndResolvesLabels) {
  const auto parsed =
      parse_job(job("' a comment\n*TOP\nMOVJ P000 VJ=20.00\nJUMP *TOP IF D010<=D012\nMOVL C00001 V=100.0 PL=0\n"));
  ASSERT_TRUE(parsed.has_value()) << parsed.error().why;
  ASSERT_EQ(parsed->lines.size(), 7u);
  EXPECT_EQ(parsed->lines[4].op, Op::jump);
  EXPECT_EQ(parsed->lines[4].target, 2u);
  EXPECT_EQ(parsed->lines[4].condition->terms[0].compare, Compare::less_equal);
  EXPECT_EQ(parsed->step_at(4), 1);
  EXPECT_EQ(parsed->step_at(5), 2);
}

TEST(JobProgram, ReadsPositionsInMillimetresDegreesAndPulses) {
  const auto parsed = parse_job(job("",
                                    "///TOOL 2\n///POSTYPE USER\n///USER 3\n///RECTAN\n///RCONF 1,0,0,0,1,0\n"
                                    "P00005=300.001,-0.500,250,180.0000,0,-90.1234\n"
                                    "///PULSE\nC00000=1,-2,3,4,5,600000\n"));
  ASSERT_TRUE(parsed.has_value()) << parsed.error().why;
  EXPECT_EQ(parsed->p_variables.at(5), (Position{false, 4, {300001, -500, 250000, 1800000, 0, -901234}, 0b010001, 2}));
  EXPECT_EQ(parsed->taught.at(0).axis, (std::array<std::int32_t, 6>{1, -2, 3, 4, 5, 600000}));
  EXPECT_TRUE(parsed->taught.at(0).pulse);
}

TEST(JobProgram, ConnectsBlocks) {
  const auto parsed =
      parse_job(job("IFTHENEXP B000=1\nINC B001\nELSEIFEXP B000=2 OR B000=3\nINC B002\nELSE\nINC B003\nENDIF\n"
                    "WHILEEXP I000<5 AND I001<>2\nINC I000\nENDWHILE\n"));
  ASSERT_TRUE(parsed.has_value()) << parsed.error().why;
  EXPECT_EQ(parsed->lines[1].target, 3u);
  EXPECT_EQ(parsed->lines[3].target, 5u);
  EXPECT_EQ(parsed->lines[3].exit, 7u);
  EXPECT_TRUE(parsed->lines[3].condition->any);
  EXPECT_EQ(parsed->lines[8].target, 11u);
  EXPECT_EQ(parsed->lines[10].target, 8u);
}

TEST(JobProgram, RefusesWhatAControllerRefuses) {
  EXPECT_EQ(refused_with("/JOB\n//NAME T\n//INST\nNOP\nEND\n"), 5130) << "bare LF";
  EXPECT_EQ(refused_with(crlf("/JOB\n//NAME T\n//INST\nEND\n")), 5130);
  EXPECT_EQ(refused_with(crlf("/JOB\n//NAME T\n//INST\nNOP\n")), 5130);
  EXPECT_EQ(refused_with(crlf("/JOB\n//NAME T\n")), 5130);
  EXPECT_EQ(refused_with(""), 5130);
  EXPECT_EQ(refused_with(crlf("/JOB\n//NAME small\n//INST\nNOP\nEND\n")), 4190);
  EXPECT_EQ(refused_with(job("JUMP *NOWHERE\n")), 4200);
  EXPECT_EQ(refused_with(job("*A\n*A\n")), 4200);
  EXPECT_EQ(refused_with(job("FLY P000\n")), 4230);
  EXPECT_EQ(refused_with(job("MOVJ P000\n")), 5110) << "no speed";
  EXPECT_EQ(refused_with(job("MOVJ P000 VJ=120.00\n")), 5110);
  EXPECT_EQ(refused_with(job("SET B000\n")), 5110);
  EXPECT_EQ(refused_with(job("SET P000 B001\n")), 5110);
  EXPECT_EQ(refused_with(job("ENDIF\n")), 5110);
  EXPECT_EQ(refused_with(job("WHILEEXP B000=1\nELSE\n")), 5110);
  EXPECT_EQ(refused_with(job("IFTHENEXP B000=1\n")), 5110);
  EXPECT_EQ(refused_with(job("GETE D020 P020 (7)\n")), 5110);
  EXPECT_EQ(refused_with(job("", "///RECTAN\nP00001=1,2,3,4,5\n")), 5120);
  EXPECT_EQ(refused_with(job("", "///RECTAN\nP00001=1e99,2,3,4,5,6\n")), 5120);
  EXPECT_EQ(refused_with(job("", "///RECTAN\nP00200=1,2,3,4,5,6\n")), 5120);
}

TEST(JobProgram, SaysInWhichLineOfTheText) {
  const auto parsed = parse_job(job("SET B000 1\nFLY\n"));
  ASSERT_FALSE(parsed.has_value());
  EXPECT_EQ(parsed.error().line, 8);
  EXPECT_NE(parsed.error().why.find("FLY"), std::string::npos);
}

TEST(JobProgram, SurvivesDamagedText) {
  const auto text = core::read_text_file(shipped_job());
  ASSERT_TRUE(text.has_value());
  std::mt19937 random(3);
  const auto any = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  for (int i = 0; i < 3000; ++i) {
    std::string damaged = *text;
    for (std::size_t k = any(6) + 1; k > 0; --k) {
      const std::size_t at = any(damaged.size());
      if (any(3) == 0)
        damaged.erase(at, any(40) + 1);
      else
        damaged[at] = static_cast<char>(any(256));
      if (damaged.empty()) break;
    }
    const auto parsed = parse_job(damaged);
    if (!parsed) {
      EXPECT_GE(parsed.error().number, 4190);
      continue;
    }
    for (const Instruction& line : parsed->lines) EXPECT_LE(line.target, parsed->lines.size());
  }
}

}  // namespace
}  // namespace pickcell::sim
