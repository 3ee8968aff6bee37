#include "pickcell/cell/database.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "pickcell/core/file.hpp"

namespace pickcell::cell {
namespace {

class DatabaseTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("pickcell_database_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

TEST_F(DatabaseTest, KeepsEveryTypeAcrossReopening) {
  {
    auto database = Database::open(folder_ / "a.db");
    ASSERT_TRUE(database) << database.error().line();
    ASSERT_TRUE(database->script("CREATE TABLE t (i INTEGER, r REAL, s TEXT, n TEXT) STRICT"));
    ASSERT_TRUE(database->execute("INSERT INTO t VALUES (?1, ?2, ?3, ?4)",
                                  {std::int64_t{1} << 60, 0.125, std::string("a'b\"; DROP"), std::monostate{}}));
    EXPECT_EQ(database->changes(), 1);
  }
  auto again = Database::open(folder_ / "a.db");
  ASSERT_TRUE(again);
  const auto rows = again->execute("SELECT * FROM t");
  ASSERT_TRUE(rows);
  ASSERT_EQ(rows->size(), 1u);
  EXPECT_EQ(as_integer(rows->front()[0]), std::int64_t{1} << 60);
  EXPECT_DOUBLE_EQ(as_real(rows->front()[1]), 0.125);
  EXPECT_EQ(as_text(rows->front()[2]), "a'b\"; DROP");
  EXPECT_TRUE(std::holds_alternative<std::monostate>(rows->front()[3]));
}

TEST_F(DatabaseTest, IsDurableBeforeItReturns) {
  auto database = Database::open(folder_ / "a.db");
  ASSERT_TRUE(database);
  EXPECT_EQ(as_text(database->execute("PRAGMA journal_mode")->front().front()), "wal");
  EXPECT_EQ(as_integer(database->execute("PRAGMA synchronous")->front().front()), 2);
}

TEST_F(DatabaseTest, SaysWhatIsWrongWithTheFile) {
  EXPECT_FALSE(Database::open(folder_ / "missing" / "a.db"));
  ASSERT_TRUE(
      core::write_file_atomically(folder_ / "text.db", std::string_view("this is no database at all, only text\n")));
  const auto text = Database::open(folder_ / "text.db");
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error().code, core::ErrorCode::unreadable);
  EXPECT_NE(text.error().line().find("text.db"), std::string::npos);
}

TEST_F(DatabaseTest, RefusesWrongTypesAndBadStatements) {
  auto database = Database::open(folder_ / "a.db");
  ASSERT_TRUE(database);
  ASSERT_TRUE(database->script("CREATE TABLE t (i INTEGER NOT NULL) STRICT"));
  EXPECT_FALSE(database->execute("INSERT INTO t VALUES (?1)", {std::string("seven")}));
  EXPECT_FALSE(database->execute("SELEKT 1"));
  EXPECT_FALSE(database->execute("INSERT INTO t VALUES (?1)", {std::int64_t{1}, std::int64_t{2}}));
}

}  // namespace
}  // namespace pickcell::cell
