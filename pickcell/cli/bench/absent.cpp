#include "pickcell/cli/bench/absent.hpp"

#include <algorithm>

namespace pickcell::cli {

namespace {

bool share_a_name(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  return std::any_of(a.begin(), a.end(),
                     [&](const auto& name) { return std::find(b.begin(), b.end(), name) != b.end(); });
}

bool may_be_in_picture(const DatasetTemplate& other, const DatasetTemplate& own, const DatasetImage& image) {
  if (!other.category.empty() && other.category == own.category) return true;
  if (share_a_name(other.sources, own.sources) || share_a_name(other.sources, image.contents)) return true;
  return share_a_name({other.id}, own.sources) || share_a_name({own.id}, other.sources) ||
         share_a_name({other.id}, image.contents);
}

}  // namespace

std::optional<std::size_t> absent_template(const Dataset& set, std::size_t image_index) {
  const DatasetImage& image = set.images.at(image_index);
  const std::size_t n = set.templates.size();
  if (n < 2) return std::nullopt;
  if ((image.kind == "occl_clutter" || image.kind == "mixed") && !image.has_clutter) return std::nullopt;
  const std::size_t own = image.template_index;
  const std::size_t first = own + 1 + image_index % (n - 1);
  for (std::size_t step = 0; step < n; ++step) {
    const std::size_t other = (first + step) % n;
    if (other != own && !may_be_in_picture(set.templates[other], set.templates[own], image)) return other;
  }
  return std::nullopt;
}

}  // namespace pickcell::cli
