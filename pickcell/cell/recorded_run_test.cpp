#include "pickcell/cell/recorded_run.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <random>
#include <set>

#include "pickcell/cell/run_log.hpp"
#include "pickcell/core/file.hpp"

namespace pickcell::cell {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kStartUs = 1'767'225'600'000'000;  // 2026-01-01T00:00:00Z

class RecordedRunTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("pickcell_recorded_run_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    for (const char* name : {"CELL.toml", "camera.toml", "handeye.toml", "gear.pcm", "bracket.pcm"})
      EXPECT_TRUE(core::write_file_atomically(folder_ / name, std::string_view(name)));
  }
  void TearDown() override { fs::remove_all(folder_); }

  RunLog create(bool record_frames = true) {
    RunInfo info{"cell", folder_ / "CELL.toml", "cam", "sim", "best", kStartUs, true, KeptFiles{}};
    info.files->cell = folder_ / "CELL.toml";
    info.files->models = {folder_ / "gear.pcm", folder_ / "bracket.pcm"};
    info.files->camera = folder_ / "camera.toml";
    info.files->handeye = folder_ / "handeye.toml";
    auto log = RunLog::create(folder_ / "runs", info, record_frames);
    EXPECT_TRUE(log) << log.error().line();
    return std::move(*log);
  }
  /// Two finds: one to pick, one turned down; the camera is on the arm.
  static core::Status add(RunLog& log, std::uint64_t sequence) {
    ShownFrame shown;
    shown.frame.picture = std::make_shared<const image::Image>(8, 6);
    shown.frame.sequence = sequence;
    shown.frame.exposed_unix_us = kStartUs + 5;
    shown.frame.camera_id = "cam";
    shown.frame.T_base_flange =
        core::Transform<core::Base, core::Flange>(core::rotation_z(0.3), {0.1, 1.0 / 3, -0.123456789012345});
    shown.match_ms = 12.5;
    Detection d;
    d.id = 2 * sequence;
    d.part = "gear";
    d.x_px = 1.25;
    d.score = 0.75;
    Detection rejected = d;
    ++rejected.id;
    rejected.state = DetectionState::rejected;
    rejected.code = "score";
    rejected.why = "score 0.50 is below the threshold 0.70";
    shown.detections = {d, rejected};
    poses::PartPose pose;
    pose.detection_id = d.id;
    pose.T_base_part = core::Transform<core::Base, core::Part>(core::rotation_z(0.5), {0.4, -0.1, 0.006});
    return log.add_frame(shown, {}, {pose});
  }
  void alter(const fs::path& run, const std::string& sql) {
    auto database = Database::open(run / "picks.db");
    ASSERT_TRUE(database) << database.error().line();
    const auto done = database->script(sql);
    ASSERT_TRUE(done) << done.error().line();
  }
  static std::string refusal(const fs::path& run) {
    auto read = RecordedRun::open(run);
    if (!read) return read.error().line();
    for (const RecordedFrame& frame : read->frames())
      if (auto finds = read->finds(frame); !finds) return finds.error().line();
    return "none";
  }

  fs::path folder_;
};

