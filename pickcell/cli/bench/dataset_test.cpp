#include "pickcell/cli/bench/dataset.hpp"

#include <gtest/gtest.h>

#include "pickcell/cli/bench/absent.hpp"

namespace pickcell::cli {
namespace {

core::Result<Dataset> parse(const std::string& text) { return parse_dataset(text, "truth.json", "/sets/small"); }

std::string error_of(const std::string& text) {
  const auto set = parse(text);
  return set ? "no error" : set.error().why;
}

const std::string kTemplates = R"("templates":[{"id":"a","file":"templates/a.png"}])";

TEST(DatasetFile, ReadsTemplatesAndImages) {
  const auto set = parse(R"({"name":"n","made_by":"me","scale_range":[0.5,2],
    "templates":[{"id":"a","file":"templates/a.png","mask":"templates/a_mask.png","size":"small","w":40,"h":30,
                  "symmetry_deg":90,"colour":"red"}],
    "images":[{"file":"images/0.png","template":"a","kind":"clean","width":640,"height":480,"x":1.5,"y":2,"angle":359,"scale":1.1},
              {"file":"images/1.png","template":"a","instances":[{"x":1,"y":2,"angle":3,"scale":1},{"x":5,"y":6,"angle":7,"scale":1}]},
              {"file":"images/2.png","template":"a","instances":[]}]})");
  ASSERT_TRUE(set) << set.error().line();
  EXPECT_EQ(set->name, "n");
  EXPECT_DOUBLE_EQ(set->scale.lo, 0.5);
  EXPECT_DOUBLE_EQ(set->scale.hi, 2);
  EXPECT_EQ(set->templates[0].mask, "templates/a_mask.png");
  EXPECT_DOUBLE_EQ(set->templates[0].symmetry_deg, 90);
  EXPECT_EQ(set->templates[0].size_px->height_px, 30);
  ASSERT_EQ(set->images.size(), 3u);
  EXPECT_FALSE(set->images[0].has_instances);
  EXPECT_DOUBLE_EQ(set->images[0].truths.at(0).angle_deg, 359);
  EXPECT_EQ(set->images[1].truths.size(), 2u);
  EXPECT_TRUE(set->images[2].has_instances);
  EXPECT_TRUE(set->images[2].truths.empty());
}

TEST(DatasetFile, WhatIsNotStatedIsLeftOpen) {
  const auto set =
      parse("{" + kTemplates + R"(,"images":[{"file":"0.png","template":"a","x":1,"y":2,"angle":3,"scale":1}]})");
  ASSERT_TRUE(set) << set.error().line();
  EXPECT_EQ(set->name, "small");  // the folder's name
  EXPECT_DOUBLE_EQ(set->scale.lo, 0.9);
  EXPECT_DOUBLE_EQ(set->scale.hi, 1.1);
  EXPECT_FALSE(set->templates[0].mask);
  EXPECT_DOUBLE_EQ(set->templates[0].symmetry_deg, 360);
  EXPECT_TRUE(set->images[0].kind.empty());
}

TEST(DatasetFile, ProblemsAreNamedWithTheirPlace) {
  const auto image = [](const std::string& members) { return "{" + kTemplates + R"(,"images":[{)" + members + "}]}"; };
  EXPECT_EQ(error_of("{}"), "templates is missing");
  EXPECT_EQ(error_of("{" + kTemplates + "}"), "images is missing");
  EXPECT_EQ(error_of("{" + kTemplates + R"(,"images":[]})"), "images is empty");
  EXPECT_EQ(error_of(image(R"("template":"a","x":1,"y":2,"angle":3,"scale":1)")), "images[0].file is missing");
  EXPECT_EQ(error_of(image(R"("file":"0.png","template":"a","y":2,"angle":3,"scale":1)")), "images[0].x is missing");
  EXPECT_EQ(error_of(image(R"("file":"0.png","template":"a","x":"1","y":2,"angle":3,"scale":1)")),
            "images[0].x is not a number");
  EXPECT_EQ(error_of(image(R"("file":"0.png","template":"a","x":1,"y":2,"angle":3,"scale":0)")),
            "images[0].scale is not above 0");
  EXPECT_EQ(error_of(image(R"("file":"0.png","template":"b","x":1,"y":2,"angle":3,"scale":1)")),
            "images[0].template: no template has the id 'b'");
  EXPECT_EQ(error_of(image(R"("file":"0.png","template":"a","instances":[{"x":1,"y":1,"angle":1}])")),
            "images[0].instances[0].scale is missing");
  EXPECT_EQ(error_of(image(R"("file":"0.png","template":"a","instances":3)")), "images[0].instances is not a list");
  EXPECT_EQ(error_of(image(R"("file":"../0.png","template":"a","instances":[])")),
            "images[0].file leaves the set's folder");
  EXPECT_EQ(error_of(image(R"("file":"0.png","template":"a","instances":[],"width":-1,"height":4)")),
            "images[0]: width and height are not a picture's size");
  EXPECT_EQ(error_of(R"({"templates":[{"id":"a","file":"a.png","symmetry_deg":0}],"images":[]})"),
            "templates[0].symmetry_deg is not above 0 and at most 360");
  EXPECT_EQ(error_of(R"({"templates":[{"id":"a","file":"a.png"},{"id":"a","file":"b.png"}],"images":[]})"),
            "templates[1].id is used twice");
  EXPECT_EQ(error_of("{" + kTemplates + R"(,"scale_range":[1.1,0.9],"images":[]})"),
            "scale_range is not [lo, hi] with 0 < lo <= hi");
  EXPECT_NE(error_of("{\"templates\":").find("not valid JSON"), std::string::npos);
}

TEST(DatasetFile, MissingFolderAndMissingFileAreErrors) {
  const auto none = load_dataset("/no/such/folder");
  ASSERT_FALSE(none);
  EXPECT_EQ(core::exit_code(none.error().code), 2);
  EXPECT_EQ(none.error().what, "/no/such/folder");
  const auto empty = load_dataset(PICKCELL_SOURCE_DIR "/pickcell");
  ASSERT_FALSE(empty);
  EXPECT_NE(empty.error().what.find("truth.json"), std::string::npos);
}

/// Templates 0..n-1 without sources, one image per entry.
Dataset set_of(std::size_t templates) {
  Dataset set;
  for (std::size_t i = 0; i < templates; ++i) {
    DatasetTemplate t;
    t.id = "t" + std::to_string(i);
    set.templates.push_back(t);
  }
  return set;
}

void add_images(Dataset& set, std::size_t count, const DatasetImage& image) { set.images.assign(count, image); }

TEST(AbsentTemplate, GoesForwardByOneMoreThanTheImagesIndex) {
  Dataset set = set_of(5);
  DatasetImage image;
  image.template_index = 3;
  image.kind = "clean";
  add_images(set, 6, image);
  EXPECT_EQ(absent_template(set, 0), 4u);  // 3 + 1
  EXPECT_EQ(absent_template(set, 1), 0u);  // 3 + 2
  EXPECT_EQ(absent_template(set, 3), 2u);  // 3 + 4
  EXPECT_EQ(absent_template(set, 4), 4u);  // 4 mod 4 = 0: as image 0
}

TEST(AbsentTemplate, SkipsWhatMayLieInThePicture) {
  const auto set = parse(R"({"templates":[
      {"id":"a","file":"a.png","category":"tools","source":{"origin":"o","path":"p1","crop":[1,2,3,4]}},
      {"id":"same_category","file":"b.png","category":"tools","source":{"origin":"o","path":"p2"}},
      {"id":"same_source","file":"c.png","category":"food","source":{"origin":"o","path":"p1","crop":[9,9,9,9]}},
      {"id":"background","file":"d.png","category":"food","source":{"origin":"o","path":"p3"}},
      {"id":"occluder","file":"e.png","category":"food","source":{"origin":"o","path":"p4"}},
      {"id":"clutter_source","file":"f.png","category":"food","source":{"origin":"o","path":"p5"}},
      {"id":"clutter_id","file":"g.png","category":"food","source":{"origin":"o","path":"p6"}},
      {"id":"free","file":"h.png","category":"food","source":{"origin":"o2","path":"p1"}}],
    "images":[{"file":"0.png","template":"a","kind":"occl_clutter","x":1,"y":2,"angle":3,"scale":1,
      "background":{"origin":"o","path":"p3"},"occluder":{"origin":"o","path":"p4","template_rect":[1,2,3,4]},
      "clutter":[{"origin":"o","path":"p5","x":1},"clutter_id"]},
      {"file":"1.png","template":"a","kind":"mixed","x":1,"y":2,"angle":3,"scale":1},
      {"file":"2.png","template":"a","kind":"clean","x":1,"y":2,"angle":3,"scale":1},
      {"file":"3.png","template":"a","kind":"occl_clutter","x":1,"y":2,"angle":3,"scale":1,"clutter":[]}]})");
  ASSERT_TRUE(set) << set.error().line();
  EXPECT_EQ(absent_template(*set, 0), 7u);
  EXPECT_FALSE(absent_template(*set, 1));   // kind mixed and no record of the clutter
  EXPECT_EQ(absent_template(*set, 2), 3u);  // 0 + 3
  EXPECT_EQ(absent_template(*set, 3), 4u);  // an empty record is a record
}

TEST(AbsentTemplate, ThereMayBeNone) {
  Dataset set = set_of(1);
  add_images(set, 1, {});
  EXPECT_FALSE(absent_template(set, 0));
  set = set_of(3);
  for (auto& t : set.templates) t.category = "all the same";
  add_images(set, 1, {});
  EXPECT_FALSE(absent_template(set, 0));
}

}  // namespace
}  // namespace pickcell::cli
