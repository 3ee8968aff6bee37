#include "pickcell/sim/tcp80_session.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pickcell::sim {

namespace {

std::vector<std::string_view> words(std::string_view line) {
  std::vector<std::string_view> out;
  std::size_t i = 0;
  while ((i = line.find_first_not_of(" \t", i)) != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(" \t", i), line.size());
    out.push_back(line.substr(i, end - i));
    i = end;
  }
  return out;
}

std::optional<int> whole(std::string_view text) {
  int v = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), v);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return v;
}

/// Commands allowed on the connection: 1 without Keep-Alive, -1 without limit. Both public spellings.
std::optional<int> commands_asked_for(const std::vector<std::string_view>& w) {
  if (w.size() == 2) return 1;
  if (w.size() != 3) return std::nullopt;
  for (const std::string_view key : {"Keep-Alive:", "KeepAlive:"}) {
    if (!w[2].starts_with(key)) continue;
    const auto n = whole(w[2].substr(key.size()));
    constexpr int kMost = 32767;
    if (n && (*n == -1 || (*n >= 1 && *n <= kMost))) return n;
  }
  return std::nullopt;
}

bool command_name(std::string_view name) {
  return std::all_of(name.begin(), name.end(), [](char c) { return (c >= 'A' && c <= 'Z') || c == '_'; });
}

}  // namespace

void Tcp80Session::feed(std::string_view bytes) {
  if (state_ != State::closed) bytes_.append(bytes);
}

std::optional<std::string> Tcp80Session::take_line() {
  if (swallow_lf_ && !bytes_.empty()) {
    swallow_lf_ = false;
    if (bytes_.front() == '\n') bytes_.erase(0, 1);
  }
  const std::size_t end = bytes_.find_first_of("\r\n");
  if (end == std::string::npos) return std::nullopt;
  swallow_lf_ = bytes_[end] == '\r';
  std::string line = bytes_.substr(0, end);
  bytes_.erase(0, end + 1);
  return line;
}

Tcp80Session::Step Tcp80Session::refuse(std::string text) {
  state_ = State::closed;
  return {"NG: " + std::move(text) + "\r\n", std::nullopt, true};
}

Tcp80Session::Step Tcp80Session::greet(std::string_view line) {
  const auto w = words(line);
  const auto n = w.size() >= 2 && w[0] == "CONNECT" && w[1] == "Robot_access" ? commands_asked_for(w) : std::nullopt;
  if (!n) return refuse("HTTP Error Response");
  state_ = State::header;
  commands_left_ = *n;
  std::string say = "OK: " + banner_ + " Information Server( 1.00)";
  if (w.size() == 3) say += " Keep-Alive:" + std::to_string(*n);
  return {say + ".\r\n", std::nullopt, false};
}

Tcp80Session::Step Tcp80Session::header(std::string_view line) {
  const auto w = words(line);
  if (w.size() != 3 || w[0] != "HOSTCTRL_REQUEST" || !command_name(w[1])) return refuse("Bad Request");
  const auto size = whole(w[2]);
  if (!size || *size < 0 || static_cast<std::size_t>(*size) > kLongestOperands) return refuse("Bad Data Size");
  pending_name_ = std::string(w[1]);
  pending_size_ = static_cast<std::size_t>(*size);
  state_ = State::operands;
  return {"OK: " + pending_name_ + "\r\n", std::nullopt, false};
}

Tcp80Session::Step Tcp80Session::command(std::string operands) {
  if (commands_left_ > 0) --commands_left_;
  state_ = commands_left_ == 0 ? State::closed : State::header;
  return {{}, Command{pending_name_, std::move(operands)}, commands_left_ == 0};
}

std::optional<Tcp80Session::Step> Tcp80Session::next() {
  if (state_ == State::closed) return std::nullopt;
  if (state_ == State::operands) {
    if (pending_size_ > 0 && swallow_lf_ && !bytes_.empty()) {  // of the header's CRLF
      swallow_lf_ = false;
      if (bytes_.front() == '\n') bytes_.erase(0, 1);
    }
    if (bytes_.size() < pending_size_) return std::nullopt;
    std::string operands = bytes_.substr(0, pending_size_);
    bytes_.erase(0, pending_size_);
    if (pending_size_ > 0) swallow_lf_ = true;
    return command(std::move(operands));
  }
  while (true) {
    const auto line = take_line();
    if (!line) {
      if (bytes_.size() > kLongestLine) return refuse("Bad Request");
      return std::nullopt;
    }
    if (line->size() > kLongestLine) return refuse("Bad Request");
    if (words(*line).empty() && state_ == State::header) continue;
    return state_ == State::greeting ? greet(*line) : header(*line);
  }
}

}  // namespace pickcell::sim
