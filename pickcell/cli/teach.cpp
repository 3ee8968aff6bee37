// pickcell teach: a PART.pcm from a picture.

#include "pickcell/matches/teach.hpp"

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <ostream>

#include "pickcell/cli/model_input.hpp"
#include "pickcell/cli/subcommand.hpp"
#include "pickcell/cli/values.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/matches/model_file.hpp"

namespace pickcell::cli {

namespace {

struct Options {
  std::string picture, out, name, mask, roi, angle, scale, ref, height_mm;
  std::vector<std::string> grasps;
  bool json = false;
};

/// `x,y,angle_deg[,sym180]`
core::Result<matches::Grasp> parse_grasp(const std::string& text) {
  const std::string suffix = ",sym180";
  const bool symmetric = text.ends_with(suffix);
  const auto numbers = parse_numbers("--grasp", symmetric ? text.substr(0, text.size() - suffix.size()) : text);
  if (!numbers || numbers->size() != 3)
    return core::failure(core::ErrorCode::usage, "--grasp", "'" + text + "' is not a grasp",
                         "write x,y,angle_deg or x,y,angle_deg,sym180");
  return matches::Grasp{(*numbers)[0], (*numbers)[1], (*numbers)[2], symmetric};
}

core::Result<matches::TeachInput::Point> parse_ref(const std::string& text) {
  const auto numbers = parse_numbers("--ref", text);
  if (!numbers) return tl::unexpected(numbers.error());
  if (numbers->size() != 2)
    return core::failure(core::ErrorCode::usage, "--ref", "'" + text + "' is not a point", "write x,y in pixels");
  return matches::TeachInput::Point{(*numbers)[0], (*numbers)[1]};
}

/// Reads an option's text into target when it was given.
template <class Target, class Parse>
core::Status read_if(const std::string& text, Target& target, Parse parse) {
  if (text.empty()) return {};
  auto value = parse(text);
  if (!value) return core::forward(value);
  target = *value;
  return {};
}

core::Result<matches::TeachInput> input_of(const Options& options) {
  matches::TeachInput input;
  input.name = options.name;
  for (const auto& status :
       {read_if(options.roi, input.roi, [](const auto& t) { return parse_roi("--roi", t); }),
        read_if(options.angle, input.angle_deg, [](const auto& t) { return parse_range("--angle", t); }),
        read_if(options.scale, input.scale, [](const auto& t) { return parse_range("--scale", t); }),
        read_if(options.ref, input.ref_px, parse_ref)})
    if (!status) return tl::unexpected(status.error());
  for (const std::string& text : options.grasps) {
    auto grasp = parse_grasp(text);
    if (!grasp) return core::forward(grasp);
    input.grasps.push_back(*grasp);
  }
  if (!options.height_mm.empty()) {
    const auto height = parse_numbers("--height-mm", options.height_mm);
    if (!height) return tl::unexpected(height.error());
    if (height->size() != 1)
      return core::failure(core::ErrorCode::usage, "--height-mm", "'" + options.height_mm + "' is not one number");
    input.height_m = (*height)[0] / 1000;
  }
  return input;
}

core::Json report(const matches::Taught& taught, const std::string& file) {
  const matches::Model& model = taught.model;
  core::Json warnings = core::Json::array();
  for (const auto& w : taught.warnings) {
    core::Json entry = core::Json::object();
    warnings.push(entry.set("code", w.code).set("text", w.text));
  }
  core::Json out = core::Json::object();
  out.set("model", model.name).set("file", file).set("w", model.picture.width()).set("h", model.picture.height());
  out.set("symmetry_order", model.learnt.symmetry_order).set("ambiguous_deg", model.learnt.ambiguous_deg);
  out.set("second_best_self_match", model.learnt.second_best_self_match);
  out.set("suggested_min_score", model.learnt.suggested_min_score);
  return out.set("warnings", warnings).set("teach_ms", taught.teach_ms);
}

void print_words(const matches::Taught& taught, const Options& options, Io& io) {
  const matches::Model& model = taught.model;
  io.out << options.out << ": " << model.name << ", " << model.picture.width() << "x" << model.picture.height()
         << " pixels, suggested threshold " << model.learnt.suggested_min_score << "\n";
  for (const auto& w : taught.warnings) io.err << "pickcell: " << options.picture << ": warning: " << w.text << "\n";
}

core::Result<int> run(const Options& options, Io& io) {
  if (auto fine = check_not_input(options.out, {options.picture, options.mask}); !fine) return core::forward(fine);
  auto input = input_of(options);
  if (!input) return core::forward(input);
  auto taught = teach_file(options.picture, options.mask, *input);
  if (!taught) return core::forward(taught);
  if (auto saved = matches::save_model(options.out, taught->model); !saved) return core::forward(saved);
  if (options.json)
    io.out << report(*taught, options.out).dump() << "\n";
  else
    print_words(*taught, options, io);
  return 0;
}

Runner add(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("TEMPLATE", options->picture, "picture of one part: PNG, JPEG, BMP, PGM")->required();
  app.add_option("-o,--out", options->out, "model file to write")->required()->type_name("PART.pcm");
  app.add_option("--name", options->name, "name of the part (default: the picture's)");
  app.add_option("--mask", options->mask, "picture of the same size: 128 and brighter is part")->type_name("FILE");
  app.add_option("--roi", options->roi, "use this part of the picture")->type_name("x,y,w,h");
  app.add_option("--angle", options->angle, "angles to search, degrees (default -180,180)")->type_name("lo,hi");
  app.add_option("--scale", options->scale, "sizes to search (default 1,1)")->type_name("lo,hi");
  app.add_option("--ref", options->ref, "the point whose place is reported (default: the centre)")->type_name("x,y");
  app.add_option("--grasp", options->grasps, "where a gripper may take it; may be given several times")
      ->type_name("x,y,deg[,sym180]")
      ->allow_extra_args(false);
  app.add_option("--height-mm", options->height_mm, "height of the matched side above the work plane");
  app.add_flag("--json", options->json, "report as JSON");
  return [options](Io& io) { return run(*options, io); };
}

const Registration registered({"teach", "make a model from a picture of one part", add});

}  // namespace

}  // namespace pickcell::cli
