#include "pickcell/robot/hses_files.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "pickcell/robot/hses_codec.hpp"

namespace pickcell::robot {

using core::ErrorCode;
using Repeat = HsesSession::Repeat;

namespace {

constexpr std::uint32_t number(const HsesAnswer& answer) { return answer.block & ~kHsesLastBlock; }
/// Marked as answers of robot control are: some servers do so in the file service too.
constexpr bool only_packet(const HsesAnswer& answer) { return answer.block == kHsesLastBlock; }
constexpr bool last(const HsesAnswer& answer) { return (answer.block & kHsesLastBlock) != 0; }

}  // namespace

HsesFiles::HsesFiles(const HsesSettings& s) : session_(s.host, s.port + 1, s.file_timeout, s.tries, s.busy_pause) {}

/// Blocks 1..n come one after the other, each asked for by acknowledging the one before; the acknowledgement of the
/// last one gets no answer.
core::Result<std::string> HsesFiles::download(HsesService service, const std::string& name) {
  constexpr std::size_t kMostBytes = 64u << 20;
  const std::string what = "file " + name;
  const auto broken_off = [&](const std::string& why) {
    return tl::unexpected(session_.with_trail({ErrorCode::link, session_.peer() + ' ' + what, why, "try again", {}}));
  };
  if (auto opened = session_.open(); !opened) return core::forward(opened);
  auto answer = session_.ask(hses_file(service, name), Repeat::yes, what);
  std::string data;
  for (std::uint32_t block = 1;; ++block) {
    if (!answer) return core::forward(answer);
    if (number(*answer) != block && !(block == 1 && only_packet(*answer)))
      return broken_off("block " + std::to_string(number(*answer)) + " instead of " + std::to_string(block));
    data.append(answer->payload.begin(), answer->payload.end());
    if (data.size() > kMostBytes) return broken_off("more than 64 MB without an end");
    HsesRequest acknowledge = hses_file_block(service, answer->block);
    if (last(*answer)) {
      if (auto sent = session_.send_only(std::move(acknowledge)); !sent) return core::forward(sent);
      return data;
    }
    answer = session_.ask(std::move(acknowledge), Repeat::no, what);
  }
}

core::Result<std::vector<std::string>> HsesFiles::list(const std::string& pattern) {
  auto text = download(HsesService::file_list, pattern);
  if (!text) return core::forward(text);
  return parse_hses_file_list(*text);
}

core::Result<std::string> HsesFiles::save(const std::string& name) { return download(HsesService::file_save, name); }

core::Status HsesFiles::load(const std::string& name, const std::string& text) {
  constexpr std::size_t kBlockBytes = 400;
  if (text.empty()) throw std::invalid_argument("an empty file cannot be sent");
  const std::string what = "file " + name;
  if (auto opened = session_.open(); !opened) return opened;
  auto answer = session_.ask(hses_file(HsesService::file_load, name), Repeat::no, what);
  for (std::uint32_t block = 1; answer; ++block) {
    const auto from = text.begin() + static_cast<std::ptrdiff_t>((block - 1) * kBlockBytes);
    const auto size = std::min<std::ptrdiff_t>(kBlockBytes, text.end() - from);
    const bool end = from + size == text.end();
    answer = session_.ask(
        hses_file_block(HsesService::file_load, block | (end ? kHsesLastBlock : 0), HsesBytes(from, from + size)),
        Repeat::no, what);
    if (answer && number(*answer) != block && !only_packet(*answer))
      return core::failure(ErrorCode::link, session_.peer() + ' ' + what, "another block was confirmed", "try again");
    if (answer && end) return {};
  }
  return core::forward(answer);
}

core::Status HsesFiles::remove(const std::string& name) {
  if (auto opened = session_.open(); !opened) return opened;
  return session_.tell(hses_file(HsesService::file_delete, name), Repeat::no, "delete " + name);
}

}  // namespace pickcell::robot
