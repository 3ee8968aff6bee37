#include "pickcell/server/assets.hpp"

#include <zlib.h>

#include <array>
#include <functional>
#include <utility>

#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"

namespace pickcell::server {

namespace {

using core::ErrorCode;
using core::failure;

constexpr std::size_t kLimitBytes = std::size_t{4} << 20;
constexpr const char* kRemedy = "run `npm run build` in hmi/";

struct Manifest {
  struct File {
    std::string path;
    bool immutable = false;
  };
  std::string build;
  std::vector<File> files;
};

core::Result<Manifest> read_manifest(std::string_view text, const std::string& name) {
  auto json = core::parse_json(text, name);
  if (!json) return forward(json);
  Manifest out;
  out.build = (*json)["build"].string();
  for (const core::Json& file : (*json)["files"].items()) {
    const std::string& path = file["path"].string();
    if (path.empty() || path.find('/') != std::string::npos || content_type(path).empty())
      return failure(ErrorCode::unreadable, name, "names a file that cannot be served: " + path, kRemedy);
    out.files.push_back({path, file["immutable"].boolean().value_or(false)});
  }
  if (out.build.empty() || out.files.empty())
    return failure(ErrorCode::unreadable, name, "has no build or no files", kRemedy);
  return out;
}

/// Text shrinks to a third; pictures do not.
std::string gzip(const std::string& body) {
  z_stream stream{};
  constexpr int kGzipWindow = 15 + 16;  // zlib: 16 more means the gzip format
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kGzipWindow, 9, Z_DEFAULT_STRATEGY) != Z_OK) return {};
  std::string out(deflateBound(&stream, body.size()), '\0');
  std::string in = body;  // zlib's interface takes no const
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const bool whole = deflate(&stream, Z_FINISH) == Z_STREAM_END;
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return whole && out.size() < body.size() ? out : std::string();
}

Asset make_asset(const std::string& path, bool immutable, std::string body) {
  Asset out{std::string(content_type(path)), immutable, std::move(body), {}};
  if (out.content_type != "image/png") out.gzipped = gzip(out.body);
  return out;
}

}  // namespace

std::string_view content_type(std::string_view path) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kTypes{{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".svg", "image/svg+xml"},
      {".json", "application/json"},
      {".png", "image/png"},
  }};
  for (const auto& [ending, type] : kTypes)
    if (path.ends_with(ending)) return type;
  return {};
}

core::Result<AssetTable> AssetTable::embedded() {
  std::map<std::string_view, std::string_view> files;
  for (const EmbeddedFile& f : embedded_files()) files.emplace(f.path, f.bytes);
  auto manifest = read_manifest(files["manifest.json"], "embedded page");
  if (!manifest) return forward(manifest);
  AssetTable table;
  table.build_ = manifest->build;
  for (const auto& [path, immutable] : manifest->files) {
    const auto found = files.find(path);
    if (found == files.end()) return failure(ErrorCode::unreadable, "embedded page", path + " is not in this binary");
    table.by_target_["/" + path] = make_asset(path, immutable, std::string(found->second));
  }
  return table;
}

core::Result<AssetTable> AssetTable::from_folder(const std::filesystem::path& folder) {
  const auto name = folder / "manifest.json";
  auto text = core::read_text_file(name, kLimitBytes);
  if (!text) return forward(text);
  auto manifest = read_manifest(*text, name.string());
  if (!manifest) return forward(manifest);
  AssetTable table;
  table.build_ = manifest->build;
  for (const auto& [path, immutable] : manifest->files) {
    auto body = core::read_text_file(folder / path, kLimitBytes);
    if (!body) return forward(body);
    table.by_target_["/" + path] = make_asset(path, immutable, std::move(*body));
  }
  return table;
}

const Asset* AssetTable::find(std::string_view target) const {
  const auto found = by_target_.find(target == "/" ? std::string_view("/index.html") : target);
  return found == by_target_.end() ? nullptr : &found->second;
}

}  // namespace pickcell::server
