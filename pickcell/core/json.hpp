#pragma once
/// JSON values: one object per line on stdout, truth files, messages of the HMI. Object keys keep their order.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "pickcell/core/result.hpp"

namespace pickcell::core {

class Json {
 public:
  using Array = std::vector<Json>;
  using Object = std::vector<std::pair<std::string, Json>>;

  Json() = default;  ///< null
  Json(bool v) : value_(v) {}
  Json(int v) : value_(std::int64_t{v}) {}
  Json(std::int64_t v) : value_(v) {}
  Json(std::size_t v) : value_(static_cast<std::int64_t>(v)) {}
  Json(double v) : value_(v) {}  ///< NaN and infinity are written as null
  Json(const char* v) : value_(std::string(v)) {}
  Json(std::string_view v) : value_(std::string(v)) {}
  Json(std::string v) : value_(std::move(v)) {}
  Json(Array v) : value_(std::move(v)) {}
  Json(Object v) : value_(std::move(v)) {}
  template <class T>
  Json(const std::vector<T>& values) {
    Array out;
    for (const T& v : values) out.emplace_back(v);
    value_ = std::move(out);
  }
  static Json array() { return Json(Array{}); }
  static Json object() { return Json(Object{}); }

  /// Sets a key of an object (a null becomes an object); the last value of a key wins.
  Json& set(std::string key, Json value);
  /// Appends to an array (a null becomes an array).
  Json& push(Json value);

  [[nodiscard]] bool is_null() const { return std::holds_alternative<std::monostate>(value_); }
  [[nodiscard]] bool is_number() const;
  [[nodiscard]] bool is_string() const { return std::holds_alternative<std::string>(value_); }
  [[nodiscard]] bool is_bool() const { return std::holds_alternative<bool>(value_); }
  [[nodiscard]] bool is_array() const { return std::holds_alternative<Array>(value_); }
  [[nodiscard]] bool is_object() const { return std::holds_alternative<Object>(value_); }

  /// The member, or null when there is none or this is no object.
  [[nodiscard]] const Json& operator[](std::string_view key) const;
  [[nodiscard]] bool has(std::string_view key) const;
  /// Empty unless an array / an object.
  [[nodiscard]] const Array& items() const;
  [[nodiscard]] const Object& members() const;
  [[nodiscard]] std::optional<double> number() const;
  [[nodiscard]] std::optional<std::int64_t> integer() const;
  [[nodiscard]] std::optional<bool> boolean() const;
  /// Empty unless a string.
  [[nodiscard]] const std::string& string() const;

  /// On one line; indent_spaces >= 0 for people.
  [[nodiscard]] std::string dump(int indent_spaces = -1) const;

 private:
  std::variant<std::monostate, bool, std::int64_t, double, std::string, Array, Object> value_;
};

/// name: what is parsed, for the error. Nesting deeper than 64 is refused.
[[nodiscard]] Result<Json> parse_json(std::string_view text, std::string_view name);

}  // namespace pickcell::core
