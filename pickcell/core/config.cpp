#include "pickcell/core/config.hpp"

#include <toml++/toml.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <deque>
#include <numeric>
#include <set>

#include "pickcell/core/file.hpp"

namespace pickcell::core {

struct Config::Table {
  const toml::table* node;  ///< null: the table is missing
  std::string prefix;       ///< "camera." for error messages
  std::set<std::string, std::less<>> asked;
};

struct Config::File {
  std::string name;
  std::filesystem::path folder;
  toml::table root;
  std::vector<std::string> problems;
  std::deque<std::shared_ptr<Table>> opened;
};

namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row.back();
}

std::optional<double> finite_number(const toml::node* node) {
  if (!node) return std::nullopt;
  const auto v = node->value<double>();
  if (!v || !std::isfinite(*v) || !(node->is_floating_point() || node->is_integer())) return std::nullopt;
  return v;
}

std::optional<std::vector<double>> number_list(const toml::node* node) {
  const toml::array* array = node ? node->as_array() : nullptr;
  if (!array) return std::nullopt;
  std::vector<double> out;
  for (const toml::node& item : *array) {
    const auto v = finite_number(&item);
    if (!v) return std::nullopt;
    out.push_back(*v);
  }
  return out;
}

/// A scalar as written; nullopt for tables, dates and lists in lists.
std::optional<std::string> scalar_text(const toml::node& node) {
  if (node.is_string()) return node.value<std::string>();
  if (node.is_boolean()) return *node.value<bool>() ? "true" : "false";
  if (node.is_integer()) return std::to_string(*node.value<std::int64_t>());
  if (!finite_number(&node)) return std::nullopt;
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof(buffer), *node.value<double>()).ptr;
  return std::string(buffer, end);
}

std::optional<std::string> node_text(const toml::node* node) {
  const toml::array* list = node ? node->as_array() : nullptr;
  if (!list) return node ? scalar_text(*node) : std::nullopt;
  std::string out;
  for (const toml::node& item : *list) {
    const auto text = scalar_text(item);
    if (!text) return std::nullopt;
    out += (out.empty() ? "" : ",") + *text;
  }
  return out;
}

/// Where the string that opens at `at` ends, or the end of the text.
std::size_t end_of_string(std::string_view t, std::size_t at) {
  const char quote = t[at];
  const std::string three(3, quote);
  const bool multi_line = t.substr(at, 3) == three;
  for (std::size_t i = at + (multi_line ? 3 : 1); i < t.size(); ++i) {
    if (quote == '"' && t[i] == '\\')
      ++i;
    else if (multi_line && t.substr(i, 3) == three)
      return i + 2;
    else if (!multi_line && (t[i] == quote || t[i] == '\n'))
      return i;
  }
  return t.size();
}

/// Place of the first byte beyond ASCII outside strings and comments, where TOML allows none; npos: there is none.
/// toml++ looks such characters up in a table with holes, which is undefined behaviour.
std::size_t stray_byte(std::string_view t) {
  for (std::size_t i = t.starts_with("\xEF\xBB\xBF") ? 3 : 0; i < t.size(); ++i) {
    if (t[i] == '#')
      i = std::min(t.find('\n', i), t.size());
    else if (t[i] == '"' || t[i] == '\'')
      i = end_of_string(t, i);
    else if (static_cast<unsigned char>(t[i]) >= 0x80)
      return i;
  }
  return std::string_view::npos;
}

/// The text with ASCII in place of what is beyond. What is no TOML shows in it, before toml++ meets such a character
/// where it expects none.
std::string in_ascii(std::string_view t) {
  std::string out(t.starts_with("\xEF\xBB\xBF") ? t.substr(3) : t);
  for (char& c : out)
    if (static_cast<unsigned char>(c) >= 0x80) c = 'x';
  return out;
}

}  // namespace

