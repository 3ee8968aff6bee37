#include "pickcell/robot/hses_client.hpp"

#include <poll.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "pickcell/robot/controller_fault.hpp"

namespace pickcell::robot {

using core::ErrorCode;

namespace {

constexpr std::size_t kTrailLength = 8;
constexpr std::uint16_t kBusyExclusive = 0xD8FA, kBusyOther = 0xD8F1, kTooManyRequests = 0xFFF6;

WallDeadline in(std::chrono::milliseconds time) { return std::chrono::steady_clock::now() + time; }

void pause(std::chrono::milliseconds time) { (void)::poll(nullptr, 0, static_cast<int>(time.count())); }

bool busy(const HsesAnswer& answer) {
  return answer.status != 0 && (answer.added_status == kBusyExclusive || answer.added_status == kBusyOther ||
                                answer.added_status == kTooManyRequests);
}

std::string hex(unsigned value, int digits) {
  std::array<char, 16> text{};
  (void)std::snprintf(text.data(), text.size(), "%0*X", digits, value);
  return text.data();
}

std::string words(const HsesRequest& r) {
  return "> " + std::to_string(r.id) + ": " + hex(r.command, 2) + '/' + std::to_string(r.instance) + '/' +
         std::to_string(r.attribute) + " service " + hex(static_cast<unsigned>(r.service), 2) + ", " +
         std::to_string(r.payload.size()) + " bytes" + (r.block != 0 ? ", block " + hex(r.block, 8) : "");
}

std::string words(const HsesAnswer& a) {
  return "< " + std::to_string(a.id) + ": status " + hex(a.status, 2) + ' ' + hex(a.added_status, 4) + ", " +
         std::to_string(a.payload.size()) + " bytes" + (a.block != kHsesLastBlock ? ", block " + hex(a.block, 8) : "");
}

HsesBytes word(std::uint32_t v) { return HsesWriter().u32(v).take(); }

std::uint16_t instance(int number, const char* what, int least, int most) {
  if (number < least || number > most) throw std::invalid_argument(std::string(what) + " out of range");
  return static_cast<std::uint16_t>(number);
}

struct Scalar {
  std::uint16_t command, plural;
  std::size_t bytes;
};
Scalar scalar(VariableType type) {
  switch (type) {
    case VariableType::byte:
      return {kHsesB, kHsesPluralB, 1};
    case VariableType::integer:
      return {kHsesI, kHsesPluralI, 2};
    case VariableType::double_integer:
      return {kHsesD, kHsesPluralD, 4};
    default:
      throw std::invalid_argument("not a variable of whole numbers");
  }
}

std::int32_t whole(VariableType type, HsesReader& in) {
  if (type == VariableType::byte) return in.u8();
  if (type == VariableType::integer) return static_cast<std::int16_t>(in.u16());
  return in.i32();
}

auto short_answer(const std::string& what) {
  return core::failure(ErrorCode::link, what, "the answer has not the size of its value",
                       "check that the address is a controller's High Speed Ethernet Server");
}

std::string file_name(const std::string& job) { return job + ".JBI"; }

}  // namespace

HsesClient::HsesClient(HsesSettings settings) : settings_(std::move(settings)) {}

std::string HsesClient::peer() const { return settings_.host + ':' + std::to_string(settings_.port); }

void HsesClient::remember(const std::string& text) {
  if (trail_.size() == kTrailLength) trail_.pop_front();
  trail_.push_back(text);
}

core::Error HsesClient::with_trail(core::Error error) const {
  error.trail.assign(trail_.begin(), trail_.end());
  return error;
}

core::Status HsesClient::connect() {
  trail_.clear();
  open_ = false;
  auto link = DatagramLink::open(settings_.host, settings_.port);
  if (!link) return core::forward(link);
  link_ = std::move(*link);
  open_ = true;  // for the question
  auto status = read_status();
  open_ = status.has_value();
  if (!status) return core::forward(status);
  return {};
}

void HsesClient::disconnect() {
  link_.reset();
  open_ = false;
}

/// The answer that belongs to the request; whatever else arrives is dropped.
core::Result<HsesAnswer> HsesClient::await(DatagramLink& link, const HsesRequest& request, WallDeadline deadline) {
  std::array<std::uint8_t, kHsesHeaderBytes + kHsesMostPayload + 1> buffer;
  for (;;) {
    auto size = link.receive(buffer, deadline);
    if (!size) return core::forward(size);
    auto answer = parse_hses_answer(HsesView(buffer).first(*size));
    if (!answer) {
      remember("< dropped: " + answer.error().why);
      continue;
    }
    if (answer->id == request.id && answer->service == request.service && answer->division == request.division) {
      remember(words(*answer));
      return answer;
    }
    remember(words(*answer) + ", dropped: another request's");
  }
}

core::Result<HsesAnswer> HsesClient::exchange(DatagramLink& link, HsesRequest& request,
                                              std::chrono::milliseconds time) {
  request.id = next_id_++;
  link.drain();
  remember(words(request));
  if (auto sent = link.send(hses_bytes(request)); !sent) return core::forward(sent);
  return await(link, request, in(time));
}

core::Error HsesClient::refusal(const std::string& what, const HsesAnswer& answer) const {
  core::Error error{ErrorCode::refused, peer() + ' ' + what, {}, {}, {}};
  if (answer.added_status != 0) {
    const ControllerFault fault = controller_fault(answer.added_status);
    error.why = "refused with " + hex(answer.added_status, 4) + ": " + std::string(fault.meaning);
    error.remedy = fault.remedy;
  } else {
    error.why = "refused with status " + hex(answer.status, 2);
    error.remedy = "see the message on the pendant";
  }
  return error;
}

core::Result<HsesBytes> HsesClient::ask(HsesRequest request, Repeat repeat, const std::string& what) {
  if (!open_ || !link_) return core::failure(ErrorCode::link, peer(), "not connected", "connect first");
  const int tries = repeat == Repeat::yes ? std::max(settings_.tries, 1) : 1;
  for (int attempt = 1;; ++attempt) {
    auto answer = exchange(*link_, request, settings_.timeout);
    if (answer && answer->status == 0) return std::move(answer->payload);
    const bool silent = !answer && answer.error().code == ErrorCode::timeout;
    if (attempt < tries && (silent || (answer && busy(*answer)))) {
      if (!silent) pause(settings_.busy_pause);
      continue;
    }
    if (answer) return tl::unexpected(with_trail(refusal(what, *answer)));
    open_ = false;
    answer.error().what += ' ' + what;
    if (repeat == Repeat::no) answer.error().why += "; whether it was done is not known";
    return tl::unexpected(with_trail(std::move(answer.error())));
  }
}

core::Status HsesClient::tell(HsesRequest request, Repeat repeat, const std::string& what) {
  auto answer = ask(std::move(request), repeat, what);
  if (!answer) return core::forward(answer);
  return {};
}

template <class Parse>
auto HsesClient::read(HsesRequest request, const std::string& what, Parse parse) -> decltype(parse(HsesView{})) {
  auto payload = ask(std::move(request), Repeat::yes, what);
  if (!payload) return core::forward(payload);
  auto value = parse(HsesView(*payload));
  if (value) return value;
  return tl::unexpected(with_trail(std::move(value.error())));
}

core::Result<RobotState> HsesClient::read_status() {
  return read(hses_get(kHsesStatus, 1), "status", parse_hses_status);
}

core::Result<std::vector<Alarm>> HsesClient::read_alarms() {
  std::vector<Alarm> alarms;
  constexpr std::uint16_t kMost = 4;
  for (std::uint16_t n = 1; n <= kMost; ++n) {
    auto a = read(hses_get(kHsesAlarm, n), "alarm", parse_hses_alarm);
    if (!a) return core::forward(a);
    if (a->code == 0) break;
    std::string text = "alarm " + std::to_string(a->code) + " [" + std::to_string(a->data) + ']';
    if (!a->name.empty()) text += ' ' + a->name;
    alarms.push_back({static_cast<int>(a->code), static_cast<int>(a->data), std::move(text)});
  }
  return alarms;
}

core::Result<CartesianPosition> HsesClient::read_position(int frame) {
  if (frame != kBaseFrame)
    return core::failure(ErrorCode::usage, peer() + " position", "HSES reports positions in the base frame only",
                         "use frame 0, or tcp80://");
  return read(hses_get(kHsesPosition, kHsesRobotCartesian), "position",
              [](HsesView payload) -> core::Result<CartesianPosition> {
                auto raw = parse_hses_position(payload);
                if (!raw) return core::forward(raw);
                auto position = variable_position(*raw);
                if (!position) return core::forward(position);
                if (auto* cartesian = std::get_if<CartesianPosition>(&*position)) return *cartesian;
                return short_answer("position");
              });
}

core::Result<std::vector<std::int32_t>> HsesClient::read_pulses() {
  return read(hses_get(kHsesPosition, kHsesRobotPulse), "pulses",
              [](HsesView payload) -> core::Result<std::vector<std::int32_t>> {
                auto raw = parse_hses_position(payload);
                if (!raw) return core::forward(raw);
                return std::vector<std::int32_t>(raw->axes.begin(), raw->axes.end());
              });
}

core::Result<CurrentJob> HsesClient::read_job() {
  return read(hses_get(kHsesJob, 1), "running job", [](HsesView payload) -> core::Result<CurrentJob> {
    auto raw = parse_hses_job(payload);
    if (!raw) return core::forward(raw);
    return CurrentJob{raw->name, static_cast<int>(raw->line), static_cast<int>(raw->step)};
  });
}

core::Result<std::int32_t> HsesClient::read_integer(VariableType type, int number) {
  const Scalar s = scalar(type);
  return read(hses_get(s.command, instance(number, "variable", 0, 65535), 1), "variable",
              [&](HsesView payload) -> core::Result<std::int32_t> {
                // The manual draws B and I as rows of 32 bits; real controllers answer with 1, 2 and 4 bytes.
                if (payload.size() != s.bytes && payload.size() != 4) return short_answer("variable");
                HsesReader in(payload);
                return whole(type, in);
              });
}

core::Result<std::vector<std::int32_t>> HsesClient::read_integers(VariableType type, int first, int count) {
  const Scalar s = scalar(type);
  const auto n = static_cast<std::uint32_t>(std::max(count, 0));
  return read(hses_read_plural(s.plural, instance(first, "variable", 0, 65535), n), "variables",
              [&](HsesView payload) -> core::Result<std::vector<std::int32_t>> {
                auto elements = parse_hses_plural(payload, s.plural, n);
                if (!elements) return core::forward(elements);
                HsesReader in(*elements);
                std::vector<std::int32_t> values(n);
                for (std::int32_t& v : values) v = whole(type, in);
                return values;
              });
}

core::Result<double> HsesClient::read_real(int number) {
  return read(hses_get(kHsesR, instance(number, "variable", 0, 65535), 1), "variable R",
              [](HsesView payload) -> core::Result<double> {
                if (payload.size() != 4) return short_answer("variable R");
                const float v = HsesReader(payload).f32();
                if (!std::isfinite(v)) return short_answer("variable R");
                return static_cast<double>(v);
              });
}

core::Result<VariablePosition> HsesClient::read_position_variable(int number) {
  return read(hses_get(kHsesP, instance(number, "variable", 0, 65535)), "variable P",
              [](HsesView payload) -> core::Result<VariablePosition> {
                auto raw = parse_hses_position(payload);
                if (!raw) return core::forward(raw);
                return variable_position(*raw);
              });
}

core::Status HsesClient::write_integer(VariableType type, int number, std::int32_t value) {
  const Scalar s = scalar(type);
  HsesWriter out;
  if (s.bytes == 1) out.u8(static_cast<std::uint8_t>(value));
  if (s.bytes == 2) out.u16(static_cast<std::uint16_t>(value));
  if (s.bytes == 4) out.i32(value);
  return tell(hses_set_one(s.command, instance(number, "variable", 0, 65535), out.take()), Repeat::yes, "variable");
}

core::Status HsesClient::write_real(int number, double value) {
  const auto v = static_cast<float>(value);
  if (!std::isfinite(v)) throw std::invalid_argument("a value must be finite and within 32 bits");
  return tell(hses_set_one(kHsesR, instance(number, "variable", 0, 65535), HsesWriter().f32(v).take()), Repeat::yes,
              "variable R");
}

core::Status HsesClient::write_position_variable(int number, const VariablePosition& position) {
  return tell(hses_set_all(kHsesP, instance(number, "variable", 0, 65535), hses_payload(hses_position(position))),
              Repeat::yes, "variable P");
}

core::Result<std::vector<std::uint8_t>> HsesClient::read_contacts(int first, int groups) {
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < groups; ++i) {
    auto one = read(hses_get(kHsesIo, instance(first / 10 + i, "contact", 1, 9999), 1), "contacts",
                    [](HsesView payload) -> core::Result<std::uint8_t> {
                      if (payload.size() != 1 && payload.size() != 4) return short_answer("contacts");
                      return payload[0];
                    });
    if (!one) return core::forward(one);
    bytes.push_back(*one);
  }
  return bytes;
}

