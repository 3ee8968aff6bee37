#include "pickcell/sim/hses_files.hpp"

#include <algorithm>
#include <utility>

#include "pickcell/sim/controller_commands.hpp"
#include "pickcell/sim/hses_commands.hpp"
#include "pickcell/sim/job_text.hpp"

namespace pickcell::sim {

namespace {

using robot::HsesAnswer;
using robot::HsesBytes;
using robot::HsesRequest;
using robot::HsesService;
using robot::kHsesLastBlock;

constexpr std::uint16_t kNotOverwritable = 0xE28C, kNotInList = 0xE2A7, kNotDeletable = 0xE2AF, kNotRemote = 0xE2B2,
                        kNotFound = 0xE2B3, kNameTooLong = 0xE2B4, kEmpty = 0xE29C, kBadBlock = 0xE4A1,
                        kBadAck = 0xE4A2, kTooManyBytes = 0x4010, kNameDiffers = 0x5390;
constexpr std::string_view kExtension = ".JBI";
constexpr std::size_t kLongestName = 32;

std::string text(const HsesBytes& payload) {
  return {payload.begin(), std::find(payload.begin(), payload.end(), std::uint8_t{0})};
}

/// The job of a file name; empty when it is none.
std::string job_of(const std::string& file) {
  if (file.size() <= kExtension.size() || !file.ends_with(kExtension)) return {};
  std::string job = file.substr(0, file.size() - kExtension.size());
  return job_text::job_name(job) ? job : std::string();
}

bool too_long(const std::string& file) { return file.size() > kLongestName + kExtension.size(); }

/// 5130 becomes 0x5130.
std::uint16_t in_hex(int decimal) {
  int value = 0;
  for (int shift = 0; decimal > 0; shift += 4, decimal /= 10) value |= decimal % 10 << shift;
  return static_cast<std::uint16_t>(value);
}

HsesAnswer with_block(HsesAnswer answer, std::uint32_t block) {
  answer.block = block;
  return answer;
}

/// `*` stands for any number of characters, `?` for one.
bool fits(std::string_view name, std::string_view pattern) {
  std::size_t n = 0, p = 0, star = std::string_view::npos, tried = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++, tried = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++n, ++p;
    } else if (star != std::string_view::npos) {
      p = star + 1, n = ++tried;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

std::string list(const ControllerState& s, std::string_view pattern) {
  std::string out;
  for (const auto& [name, job] : s.jobs) {
    const std::string file = name + std::string(kExtension);
    if (fits(file, pattern)) out += file + "\r\n";
  }
  return out;
}

HsesAnswer remove(ControllerState& s, const HsesRequest& r) {
  if (!s.remote) return hses_refusal(r, kNotRemote);
  const std::string job = job_of(text(r.payload));
  if (job.empty() || !s.jobs.contains(job)) return hses_refusal(r, kNotFound);
  if (s.running() && s.in_use(job)) return hses_refusal(r, kNotDeletable);
  const Refusal refusal = delete_job(s, job);
  if (refusal == Refusal::moving) return hses_refusal(r, kNotDeletable);
  return refusal == Refusal::none ? hses_done(r) : hses_refusal(r, in_hex(static_cast<int>(refusal)));
}

}  // namespace

bool HsesFiles::in_use(const HsesAnswer& answer) {
  return answer.status != 0 && (answer.added_status == kNotDeletable || answer.added_status == kNotOverwritable);
}

std::optional<HsesAnswer> HsesFiles::handle(ControllerState& s, const HsesRequest& r) {
  if (!r.ack) return begin(s, r);
  if (kind_ == Kind::none || r.service != service_) return std::nullopt;  // of a transfer that is over
  if (kind_ == Kind::sending) return acknowledged(r);
  return received(s, r);
}

HsesAnswer HsesFiles::begin(ControllerState& s, const HsesRequest& r) {
  kind_ = Kind::none;
  last_.reset();
  const std::string name = text(r.payload);
  switch (r.service) {
    case HsesService::file_list:
      return name.find('.') == std::string::npos && name != "*" ? hses_refusal(r, kNotInList)
                                                                : send_file(r, list(s, name));
    case HsesService::file_save: {
      const auto found = s.jobs.find(job_of(name));
      return found == s.jobs.end() ? hses_refusal(r, kNotFound) : send_file(r, found->second->text);
    }
    case HsesService::file_load:
      return begin_load(s, r);
    case HsesService::file_delete:
      return remove(s, r);
    default:
      return hses_refusal(r, 0xA000);
  }
}

HsesAnswer HsesFiles::send_file(const HsesRequest& r, std::string content) {
  kind_ = Kind::sending;
  service_ = r.service;
  content_ = std::move(content);
  block_ = 1;
  return block(r);
}

/// The block that is under way.
HsesAnswer HsesFiles::block(const HsesRequest& r) const {
  const std::size_t from = (block_ - 1) * kBlockBytes, size = std::min(kBlockBytes, content_.size() - from);
  HsesAnswer a = hses_done(r, HsesBytes(content_.begin() + static_cast<std::ptrdiff_t>(from),
                                        content_.begin() + static_cast<std::ptrdiff_t>(from + size)));
  a.block = block_ | (from + size == content_.size() ? kHsesLastBlock : 0);
  return a;
}

std::optional<HsesAnswer> HsesFiles::acknowledged(const HsesRequest& r) {
  const std::uint32_t n = r.block & ~kHsesLastBlock;  // some clients leave the mark of the last block out
  const bool last = block_ * kBlockBytes >= content_.size();
  if (n == block_ && last) return std::nullopt;
  if (n == block_) ++block_;
  if (n != block_ && n + 1 != block_) return hses_refusal(r, kBadBlock);
  return block(r);
}

HsesAnswer HsesFiles::begin_load(const ControllerState& s, const HsesRequest& r) {
  const std::string name = text(r.payload);
  if (!s.remote) return hses_refusal(r, kNotRemote);
  // More than NULs after the name: some clients put the file there; to answer "done" would be a lie.
  const bool name_alone = r.payload.end() == std::find_if(r.payload.begin() + static_cast<std::ptrdiff_t>(name.size()),
                                                          r.payload.end(), [](std::uint8_t b) { return b != 0; });
  if (!name_alone || too_long(name)) return hses_refusal(r, kNameTooLong);
  job_ = job_of(name);
  if (job_.empty()) return hses_refusal(r, 0x4190);
  if (s.running() && s.in_use(job_)) return hses_refusal(r, kNotOverwritable);
  kind_ = Kind::receiving;
  service_ = r.service;
  content_.clear();
  block_ = 0;
  return with_block(hses_done(r), 0);
}

HsesAnswer HsesFiles::received(ControllerState& s, const HsesRequest& r) {
  const std::uint32_t n = r.block & ~kHsesLastBlock;
  if (n == block_ && last_) {
    HsesAnswer again = *last_;
    again.id = r.id;
    return again;
  }
  const auto refuse = [&](std::uint16_t added) {
    if (r.block & kHsesLastBlock || added == kTooManyBytes) block_ = n;  // the file is over
    last_ = with_block(hses_refusal(r, added), r.block);
    return *last_;
  };
  if (n != block_ + 1) return with_block(hses_refusal(r, n == 0 ? kBadAck : kBadBlock), r.block);
  if (content_.size() + r.payload.size() > kLargestFile) return refuse(kTooManyBytes);
  content_.append(r.payload.begin(), r.payload.end());
  if ((r.block & kHsesLastBlock) != 0) {
    if (content_.empty()) return refuse(kEmpty);
    auto job = parse_job(content_);
    if (!job) return refuse(in_hex(job.error().number));
    if (job->name != job_) return refuse(kNameDiffers);
    if (!s.remote) return refuse(kNotRemote);
    if (s.running() && s.in_use(job_)) return refuse(kNotOverwritable);
    s.load_job(std::move(*job));
  }
  block_ = n;
  last_ = with_block(hses_done(r), r.block);
  return *last_;
}

}  // namespace pickcell::sim