TEST_F(RecordedRunTest, ReadsBackWhatWasWrittenAndLeavesTheFolderAsItWas) {
  fs::path run;
  {
    RunLog log = create();
    ASSERT_TRUE(add(log, 7));
    ASSERT_TRUE(add(log, 9));
    run = log.folder();
  }
  for (const char* name : {"CELL.toml", "camera.toml", "handeye.toml", "gear.pcm", "bracket.pcm"})
    fs::remove(folder_ / name);  // the run has its own
  auto read = RecordedRun::open(run);
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_FALSE(read->open_end());
  EXPECT_EQ(read->info().engine, "best");
  EXPECT_EQ(read->info().started, "2026-01-01T00:00:00Z");
  ASSERT_TRUE(read->info().kept);
  const KeptFiles& kept = *read->info().kept;
  EXPECT_EQ(*core::read_text_file(kept.cell), "CELL.toml");
  EXPECT_EQ(*core::read_text_file(kept.camera), "camera.toml");
  EXPECT_EQ(*core::read_text_file(kept.handeye), "handeye.toml");
  EXPECT_TRUE(kept.plane.empty());
  ASSERT_EQ(kept.models.size(), 2u);
  EXPECT_EQ(*core::read_text_file(kept.models[1]), "bracket.pcm");

  ASSERT_EQ(read->frames().size(), 2u);
  const RecordedFrame& frame = read->frames().front();
  EXPECT_EQ(frame.sequence, 7);
  EXPECT_EQ(frame.exposed_unix_us, kStartUs + 5);
  EXPECT_EQ(frame.camera_id, "cam");
  EXPECT_EQ(frame.width_px, 8);
  EXPECT_EQ(frame.match_ms, 12.5);
  EXPECT_TRUE(fs::exists(run / frame.file));
  ASSERT_TRUE(frame.T_base_flange);
  EXPECT_EQ(frame.T_base_flange->translation_m(), Eigen::Vector3d(0.1, 1.0 / 3, -0.123456789012345)) << "to the bit";
  EXPECT_EQ(frame.T_base_flange->rotation(), core::rotation_z(0.3));

  const auto finds = read->finds(frame);
  ASSERT_TRUE(finds) << finds.error().line();
  ASSERT_EQ(finds->size(), 2u);
  const RecordedFind& good = finds->front();
  const RecordedFind& bad = finds->back();
  EXPECT_EQ(good.part, "gear");
  EXPECT_EQ(good.pose.x_px, 1.25);
  EXPECT_EQ(good.code, "");
  ASSERT_TRUE(good.place);
  EXPECT_NEAR(good.place->x_mm, 400, 1e-9);
  EXPECT_NEAR(good.place->angle_deg, 0.5 * 180 / M_PI, 1e-9);
  EXPECT_TRUE(bad.rejected);
  EXPECT_EQ(bad.code, "score");
  EXPECT_FALSE(bad.place);

  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(run)) names.insert(entry.path().filename().string());
  EXPECT_EQ(names, (std::set<std::string>{"cell", "frames", "picks.db", "run.toml"}));
}

TEST_F(RecordedRunTest, WithoutPicturesNothingIsKept) {
  RunLog log = create(false);
  ASSERT_TRUE(add(log, 1));
  EXPECT_FALSE(fs::exists(log.folder() / "cell"));
  auto read = RecordedRun::open(log.folder());  // while it goes on
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_TRUE(read->open_end());
  EXPECT_FALSE(read->info().kept);
  ASSERT_EQ(read->frames().size(), 1u);
  EXPECT_TRUE(read->frames().front().file.empty());
}

TEST_F(RecordedRunTest, APowerCutCostsTheFrameThatWasBeingWritten) {
  RunLog log = create();
  for (std::uint64_t sequence = 1; sequence <= 4; ++sequence) ASSERT_TRUE(add(log, sequence));
  // The disk as a power cut leaves it: the log beside the database, its last write half done.
  const fs::path cut = folder_ / "cut";
  fs::create_directories(cut);
  for (const char* name : {"run.toml", "picks.db", "picks.db-wal"}) fs::copy(log.folder() / name, cut / name);
  fs::resize_file(cut / "picks.db-wal", fs::file_size(cut / "picks.db-wal") - 1000);
  auto read = RecordedRun::open(cut);
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_TRUE(read->open_end());
  EXPECT_EQ(read->frames().size(), 3u);
  for (const RecordedFrame& frame : read->frames()) EXPECT_TRUE(read->finds(frame));
}