core::Status HsesClient::write_contacts(int first, const std::vector<std::uint8_t>& groups) {
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const auto group = instance(first / 10 + static_cast<int>(i), "contact", 1, 9999);
    if (auto written = tell(hses_set_one(kHsesIo, group, {groups[i]}), Repeat::yes, "contacts"); !written)
      return written;
  }
  return {};
}

core::Status HsesClient::hold(bool on) {
  // Holding twice is holding; a repeated release could undo somebody's hold.
  return tell(hses_power(kHsesHold, on), on ? Repeat::yes : Repeat::no, on ? "hold" : "hold off");
}

core::Status HsesClient::reset_alarm() {
  return tell(hses_set_one(kHsesReset, kHsesResetAlarm, word(1)), Repeat::no, "alarm reset");
}

core::Status HsesClient::cancel_error() {
  return tell(hses_set_one(kHsesReset, kHsesCancelError, word(1)), Repeat::no, "error cancel");
}

core::Status HsesClient::servo(bool on) { return tell(hses_power(kHsesServo, on), Repeat::no, "servo"); }

core::Status HsesClient::start_job(const std::string& job) {
  if (auto selected = tell(hses_select_job(job, 0), Repeat::no, "select " + job); !selected) return selected;
  return tell(hses_start(), Repeat::no, "start");
}

