#include "pickcell/cell/kept_files.hpp"

#include <system_error>
#include <tuple>

#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"

namespace pickcell::cell {

using core::ErrorCode;
using core::failure;
namespace fs = std::filesystem;

namespace {

constexpr const char* kFolder = "cell";

/// Byte for byte: calibrations are tied to each other by checksums. Returns the copy's path from the run's folder.
core::Result<std::string> copy(const fs::path& run, const fs::path& file, const std::string& name) {
  const auto bytes = core::read_file(file);
  if (!bytes) return tl::unexpected(bytes.error());
  const fs::path inside = fs::path(kFolder) / name;
  if (auto written = core::write_file_atomically(run / inside, *bytes); !written) return core::forward(written);
  return inside.generic_string();
}

/// A name that keep_files() gave, or a problem: a run from elsewhere reads nothing outside of its folder.
fs::path inside(core::Config& table, const std::string& key, const std::string& path, const fs::path& run) {
  const fs::path given(path);
  if (given.parent_path() == kFolder && given.filename() != ".." && given.has_filename()) return run / given;
  table.problem(key, "must name a file of the run's folder " + std::string(kFolder));
  return {};
}

}  // namespace

KeptFiles files_of(const CellConfig& config) {
  KeptFiles out{config.file, {}, config.calibration.camera, config.calibration.plane, config.calibration.handeye};
  for (const PartConfig& part : config.parts) out.models.push_back(part.model);
  return out;
}

core::Result<std::string> keep_files(const fs::path& run, const KeptFiles& files) {
  std::error_code problem;
  fs::create_directory(run / kFolder, problem);
  if (problem) return failure(ErrorCode::unreadable, (run / kFolder).string(), problem.message());
  std::string toml = "\n[kept]\n";
  for (const auto& [key, file, name] :
       {std::tuple{"cell", files.cell, "CELL.toml"}, std::tuple{"camera", files.camera, "camera.toml"},
        std::tuple{"plane", files.plane, "plane.toml"}, std::tuple{"handeye", files.handeye, "handeye.toml"}}) {
    if (file.empty()) continue;
    auto copied = copy(run, file, name);
    if (!copied) return copied;
    toml += std::string(key) + " = " + core::Json(*copied).dump() + "\n";
  }
  core::Json models = core::Json::array();
  for (std::size_t i = 0; i < files.models.size(); ++i) {
    auto copied = copy(run, files.models[i], "part" + std::to_string(i + 1) + ".pcm");
    if (!copied) return copied;
    models.push(*copied);
  }
  return toml + "models = " + models.dump() + "\n";
}

KeptFiles read_kept(core::Config table, const fs::path& run) {
  KeptFiles out;
  out.cell = inside(table, "cell", table.string("cell"), run);
  out.camera = inside(table, "camera", table.string("camera"), run);
  const std::string pose = table.has("handeye") ? "handeye" : "plane";
  (table.has("handeye") ? out.handeye : out.plane) = inside(table, pose, table.string(pose), run);
  for (const std::string& model : table.strings_or("models", {}))
    out.models.push_back(inside(table, "models", model, run));
  if (out.models.empty()) table.problem("models", "is missing: a run knows the models it was searched with");
  return out;
}

core::Status read_from(CellConfig& config, const KeptFiles& files) {
  if (files.models.size() != config.parts.size())
    return failure(ErrorCode::unreadable, config.file.string(),
                   std::to_string(config.parts.size()) + " parts, and the run kept " +
                       std::to_string(files.models.size()) + " models",
                   "the run's folder is damaged: restore it, or name a cell with --cell");
  for (std::size_t i = 0; i < files.models.size(); ++i) config.parts[i].model = files.models[i];
  config.calibration.camera = files.camera;
  config.calibration.plane = files.plane;
  config.calibration.handeye = files.handeye;
  return {};
}

}  // namespace pickcell::cell