std::string nearest(std::string_view key, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, key.size() / 2);
  for (const std::string& c : candidates)
    if (const std::size_t d = edit_distance(key, c); d <= best_distance && (best.empty() || d < best_distance)) {
      best = c;
      best_distance = d;
    }
  return best;
}

Config::Config(std::shared_ptr<File> file, std::shared_ptr<Table> table)
    : file_(std::move(file)), table_(std::move(table)) {
  file_->opened.push_back(table_);
}

Result<Config> Config::parse(std::string_view text, std::string name) {
  auto file = std::make_shared<File>();
  file->name = std::move(name);
  if (const std::size_t at = stray_byte(text); at != std::string_view::npos)
    return failure(
        ErrorCode::unreadable, file->name,
        "line " + std::to_string(1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n')) +
            ": a character beyond ASCII outside of quotes",
        "put it in quotes");
  try {
    if (const std::string ascii = in_ascii(text); ascii != text) static_cast<void>(toml::parse(ascii, file->name));
    file->root = toml::parse(text, file->name);
  } catch (const toml::parse_error& e) {
    return failure(ErrorCode::unreadable, file->name,
                   "line " + std::to_string(e.source().begin.line) + ": " + std::string(e.description()));
  }
  auto root = std::make_shared<Table>(Table{&file->root, "", {}});
  return Config(file, root);
}

Result<Config> Config::load(const std::filesystem::path& path) {
  auto text = read_text_file(path);
  if (!text) return forward(text);
  auto config = parse(*text, path.string());
  if (config) config->file_->folder = std::filesystem::absolute(path).parent_path();
  return config;
}

bool Config::has(std::string_view key) const { return table_->node && table_->node->contains(key); }

void Config::problem(std::string_view key, std::string why) {
  file_->problems.push_back("'" + table_->prefix + std::string(key) + "' " + std::move(why));
}

#define PICKCELL_NODE(key) \
  (table_->asked.emplace(key), table_->node ? table_->node->get(key) : static_cast<const toml::node*>(nullptr))

double Config::number(std::string_view key) {
  const auto v = finite_number(PICKCELL_NODE(key));
  if (!v) problem(key, has(key) ? "must be a finite number" : "is missing");
  return v.value_or(0);
}

double Config::number_or(std::string_view key, double otherwise) {
  table_->asked.emplace(key);
  return has(key) ? number(key) : otherwise;
}

std::int64_t Config::integer(std::string_view key) {
  const toml::node* node = PICKCELL_NODE(key);
  if (!node || !node->is_integer()) {
    problem(key, node ? "must be a whole number" : "is missing");
    return 0;
  }
  return *node->value<std::int64_t>();
}

std::int64_t Config::integer_or(std::string_view key, std::int64_t otherwise) {
  table_->asked.emplace(key);
  return has(key) ? integer(key) : otherwise;
}

std::string Config::string(std::string_view key) {
  const toml::node* node = PICKCELL_NODE(key);
  if (!node || !node->is_string()) {
    problem(key, node ? "must be a string" : "is missing");
    return {};
  }
  return *node->value<std::string>();
}

std::string Config::string_or(std::string_view key, std::string otherwise) {
  table_->asked.emplace(key);
  return has(key) ? string(key) : otherwise;
}

bool Config::boolean_or(std::string_view key, bool otherwise) {
  const toml::node* node = PICKCELL_NODE(key);
  if (!node) return otherwise;
  if (!node->is_boolean()) problem(key, "must be true or false");
  return node->value<bool>().value_or(otherwise);
}

std::string Config::text(std::string_view key) {
  const auto v = node_text(PICKCELL_NODE(key));
  if (!v) problem(key, has(key) ? "must be a string, a finite number, a boolean or a list of these" : "is missing");
  return v.value_or("");
}

std::vector<double> Config::numbers(std::string_view key) {
  auto v = number_list(PICKCELL_NODE(key));
  if (!v) problem(key, has(key) ? "must be a list of finite numbers" : "is missing");
  return v.value_or(std::vector<double>{});
}

std::vector<double> Config::numbers_or(std::string_view key, std::vector<double> otherwise) {
  table_->asked.emplace(key);
  return has(key) ? numbers(key) : otherwise;
}

std::vector<std::string> Config::strings_or(std::string_view key, std::vector<std::string> otherwise) {
  const toml::node* node = PICKCELL_NODE(key);
  if (!node) return otherwise;
  const toml::array* array = node->as_array();
  if (!array || !array->is_homogeneous<std::string>()) {
    problem(key, "must be a list of strings");
    return otherwise;
  }
  std::vector<std::string> out;
  for (const toml::node& item : *array) out.push_back(*item.value<std::string>());
  return out;
}

std::vector<std::vector<double>> Config::matrix(std::string_view key) {
  const toml::node* node = PICKCELL_NODE(key);
  const toml::array* rows = node ? node->as_array() : nullptr;
  std::vector<std::vector<double>> out;
  bool fine = rows != nullptr;
  for (std::size_t i = 0; fine && i < rows->size(); ++i) {
    auto row = number_list(rows->get(i));
    fine = row && (out.empty() || row->size() == out.front().size());
    if (fine) out.push_back(std::move(*row));
  }
  if (!fine) {
    problem(key, node ? "must be rows of numbers, all of one length" : "is missing");
    out.clear();
  }
  return out;
}

std::optional<Config> Config::table_if(std::string_view key) {
  const toml::node* node = PICKCELL_NODE(key);
  if (!node) return std::nullopt;
  if (!node->is_table()) problem(key, "must be a table");
  return Config(file_, std::make_shared<Table>(Table{node->as_table(), table_->prefix + std::string(key) + ".", {}}));
}

Config Config::table(std::string_view key) {
  if (auto found = table_if(key)) return *found;
  return Config(file_, std::make_shared<Table>(Table{nullptr, table_->prefix + std::string(key) + ".", {}}));
}

std::vector<Config> Config::tables(std::string_view key) {
  const toml::node* node = PICKCELL_NODE(key);
  std::vector<Config> out;
  if (!node) return out;
  const toml::array* array = node->as_array();
  if (!array || !array->is_homogeneous<toml::table>()) {
    problem(key, "must be a list of tables ([[" + std::string(key) + "]])");
    return out;
  }
  for (const toml::node& item : *array) {
    const std::string prefix = table_->prefix + std::string(key) + "[" + std::to_string(out.size()) + "].";
    out.push_back(Config(file_, std::make_shared<Table>(Table{item.as_table(), prefix, {}})));
  }
  return out;
}

#undef PICKCELL_NODE

std::filesystem::path Config::path(std::string_view key) {
  const std::filesystem::path given = string(key);
  return given.is_relative() && !given.empty() ? file_->folder / given : given;
}

std::optional<std::filesystem::path> Config::path_if(std::string_view key) {
  table_->asked.emplace(key);
  if (!has(key)) return std::nullopt;
  return path(key);
}

std::vector<std::string> Config::keys() const {
  std::vector<std::string> out;
  if (table_->node)
    for (const auto& [key, value] : *table_->node) out.emplace_back(key.str());
  return out;
}

Status Config::finish() const {
  if (!file_->problems.empty()) return failure(ErrorCode::unreadable, file_->name, file_->problems.front());
  for (const auto& opened : file_->opened) {
    if (!opened->node) continue;
    for (const auto& [key, value] : *opened->node) {
      if (opened->asked.contains(key.str())) continue;
      const std::string near = nearest(key.str(), {opened->asked.begin(), opened->asked.end()});
      return failure(ErrorCode::unreadable, file_->name,
                     "unknown key '" + opened->prefix + std::string(key.str()) + "'",
                     near.empty() ? "remove it" : "did you mean '" + near + "'?");
    }
  }
  return {};
}

}  // namespace pickcell::core
