#include "pickcell/cli/bench/dataset.hpp"

#include <cmath>
#include <map>

#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"

namespace pickcell::cli {

namespace {

using core::ErrorCode;
using core::Json;

/// Reads the keys of one truth file; the first problem is kept and ends the reading.
class TruthReader {
 public:
  explicit TruthReader(std::string name) : name_(std::move(name)) {}

  [[nodiscard]] bool failed() const { return error_.has_value(); }
  [[nodiscard]] core::Error error() const { return *error_; }

  void problem(std::string why) {
    if (!error_)
      error_ = core::Error{ErrorCode::unreadable, name_, std::move(why), "see docs/interfaces.md, bench", {}};
  }

  double number(const Json& object, const std::string& place, const char* key) {
    const auto value = object[key].number();
    if (!value || !std::isfinite(*value)) {
      problem(place + "." + key + (object.has(key) ? " is not a number" : " is missing"));
      return 0;
    }
    return *value;
  }

  std::string text(const Json& object, const std::string& place, const char* key) {
    if (!object[key].is_string() || object[key].string().empty()) {
      problem(place + "." + key + (object.has(key) ? " is not a text" : " is missing"));
      return {};
    }
    return object[key].string();
  }

  /// Paths stay inside the set.
  std::filesystem::path path(const Json& object, const std::string& place, const char* key) {
    const std::filesystem::path relative = text(object, place, key);
    for (const auto& part : relative)
      if (part == ".." || relative.is_absolute()) problem(place + "." + key + " leaves the set's folder");
    return relative;
  }

  std::optional<PictureSize> size(const Json& object, const std::string& place, const char* width, const char* height) {
    if (object[width].is_null() && object[height].is_null()) return std::nullopt;
    const auto w = object[width].integer();
    const auto h = object[height].integer();
    if (!w || !h || *w < 1 || *h < 1 || *w > 1 << 20 || *h > 1 << 20) {
      problem(place + ": " + width + " and " + height + " are not a picture's size");
      return std::nullopt;
    }
    return PictureSize{static_cast<int>(*w), static_cast<int>(*h)};
  }

  TruthPose pose(const Json& object, const std::string& place) {
    const TruthPose pose{number(object, place, "x"), number(object, place, "y"), number(object, place, "angle"),
                         number(object, place, "scale")};
    if (!failed() && pose.scale <= 0) problem(place + ".scale is not above 0");
    return pose;
  }

 private:
  std::string name_;
  std::optional<core::Error> error_;
};

/// The names under which a set may speak of a picture: an id, or a source {"origin", "path"}. Lists give all their
/// names.
void add_names(const Json& record, std::vector<std::string>& names) {
  if (record.is_string() && !record.string().empty()) names.push_back(record.string());
  if (record.is_object()) {
    if (record.has("origin") || record.has("path"))
      names.push_back(record["origin"].string() + " : " + record["path"].string());
    if (record["id"].is_string()) names.push_back(record["id"].string());
    add_names(record["source"], names);
  }
  for (const Json& item : record.items()) add_names(item, names);
}

DatasetTemplate read_template(const Json& object, const std::string& place, TruthReader& in) {
  DatasetTemplate out;
  out.id = in.text(object, place, "id");
  out.file = in.path(object, place, "file");
  if (!object["mask"].is_null()) out.mask = in.path(object, place, "mask");
  out.size_px = in.size(object, place, "w", "h");
  out.size = object["size"].string();
  out.category = object["category"].string();
  add_names(object["source"], out.sources);
  if (!object["symmetry_deg"].is_null()) {
    out.symmetry_deg = in.number(object, place, "symmetry_deg");
    if (!in.failed() && (out.symmetry_deg <= 0 || out.symmetry_deg > 360))
      in.problem(place + ".symmetry_deg is not above 0 and at most 360");
  }
  return out;
}

DatasetImage read_image(const Json& object, const std::string& place, const std::map<std::string, std::size_t>& ids,
                        TruthReader& in) {
  DatasetImage out;
  out.file = in.path(object, place, "file");
  const std::string id = in.text(object, place, "template");
  if (const auto found = ids.find(id); found != ids.end())
    out.template_index = found->second;
  else
    in.problem(place + ".template: no template has the id '" + id + "'");
  out.kind = object["kind"].string();
  out.size_px = in.size(object, place, "width", "height");
  out.has_instances = object.has("instances");
  if (out.has_instances) {
    if (!object["instances"].is_array()) in.problem(place + ".instances is not a list");
    const auto& items = object["instances"].items();
    for (std::size_t i = 0; i < items.size(); ++i)
      out.truths.push_back(in.pose(items[i], place + ".instances[" + std::to_string(i) + "]"));
  } else {
    out.truths.push_back(in.pose(object, place));
  }
  out.has_clutter = object.has("clutter");
  for (const char* key : {"background", "occluder", "clutter"}) add_names(object[key], out.contents);
  return out;
}

void read_scale_range(const Json& truth, Dataset& set, TruthReader& in) {
  const Json& range = truth["scale_range"];
  if (range.is_null()) return;
  std::vector<double> ends;
  for (const Json& item : range.items()) ends.push_back(item.number().value_or(-1));
  if (ends.size() == 2 && ends[0] > 0 && ends[0] <= ends[1] && std::isfinite(ends[1]))
    set.scale = {ends[0], ends[1]};
  else
    in.problem("scale_range is not [lo, hi] with 0 < lo <= hi");
}

}  // namespace

core::Result<Dataset> parse_dataset(std::string_view text, const std::string& name,
                                    const std::filesystem::path& folder) {
  auto truth = core::parse_json(text, name);
  if (!truth) return core::forward(truth);
  TruthReader in(name);
  Dataset set;
  set.folder = folder;
  set.name = (*truth)["name"].is_string() ? (*truth)["name"].string() : folder.filename().string();
  for (const char* list : {"templates", "images"})
    if (!(*truth)[list].is_array())
      in.problem(std::string(list) + ((*truth).has(list) ? " is not a list" : " is missing"));
  read_scale_range(*truth, set, in);

  std::map<std::string, std::size_t> ids;
  const auto& templates = (*truth)["templates"].items();
  for (std::size_t i = 0; i < templates.size() && !in.failed(); ++i) {
    const std::string place = "templates[" + std::to_string(i) + "]";
    set.templates.push_back(read_template(templates[i], place, in));
    if (!ids.emplace(set.templates.back().id, i).second) in.problem(place + ".id is used twice");
  }
  const auto& images = (*truth)["images"].items();
  for (std::size_t i = 0; i < images.size() && !in.failed(); ++i)
    set.images.push_back(read_image(images[i], "images[" + std::to_string(i) + "]", ids, in));
  if (set.images.empty()) in.problem("images is empty");
  if (in.failed()) return tl::unexpected<core::Error>(in.error());
  return set;
}

core::Result<Dataset> load_dataset(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored))
    return core::failure(ErrorCode::unreadable, folder.string(), "no such folder",
                         "a data set is a folder with truth.json, templates/ and images/");
  const auto file = folder / "truth.json";
  auto text = core::read_text_file(file, std::size_t{256} << 20);
  if (!text) return core::forward(text);
  auto absolute = std::filesystem::absolute(folder, ignored).lexically_normal();
  if (!absolute.has_filename()) absolute = absolute.parent_path();
  return parse_dataset(*text, file.string(), absolute);
}

}  // namespace pickcell::cli
