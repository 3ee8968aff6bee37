#include "pickcell/core/json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace pickcell::core {

namespace {

constexpr int kMaxDepth = 64;
using Ordered = nlohmann::ordered_json;

Ordered to_nlohmann(const Json& v) {
  if (v.is_object()) {
    Ordered out = Ordered::object();
    for (const auto& [key, member] : v.members()) out[key] = to_nlohmann(member);
    return out;
  }
  if (v.is_array()) {
    Ordered out = Ordered::array();
    for (const Json& item : v.items()) out.push_back(to_nlohmann(item));
    return out;
  }
  if (v.is_string()) return v.string();
  if (v.is_bool()) return *v.boolean();
  if (const auto i = v.integer()) return *i;
  if (const auto d = v.number(); d && std::isfinite(*d)) return *d;
  return nullptr;
}

Json from_nlohmann(const Ordered& v) {
  switch (v.type()) {
    case Ordered::value_t::boolean:
      return v.get<bool>();
    case Ordered::value_t::number_integer:
      return v.get<std::int64_t>();
    case Ordered::value_t::number_unsigned: {
      const auto u = v.get<std::uint64_t>();
      if (u > static_cast<std::uint64_t>(INT64_MAX)) return static_cast<double>(u);
      return static_cast<std::int64_t>(u);
    }
    case Ordered::value_t::number_float:
      return v.get<double>();
    case Ordered::value_t::string:
      return v.get<std::string>();
    case Ordered::value_t::array: {
      Json::Array out;
      for (const auto& item : v) out.push_back(from_nlohmann(item));
      return out;
    }
    case Ordered::value_t::object: {
      Json::Object out;
      for (const auto& [key, member] : v.items()) out.emplace_back(key, from_nlohmann(member));
      return out;
    }
    default:
      return {};
  }
}

}  // namespace

Json& Json::set(std::string key, Json value) {
  if (is_null()) value_ = Object{};
  auto& object = std::get<Object>(value_);
  for (auto& [k, v] : object)
    if (k == key) {
      v = std::move(value);
      return *this;
    }
  object.emplace_back(std::move(key), std::move(value));
  return *this;
}

Json& Json::push(Json value) {
  if (is_null()) value_ = Array{};
  std::get<Array>(value_).push_back(std::move(value));
  return *this;
}

bool Json::is_number() const {
  return std::holds_alternative<std::int64_t>(value_) || std::holds_alternative<double>(value_);
}

const Json& Json::operator[](std::string_view key) const {
  static const Json null;
  for (const auto& [k, v] : members())
    if (k == key) return v;
  return null;
}

bool Json::has(std::string_view key) const {
  for (const auto& [k, v] : members())
    if (k == key) return true;
  return false;
}

const Json::Array& Json::items() const {
  static const Array empty;
  const auto* a = std::get_if<Array>(&value_);
  return a ? *a : empty;
}

const Json::Object& Json::members() const {
  static const Object empty;
  const auto* o = std::get_if<Object>(&value_);
  return o ? *o : empty;
}

std::optional<double> Json::number() const {
  if (const auto* i = std::get_if<std::int64_t>(&value_)) return static_cast<double>(*i);
  if (const auto* d = std::get_if<double>(&value_)) return *d;
  return std::nullopt;
}

std::optional<std::int64_t> Json::integer() const {
  if (const auto* i = std::get_if<std::int64_t>(&value_)) return *i;
  return std::nullopt;
}

std::optional<bool> Json::boolean() const {
  if (const auto* b = std::get_if<bool>(&value_)) return *b;
  return std::nullopt;
}

const std::string& Json::string() const {
  static const std::string empty;
  const auto* s = std::get_if<std::string>(&value_);
  return s ? *s : empty;
}

std::string Json::dump(int indent_spaces) const {
  return to_nlohmann(*this).dump(indent_spaces, ' ', false, Ordered::error_handler_t::replace);
}

Result<Json> parse_json(std::string_view text, std::string_view name) {
  bool too_deep = false;
  const auto depth_limit = [&](int depth, Ordered::parse_event_t, Ordered&) {
    if (depth > kMaxDepth) too_deep = true;
    return depth <= kMaxDepth;
  };
  try {
    const Ordered parsed = Ordered::parse(text, depth_limit);
    if (too_deep) return failure(ErrorCode::unreadable, std::string(name), "JSON nested deeper than 64");
    return from_nlohmann(parsed);
  } catch (const Ordered::exception& e) {
    return failure(ErrorCode::unreadable, std::string(name), std::string("not valid JSON: ") + e.what());
  }
}

}  // namespace pickcell::core
