#include "pickcell/frames/gvcp.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

namespace pickcell::frames::gvcp {
namespace {

std::vector<std::byte> bytes(std::initializer_list<int> values) {
  std::vector<std::byte> out;
  for (const int v : values) out.push_back(static_cast<std::byte>(v));
  return out;
}

TEST(Gvcp, QuestionsAreTheBytesOfTheSpecification) {
  const auto read = read_register(kControlRegister, 0x1234);
  EXPECT_EQ(std::vector(read.begin(), read.end()),
            bytes({0x42, 0x01, 0x00, 0x80, 0x00, 0x04, 0x12, 0x34, 0x00, 0x00, 0x0a, 0x00}));
  const auto find = discovery(0xffff);
  EXPECT_EQ(std::vector(find.begin(), find.end()), bytes({0x42, 0x01, 0x00, 0x02, 0x00, 0x00, 0xff, 0xff}));
}

TEST(Gvcp, RegisterAnswersAreReadAndOthersAreNot) {
  const auto answer = bytes({0, 0, 0x00, 0x81, 0x00, 0x04, 0x00, 0x07, 0, 0, 0, 2});
  const auto read = parse_register(answer, 7);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->status, 0);
  EXPECT_EQ(read->value, 2u);
  EXPECT_FALSE(parse_register(answer, 8)) << "of another question";
  for (std::size_t n = 0; n < answer.size(); ++n) EXPECT_FALSE(parse_register(std::span(answer).first(n), 7)) << n;
  const auto denied = bytes({0x80, 0x06, 0x00, 0x81, 0x00, 0x00, 0x00, 0x07});
  ASSERT_TRUE(parse_register(denied, 7));
  EXPECT_EQ(parse_register(denied, 7)->status, 0x8006);
}

TEST(Gvcp, ADiscoveryAnswerNamesTheCamera) {
  auto answer = bytes({0, 0, 0x00, 0x03, 0x00, 0xf8, 0xff, 0xff});
  answer.resize(8 + 0xf8);
  const auto put = [&](std::size_t at, const char* text) {
    std::memcpy(answer.data() + 8 + at, text, std::strlen(text));
  };
  const unsigned char mac[] = {0x00, 0x1a, 0x2b, 0x3c, 0x4d, 0x5e}, ip[] = {192, 168, 7, 20};
  std::memcpy(answer.data() + 8 + 10, mac, 6);
  std::memcpy(answer.data() + 8 + 0x24, ip, 4);
  put(0x48, "Some Vendor");
  put(0x68, "Model\x01X");
  put(0xd8, "0123456789abcdef");  // fills its field without a zero
  put(0xe8, "over the belt");
  const auto who = parse_discovery(answer, 0xffff);
  ASSERT_TRUE(who);
  EXPECT_EQ(dotted(who->address), "192.168.7.20");
  EXPECT_EQ(who->mac, "00:1a:2b:3c:4d:5e");
  EXPECT_EQ(who->vendor, "Some Vendor");
  EXPECT_EQ(who->model, "Model?X");
  EXPECT_EQ(who->serial, "0123456789abcdef");
  EXPECT_EQ(who->user_name, "over the belt");
  for (std::size_t n = 0; n < answer.size(); ++n) EXPECT_FALSE(parse_discovery(std::span(answer).first(n), 0xffff));
}

}  // namespace
}  // namespace pickcell::frames::gvcp
