#pragma once
/// The exhaustive search at the top level: every position, angle and scale; what remains are local maxima.

#include <memory_resource>
#include <optional>
#include <vector>

#include "pickcell/matches/coarse/scene.hpp"
#include "pickcell/matches/coarse/template.hpp"
#include "pickcell/matches/model.hpp"
#include "pickcell/matches/similarity.hpp"
#include "pickcell/matches/work.hpp"

namespace pickcell::matches {

struct CoarseCandidate {
  Similarity place;
  float score = 0;
};

struct CoarseRequest {
  Range angle_deg{-180, 180};
  /// Where the anchor may lie, level-0 pixels; unset: anywhere.
  struct Box {
    double x0, y0, x1, y1;
  };
  std::optional<Box> box;
  int candidates = 48;
  int per_location = 8;          ///< candidates whose anchors lie within a quarter of the part's side
  float relative_limit = 0.45f;  ///< of the best score
  float limit = 0.f;
  bool border = false;  ///< only where less of the part is in the picture than a match must show
  int threads = 1;
};

/// Keeps its maps between calls. Not thread-safe; the answer does not depend on the number of threads.
class CoarseSearch {
 public:
  /// Replaces out by the best, best first. The scene must have been built with the templates' factor and a margin >=
  /// their reach.
  void run(const CoarseScene& scene, const CoarseTemplates& templates, const CoarseRequest& request, WorkBudget& budget,
           std::pmr::vector<CoarseCandidate>& out);
  /// Local maxima found by the last run, before the best were picked.
  [[nodiscard]] int peaks() const { return static_cast<int>(all_.size()); }

 private:
  struct Span {
    int lo = 0, hi = 0;  ///< half open
    [[nodiscard]] bool has(int v) const { return v >= lo && v < hi; }
  };
  struct Map {
    bool searched = false;
    image::Plane<float> score;
    std::vector<float> row_best;
    std::vector<std::int32_t> offsets;
    Span columns, rows;                        ///< positions that show enough for a match
    std::vector<float> column_gain, row_gain;  ///< what makes up for the share that lies outside the picture
  };
  struct Peak {
    float score;
    int tile, y, x;
  };
  /// Positions along one axis from which enough of the template is in the picture, and inside the box.
  static Span positions(int cells, int low, int high, double factor, const double* box_lo, const double* box_hi);
  /// The score there as if what lies outside agreed as well as what is inside.
  static void make_up(const Map& map, int y, int x_lo, int x_hi, float* row);
  static float made_up(const Map& map, int x, int y, float score);
  void fill(Map& map, const CoarseScene& scene, const CoarseTemplates& t, const CoarseTile& tile,
            const CoarseRequest& request);
  void find_local_maxima(const CoarseTemplates& t, float limit, bool border);
  [[nodiscard]] bool is_peak(const CoarseTemplates& t, const Peak& p) const;

  std::vector<Map> maps_;
  std::vector<Peak> all_, taken_;
};

}  // namespace pickcell::matches
