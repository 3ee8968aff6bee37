#include "pickcell/sim/tcp80_session.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace pickcell::sim {
namespace {

/// Everything the session says and passes on, as one text.
std::string heard(const std::vector<std::string>& pieces) {
  Tcp80Session session("DX");
  std::string out;
  for (const std::string& piece : pieces) {
    session.feed(piece);
    while (const auto step = session.next())
      out += "[" + step->say + (step->command ? step->command->name + "|" + step->command->operands : "") +
             (step->close ? "]!" : "]");
  }
  return out;
}

const std::string kTalk =
    "CONNECT Robot_access Keep-Alive:-1\r\nHOSTCTRL_REQUEST RSTATS 0\r\nHOSTCTRL_REQUEST SVON 2\r\n1\r\n"
    "HOSTCTRL_REQUEST RPOSC 4\r0,0\rHOSTCTRL_REQUEST RPOSC 4\n0,0\n\r\nHOSTCTRL_REQUEST LOADV 7\r\n0,10,1\r\n";

TEST(Tcp80Session, HearsTheSameHoweverTheBytesArrive) {
  const std::string whole = heard({kTalk});
  EXPECT_EQ(whole,
            "[OK: DX Information Server( 1.00) Keep-Alive:-1.\r\n][OK: RSTATS\r\n][RSTATS|][OK: SVON\r\n][SVON|1\r]"
            "[OK: RPOSC\r\n][RPOSC|0,0\r][OK: RPOSC\r\n][RPOSC|0,0\n][OK: LOADV\r\n][LOADV|0,10,1\r]");
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    std::vector<std::string> pieces;
    for (std::size_t at = 0; at < kTalk.size();) {
      const std::size_t n = std::uniform_int_distribution<std::size_t>(1, 1 + static_cast<std::size_t>(i % 20))(random);
      pieces.push_back(kTalk.substr(at, n));
      at += n;
    }
    ASSERT_EQ(heard(pieces), whole);
  }
}

TEST(Tcp80Session, SaysNothingAfterItClosed) {
  EXPECT_EQ(heard({"CONNECT Robot_access\r\nHOSTCTRL_REQUEST RSTATS 0\r\nHOSTCTRL_REQUEST RSTATS 0\r\n"}),
            "[OK: DX Information Server( 1.00).\r\n][OK: RSTATS\r\n][RSTATS|]!");
  EXPECT_EQ(heard({"what\r\n", kTalk}), "[NG: HTTP Error Response\r\n]!");
}

TEST(Tcp80Session, SurvivesAnyBytes) {
  std::mt19937 random(2);
  const auto any = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  for (int i = 0; i < 5000; ++i) {
    std::string talk = kTalk;
    for (std::size_t k = any(5) + 1; k > 0; --k) {
      const std::size_t at = any(talk.size());
      if (any(4) == 0)
        talk.insert(at, std::string(any(400), static_cast<char>(any(256))));
      else
        talk[at] = static_cast<char>(any(256));
    }
    (void)heard({talk.substr(0, talk.size() / 2), talk.substr(talk.size() / 2)});
  }
}

}  // namespace
}  // namespace pickcell::sim