core::Status HsesClient::move(const DirectMove& m) {
  HsesMoveData data;
  const bool joint = m.kind == DirectMove::Kind::joint;
  data.speed.kind = joint ? 0 : m.turning ? 2 : 1;
  data.speed.value = static_cast<std::uint32_t>(std::llround(m.speed * (joint ? 100 : 10)));
  data.target = hses_position(m.target);
  const auto kind = joint                              ? HsesMoveKind::joint
                    : m.kind == DirectMove::Kind::line ? HsesMoveKind::line
                                                       : HsesMoveKind::line_by;
  return tell(hses_move(kind, data), Repeat::no, "move");
}

core::Status HsesClient::set_cycle(std::uint32_t mode) { return tell(hses_cycle(mode), Repeat::no, "cycle"); }
core::Status HsesClient::show_message(const std::string& text) {
  return tell(hses_message(text), Repeat::no, "message");
}

core::Result<HsesSystemInfo> HsesClient::read_system(std::uint16_t inst) {
  return read(hses_get(kHsesSystem, inst), "system information", parse_hses_system);
}

core::Result<std::string> HsesClient::identity() {
  auto info = read_system();
  if (!info) return core::forward(info);
  return info->model + ", software " + info->software;
}

core::Result<std::array<std::int32_t, 8>> HsesClient::read_torque() {
  return read(hses_get(kHsesTorque, kHsesRobotPulse), "torque", parse_hses_axes);
}

