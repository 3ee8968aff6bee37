#include "pickcell/cli/match_output.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>

namespace pickcell::cli {

namespace {

using core::Json;
using matches::Match;

double sigma(const Match& match, int i) { return std::sqrt(std::max(0.0, match.covariance(i, i))); }

Json match_json(const Match& m) {
  Json out = Json::object();
  out.set("model", m.model).set("x_px", m.pose.x_px).set("y_px", m.pose.y_px).set("angle_deg", m.pose.angle_deg);
  out.set("scale", m.pose.scale).set("score", m.score);
  out.set("sigma_x_px", sigma(m, 0))
      .set("sigma_y_px", sigma(m, 1))
      .set("sigma_deg", sigma(m, 2))
      .set("sigma_scale", sigma(m, 3));
  return out.set("visible", m.visible).set("ambiguous_deg", m.ambiguous_deg);
}

Json stage_json(const matches::StageReport& s) {
  Json out = Json::object();
  out.set("stage", s.stage).set("population", s.population).set("survivors", s.survivors);
  return out.set("ncc_count", s.ncc_count).set("feature_count", s.feature_count).set("ms", s.ms);
}

std::string match_words(const Match& m) {
  char text[400];
  std::snprintf(text, sizeof(text),
                "%s  x %.3f  y %.3f  angle %.3f  scale %.4f  score %.3f  (sigma %.3f %.3f px, %.3f deg; visible %.2f)",
                m.model.substr(0, 200).c_str(), m.pose.x_px, m.pose.y_px, m.pose.angle_deg, m.pose.scale, m.score,
                sigma(m, 0), sigma(m, 1), sigma(m, 2), m.visible);
  std::string out = text;
  if (!m.ambiguous_deg.empty()) out += "  angle ambiguous";
  return out;
}

}  // namespace

Json to_json(const MatchedPicture& picture, bool explain) {
  Json found = Json::array(), rejected = Json::array(), stages = Json::array();
  for (const Match& m : picture.found.matches) found.push(match_json(m));
  Json out = Json::object();
  out.set("image", picture.file).set("width", picture.width).set("height", picture.height);
  out.set("engine", picture.engine).set("time_ms", picture.time_ms).set("complete", picture.found.complete);
  out.set("matches", found);
  if (!explain) return out;
  for (const auto& r : picture.found.rejected)
    rejected.push(match_json(r.match).set("reason", name(r.reason)).set("stage", name(r.stage)));
  for (const auto& s : picture.found.stages) stages.push(stage_json(s));
  return out.set("rejected", rejected).set("stages", stages);
}

void print_words(const MatchedPicture& picture, bool explain, std::ostream& out) {
  char head[80];
  const std::size_t count = picture.found.matches.size();
  std::snprintf(head, sizeof(head), ": %zu match%s, %.1f ms%s\n", count, count == 1 ? "" : "es", picture.time_ms,
                picture.found.complete ? "" : ", cut by the budget");
  out << picture.file << head;
  for (const Match& m : picture.found.matches) out << "  " << match_words(m) << "\n";
  if (!explain) return;
  for (const auto& r : picture.found.rejected)
    out << "  rejected (" << name(r.reason) << ", " << name(r.stage) << "): " << match_words(r.match) << "\n";
  for (const auto& s : picture.found.stages) {
    char text[200];
    std::snprintf(text, sizeof(text), "  stage %s: %lld in, %lld out, %lld correlations, %lld comparisons, %.2f ms\n",
                  s.stage.c_str(), static_cast<long long>(s.population), static_cast<long long>(s.survivors),
                  static_cast<long long>(s.ncc_count), static_cast<long long>(s.feature_count), s.ms);
    out << text;
  }
}

}  // namespace pickcell::cli
