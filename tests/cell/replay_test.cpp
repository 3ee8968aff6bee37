/// A recorded run of the whole cell, searched again: by the same code nothing changes, and what did change is told.

#include <sstream>

#include "demo_cell.hpp"
#include "pickcell/cell/database.hpp"
#include "pickcell/cli/subcommand.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/matches/model_file.hpp"

namespace pickcell {
namespace {

namespace fs = std::filesystem;

struct Said {
  int code = 0;
  std::string out, err;
  core::Json report;
};

Said pickcell(std::vector<std::string> args) {
  std::ostringstream out, err;
  Said said;
  said.code = cli::run(std::move(args), {out, err});
  said.out = out.str();
  said.err = err.str();
  if (auto parsed = core::parse_json(said.out, "stdout")) said.report = std::move(*parsed);
  return said;
}

class ReplayedCell : public DemoCell {
 protected:
  void SetUp() override {
    DemoCell::SetUp();
    const Said said = pickcell({"serve", (folder_ / "CELL.toml").string(), "--picks", "9", "--record", "--json"});
    ASSERT_EQ(said.code, 0) << said.report.dump() << said.err;
    run_ = said.report["run"].string();
  }
  Said replay(std::vector<std::string> options = {}) {
    options.insert(options.begin(), {"replay", run_, "--json"});
    return pickcell(std::move(options));
  }
  std::int64_t logged(const std::string& sql) {
    auto log = cell::Database::open(fs::path(run_) / "picks.db");
    EXPECT_TRUE(log);
    const auto rows = log->execute(sql);
    EXPECT_TRUE(rows) << rows.error().line();
    return rows && !rows->empty() ? cell::as_integer(rows->front().front()) : -1;
  }
  std::string run_;
};

TEST_F(ReplayedCell, ByTheSameCodeNothingChangesEvenWhenTheCellsFilesAreGone) {
  const std::int64_t frames = logged("SELECT count(*) FROM frame"), finds = logged("SELECT count(*) FROM detection");
  ASSERT_GT(frames, 1);
  for (const char* name : {"CELL.toml", "camera.toml", "plane.toml", "gear_18.pcm", "bracket_l.pcm", "label_box.pcm"})
    fs::remove(folder_ / name);
  const Said said = replay({"--tolerance", "0,0,0"});
  EXPECT_EQ(said.code, 0) << said.out << said.err;
  EXPECT_EQ(said.report["cell"].string(), "recorded");
  EXPECT_EQ(said.report["frames"].integer(), frames);
  EXPECT_EQ(said.report["same"].integer(), frames);
  EXPECT_EQ(said.report["finds"]["same"].integer(), finds);
  EXPECT_TRUE(said.report["changes"].items().empty());
  // Shares are disjoint and whole.
  std::int64_t shared_frames = 0, shared_finds = 0;
  for (const char* shard : {"1/3", "2/3", "3/3"}) {
    const Said share = replay({"--shard", shard});
    EXPECT_EQ(share.code, 0);
    shared_frames += share.report["frames"].integer().value_or(0);
    shared_finds += share.report["finds"]["same"].integer().value_or(0);
  }
  EXPECT_EQ(shared_frames, frames);
  EXPECT_EQ(shared_finds, finds);
}

TEST_F(ReplayedCell, AModelThatAsksForMoreLosesWhatItTurnsDown) {
  const fs::path model = folder_ / "gear_18.pcm";
  auto gear = matches::load_model(model);
  ASSERT_TRUE(gear);
  gear->learnt.suggested_min_score = 0.999;  // no picture is that good
  ASSERT_TRUE(matches::save_model(model, *gear));
  const std::int64_t gears = logged("SELECT count(*) FROM detection WHERE part = 'gear_18' AND rejected = 0");
  ASSERT_GT(gears, 0);
  EXPECT_EQ(replay().code, 0) << "the run has its own models";
  const Said said = replay({"--cell", (folder_ / "CELL.toml").string()});
  EXPECT_EQ(said.code, 1) << said.err;
  std::int64_t told = 0;
  for (const core::Json& change : said.report["changes"].items()) {
    EXPECT_TRUE(change["part"].string() == "gear_18" || change["recorded"]["code"].string() == "clearance")
        << change.dump();
    if (change["part"].string() != "gear_18" || change["recorded"]["rejected"].boolean().value_or(true)) continue;
    ++told;
    EXPECT_TRUE(change["change"].string() == "lost" || change["now"]["code"].string() == "score") << change.dump();
  }
  EXPECT_EQ(told, gears);
  const Said words = pickcell({"replay", run_, "--cell", (folder_ / "CELL.toml").string()});
  EXPECT_EQ(words.code, 1);
  EXPECT_TRUE(words.out.starts_with("frames ")) << words.out;
  EXPECT_NE(words.out.find("gear_18"), std::string::npos);
}

TEST_F(ReplayedCell, ACalibrationForOtherPicturesIsSaidOnce) {
  std::string camera = *core::read_text_file(folder_ / "camera.toml");
  camera.replace(camera.find("1280"), 4, "1000");
  ASSERT_TRUE(core::write_file_atomically(folder_ / "camera.toml", camera));
  const Said said = replay({"--cell", (folder_ / "CELL.toml").string()});
  EXPECT_EQ(said.code, 1);
  ASSERT_EQ(said.report["notes"].items().size(), 1u) << said.out;
  EXPECT_NE(said.report["notes"].items().front().string().find("made for pictures of 1000x1024"), std::string::npos);
  for (const core::Json& change : said.report["changes"].items())
    EXPECT_EQ(change["now"]["code"].string(), "calibration");
}

TEST_F(ReplayedCell, ToldIsByHowMuchPlacesMoved) {
  // Recorded a pixel and 0.6 mm beside where it is seen.
  logged("UPDATE detection SET x_px = x_px + 1, base_y_mm = base_y_mm - 0.6 WHERE id = 2 RETURNING 1");
  const Said said = replay();
  EXPECT_EQ(said.code, 1);
  ASSERT_EQ(said.report["changes"].items().size(), 1u) << said.out;
  const core::Json& change = said.report["changes"].items().front();
  EXPECT_NEAR(change["off_px"].number().value_or(0), 1, 1e-6);
  EXPECT_NEAR(change["off_mm"].number().value_or(0), 0.6, 1e-6);
  EXPECT_EQ(change["what"].items().size(), 1u);
  EXPECT_EQ(replay({"--tolerance", "1.1,0.05,0.7"}).code, 0);
}

TEST_F(ReplayedCell, PartsThatWereGivenUpStandInNobodysWayAgain) {
  // The cell plans as if they were not there: a part beside them is good to pick.
  const std::int64_t tight = logged("SELECT id FROM detection WHERE code = 'clearance'");
  ASSERT_GT(tight, 0);
  const std::string id = std::to_string(tight);
  logged("UPDATE detection SET rejected = 0, code = '', reason = '' WHERE id = " + id + " RETURNING 1");
  EXPECT_EQ(replay().code, 1) << "its neighbours are in its way";
  logged(
      "UPDATE detection SET rejected = 1, code = 'gave_up', reason = 'picking it failed 2 times', base_x_mm = NULL, "
      "base_y_mm = NULL, base_z_mm = NULL, base_angle_deg = NULL WHERE id <> " +
      id + " AND frame = (SELECT frame FROM detection WHERE id = " + id + ") RETURNING 1");
  const Said said = replay();
  EXPECT_EQ(said.code, 0) << said.out;
}

TEST_F(ReplayedCell, PicturesThatAreMissingOrWereNotKeptAreCounted) {
  const fs::path picture = fs::path(run_) / "frames" / "00000001.png";
  fs::remove(picture);
  Said said = replay();
  EXPECT_EQ(said.code, 2);
  EXPECT_EQ(said.report["unreadable"].integer(), 1);
  EXPECT_NE(said.err.find("00000001.png"), std::string::npos) << said.err;
  EXPECT_EQ(said.report["same"].integer().value_or(0) + 1, said.report["frames"].integer());
  logged("UPDATE frame SET file = NULL WHERE sequence = 1 RETURNING 1");
  said = replay();
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_EQ(said.report["without_picture"].integer(), 1);
  logged("UPDATE frame SET file = NULL RETURNING 1");
  said = replay();
  EXPECT_EQ(said.code, 2);
  EXPECT_NE(said.err.find("kept no pictures"), std::string::npos) << said.err;
}

TEST_F(ReplayedCell, WhatCannotBeReadIsOneLine) {
  fs::resize_file(fs::path(run_) / "picks.db", 6000);
  for (const Said& said : {replay(), replay({"--shard", "0/2"}), replay({"--tolerance", "1,2"}),
                           pickcell({"replay", folder_.string()}), pickcell({"replay"})}) {
    EXPECT_EQ(said.code, 2);
    EXPECT_TRUE(said.out.empty());
    EXPECT_TRUE(said.err.starts_with("pickcell: ")) << said.err;
    EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
  }
}

}  // namespace
}  // namespace pickcell