// --- files ---------------------------------------------------------------------------------------------------------

core::Result<DatagramLink> HsesClient::open_files() const {
  return DatagramLink::open(settings_.host, settings_.port + 1);
}

core::Result<HsesAnswer> HsesClient::file_exchange(DatagramLink& link, HsesRequest request, Repeat repeat,
                                                   const std::string& what) {
  const int tries = repeat == Repeat::yes ? std::max(settings_.tries, 1) : 1;
  for (int attempt = 1;; ++attempt) {
    auto answer = exchange(link, request, settings_.file_timeout);
    if (answer && answer->status == 0) return answer;
    if (answer) return tl::unexpected(with_trail(refusal(what, *answer)));
    if (answer.error().code == ErrorCode::timeout && attempt < tries) continue;
    answer.error().what += ' ' + what;
    return tl::unexpected(with_trail(std::move(answer.error())));
  }
}

/// Blocks 1..n come one after the other, each asked for by acknowledging the one before; the acknowledgement of the
/// last one gets no answer. A lost block breaks the transfer off: the whole of it is begun again by the caller's
/// choice.
core::Result<HsesBytes> HsesClient::download(HsesService service, const std::string& name) {
  constexpr std::size_t kMostBytes = 64u << 20;
  auto link = open_files();
  if (!link) return core::forward(link);
  const std::string what = "file " + name;
  auto answer = file_exchange(*link, hses_file(service, name), Repeat::yes, what);
  HsesBytes data;
  for (std::uint32_t block = 1;; ++block) {
    if (!answer) return core::forward(answer);
    if ((answer->block & ~kHsesLastBlock) != block)
      return tl::unexpected(with_trail(
          {ErrorCode::link,
           peer() + ' ' + what,
           "block " + std::to_string(answer->block & ~kHsesLastBlock) + " instead of " + std::to_string(block),
           "try again",
           {}}));
    data.insert(data.end(), answer->payload.begin(), answer->payload.end());
    if (data.size() > kMostBytes)
      return core::failure(ErrorCode::link, peer() + ' ' + what, "more than 64 MB without an end", "try again");
    HsesRequest acknowledge = hses_file_block(service, answer->block);
    if ((answer->block & kHsesLastBlock) != 0) {
      acknowledge.id = next_id_++;
      remember(words(acknowledge));
      if (auto sent = link->send(hses_bytes(acknowledge)); !sent) return core::forward(sent);
      return data;
    }
    answer = file_exchange(*link, std::move(acknowledge), Repeat::no, what);
  }
}