TEST_F(RecordedRunTest, ReadsRunsOfFormat1) {
  const fs::path run = folder_ / "old";
  fs::create_directories(run);
  ASSERT_TRUE(core::write_file_atomically(
      run / "run.toml", std::string_view("started = \"2026-01-01T00:00:00Z\"\ncell = \"c\"\ncell_file = \"/c.toml\"\n"
                                         "camera_id = \"cam\"\nrobot_link = \"sim\"\nengine = \"best\"\n"
                                         "simulated = true\n")));
  alter(run, R"(PRAGMA user_version = 1;
CREATE TABLE frame (
  sequence INTEGER PRIMARY KEY, exposed_unix_us INTEGER NOT NULL, camera_id TEXT NOT NULL, width_px INTEGER NOT NULL,
  height_px INTEGER NOT NULL, grab_ms REAL NOT NULL, match_ms REAL NOT NULL, file TEXT) STRICT;
CREATE TABLE detection (
  id INTEGER PRIMARY KEY, frame INTEGER NOT NULL REFERENCES frame(sequence), part TEXT NOT NULL,
  x_px REAL NOT NULL, y_px REAL NOT NULL, angle_deg REAL NOT NULL, scale REAL NOT NULL, score REAL NOT NULL,
  sigma_x_px REAL, sigma_y_px REAL, sigma_deg REAL, visible REAL,
  base_x_mm REAL, base_y_mm REAL, base_z_mm REAL, base_angle_deg REAL,
  rejected INTEGER NOT NULL, reason TEXT NOT NULL) STRICT;
INSERT INTO frame VALUES (1, 5, 'cam', 8, 6, 1.0, 2.0, 'frames/00000001.png');
INSERT INTO detection VALUES (1,1,'gear',1,2,3,1,0.9,NULL,NULL,NULL,NULL,400,1,2,3,0,'');
INSERT INTO detection VALUES (2,1,'gear',1,2,3,1,0.9,NULL,NULL,NULL,NULL,400,1,2,3,1,'all places of the pattern are taken');
INSERT INTO detection VALUES (3,1,'gear',1,2,3,1,0.9,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,1,'score 0.50 is below');)");
  auto read = RecordedRun::open(run);
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(read->info().format, 1);
  ASSERT_EQ(read->frames().size(), 1u);
  const auto finds = read->finds(read->frames().front());
  ASSERT_TRUE(finds) << finds.error().line();
  ASSERT_EQ(finds->size(), 3u);
  EXPECT_EQ((*finds)[0].code, "");
  EXPECT_EQ((*finds)[1].code, "pattern_full");
  EXPECT_FALSE((*finds)[2].code);
}

TEST_F(RecordedRunTest, DamageIsNamedByFileRowAndColumn) {
  RunLog log = create();
  ASSERT_TRUE(add(log, 1));
  const fs::path run = log.folder();
  EXPECT_EQ(refusal(run), "none");
  const auto after = [&](const std::string& sql) {
    alter(run, sql);
    return refusal(run);
  };
  EXPECT_THAT(after("UPDATE detection SET x_px = 9e999 WHERE id = 2"),
              ::testing::HasSubstr("picks.db, table detection, row 1 of frame 1: 'x_px' is no number"));
  EXPECT_THAT(after("UPDATE frame SET T_base_flange = '[1,2]'"), ::testing::HasSubstr("'T_base_flange' is no rigid"));
  EXPECT_THAT(after("UPDATE frame SET file = 'frames/../../../etc/passwd'"),
              ::testing::HasSubstr("picks.db, table frame, row 1: 'file' names no file of the run's folder"));
  EXPECT_THAT(after("UPDATE frame SET width_px = 0"), ::testing::HasSubstr("'width_px'"));
  EXPECT_THAT(after("DROP TABLE detection"), ::testing::HasSubstr("has no tables"));
  EXPECT_THAT(after("PRAGMA user_version = 7"), ::testing::HasSubstr("format 7, and run.toml says 2"));
}

