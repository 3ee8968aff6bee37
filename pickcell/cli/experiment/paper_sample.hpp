#pragma once
/// One sample of experiment table3: a part of the simulated cell, taught with a template of the paper's size, found,
/// grasped and placed.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/matches/engine.hpp"

namespace pickcell::cli {

/// The paper's sample, the simulated part in its template, and the paper's time.
struct Sample {
  const char* name;
  const char* kind;
  const char* look;
  int w, h;
  double paper_s;
};
extern const std::array<Sample, 10> kSamples;

/// A sample that is not found in so many looks is given up.
constexpr int kLooksPerSample = 6;

struct SampleOutcome {
  bool placed = false;
  std::int64_t looks = 0;
  std::optional<double> place_mm, place_deg;  ///< of the placed part, against the truth
  std::string end;                            ///< why the cell stands
  double search_ms = 0;  ///< the last picture searched again: CPU time, one thread, everything prepared
  std::vector<matches::StageReport> stages;  ///< of that search
};

/// Runs the cell until the part is placed, or given up. Writes the cell's folder and an overlay of the last picture
/// below out. settings: of the engine.
[[nodiscard]] core::Result<SampleOutcome> pick_sample(const Sample& sample, const std::string& engine,
                                                      const matches::Settings& settings,
                                                      const std::filesystem::path& out, std::uint64_t seed);

}  // namespace pickcell::cli