core::Status HsesClient::upload(const std::string& name, const std::string& text) {
  constexpr std::size_t kBlockBytes = 400;
  auto link = open_files();
  if (!link) return core::forward(link);
  const std::string what = "file " + name;
  auto answer = file_exchange(*link, hses_file(HsesService::file_load, name), Repeat::no, what);
  for (std::uint32_t block = 1; answer; ++block) {
    const std::size_t from = (block - 1) * kBlockBytes, size = std::min(kBlockBytes, text.size() - from);
    const bool last = from + size == text.size();
    const std::uint32_t number = block | (last ? kHsesLastBlock : 0);
    answer = file_exchange(*link,
                           hses_file_block(HsesService::file_load, number,
                                           HsesBytes(text.begin() + static_cast<std::ptrdiff_t>(from),
                                                     text.begin() + static_cast<std::ptrdiff_t>(from + size))),
                           Repeat::no, what);
    if (answer && (answer->block & ~kHsesLastBlock) != block)
      return core::failure(ErrorCode::link, peer() + ' ' + what, "another block was confirmed", "try again");
    if (answer && last) return {};
  }
  return core::forward(answer);
}

core::Result<std::vector<std::string>> HsesClient::list_jobs() {
  auto list = download(HsesService::file_list, "*.JBI");
  if (!list) return core::forward(list);
  std::vector<std::string> jobs = parse_hses_file_list(std::string(list->begin(), list->end()));
  for (std::string& job : jobs)
    if (job.ends_with(".JBI")) job.resize(job.size() - 4);
  return jobs;
}

core::Result<std::string> HsesClient::read_job_text(const std::string& job) {
  auto text = download(HsesService::file_save, file_name(job));
  if (!text) return core::forward(text);
  return std::string(text->begin(), text->end());
}

core::Status HsesClient::write_job_text(const std::string& job, const std::string& text) {
  if (text.empty()) return core::failure(ErrorCode::usage, job, "the job is empty", "give a job's text");
  return upload(file_name(job), text);
}

core::Status HsesClient::delete_job(const std::string& job) {
  auto link = open_files();
  if (!link) return core::forward(link);
  auto answer = file_exchange(*link, hses_file(HsesService::file_delete, file_name(job)), Repeat::no, "delete " + job);
  if (!answer) return core::forward(answer);
  return {};
}

}  // namespace pickcell::robot