TEST_F(RecordedRunTest, WhatIsNoRunSaysWhy) {
  EXPECT_THAT(refusal(folder_ / "missing"), ::testing::HasSubstr("no run: it has no run.toml"));
  fs::path run;
  {
    RunLog log = create();
    ASSERT_TRUE(add(log, 1));
    run = log.folder();
  }
  const std::string toml = *core::read_text_file(run / "run.toml");
  const auto with = [&](const std::string& old, const std::string& now) {
    std::string text = toml;
    text.replace(text.find(old), old.size(), now);
    EXPECT_TRUE(core::write_file_atomically(run / "run.toml", text));
    return refusal(run);
  };
  EXPECT_THAT(with("format = 2", "format = 3\nlater = true"), ::testing::HasSubstr("format 3, and this program knows"));
  EXPECT_THAT(with("cell/camera.toml", "/etc/passwd"), ::testing::HasSubstr("'kept.camera' must name a file"));
  EXPECT_THAT(with("cell/part1.pcm", "cell/../../gear.pcm"), ::testing::HasSubstr("'kept.models' must name a file"));
  EXPECT_THAT(with("engine", "engin"), ::testing::HasSubstr("run.toml"));
  ASSERT_TRUE(core::write_file_atomically(run / "run.toml", toml));
  EXPECT_EQ(refusal(run), "none");
  fs::resize_file(run / "picks.db", 5000);
  EXPECT_THAT(refusal(run), ::testing::HasSubstr("picks.db: "));
  fs::resize_file(run / "picks.db", 0);  // copied without its -wal, this is what is left of a run that goes on
  EXPECT_THAT(refusal(run), ::testing::HasSubstr("picks.db: it is empty; what a run that was not closed wrote"));
  fs::remove(run / "picks.db");
  EXPECT_THAT(refusal(run), ::testing::HasSubstr("picks.db: no such file"));
  EXPECT_FALSE(fs::exists(run / "picks.db")) << "reading makes no database";
}

TEST(RecordedRows, AnyRowIsRefusedOrWithinBounds) {
  std::mt19937 random(20260101);
  const auto value = [&]() -> SqlValue {
    const std::vector<std::string> texts{"", "gear", "frames/1.png", "frames/../x", "score", "[1,0,0", "frames/"};
    switch (random() % 6) {
      case 0:
        return std::monostate{};
      case 1:
        return static_cast<std::int64_t>(random() % 10);
      case 2:
        return static_cast<std::int64_t>(static_cast<std::uint64_t>(random()) << 32 | random());
      case 3:
        return static_cast<double>(random() % 100) / 7;
      case 4:
        return std::numeric_limits<double>::infinity();
      default:
        return texts[random() % texts.size()];
    }
  };
  int frames = 0, finds = 0;
  for (int i = 0; i < 200'000; ++i) {
    // Mostly of the right shape, so that the later columns are reached.
    SqlRow frame{1, std::int64_t{5}, std::string("cam"), std::int64_t{8}, std::int64_t{6}, 2.0, std::monostate{}, {}};
    SqlRow find{1, std::int64_t{1}, 2.0, 3.0, 4.0, 1.0, 0.9, {}, {}, {}, {}, std::int64_t{0}, std::string(), {}};
    frame[0] = find[0] = std::int64_t{1};
    find[1] = std::string("gear");
    for (int k = random() % 3; k >= 0; --k) {
      frame[random() % frame.size()] = value();
      find[random() % find.size()] = value();
    }
    if (random() % 20 == 0) frame.resize(random() % frame.size()), find.resize(random() % find.size());
    if (const auto f = frame_from(frame, "frame row")) {
      ++frames;
      ASSERT_TRUE(f->width_px >= 1 && f->width_px <= 32768 && f->height_px >= 1 && f->sequence >= 0);
      ASSERT_TRUE(f->file.empty() || (f->file.starts_with("frames/") && f->file.find("..") == std::string::npos));
    } else {
      ASSERT_TRUE(f.error().line().starts_with("frame row: '")) << f.error().line();
    }
    if (const auto f = find_from(find, "find row")) {
      ++finds;
      ASSERT_TRUE(std::isfinite(f->pose.x_px) && std::isfinite(f->pose.angle_deg) && f->pose.scale > 0);
      ASSERT_TRUE(!f->place || (std::isfinite(f->place->x_mm) && std::isfinite(f->place->angle_deg)));
      ASSERT_TRUE(!f->code || f->code->empty() == !f->rejected);
    }
  }
  EXPECT_GT(frames, 1000);
  EXPECT_GT(finds, 1000);
}

}  // namespace
}  // namespace pickcell::cell
