#include "techniques/visibility_filter/adaptive.h"

#include <algorithm>
#include <cmath>

#include "techniques/bases/for_ranges.h"
#include "techniques/visibility_filter/kernel.h"

namespace penumbra {
namespace visibility_filter {
namespace {

/// The published D, in the unknown units of the published scenes; here the mean distance to the eye at rest is so many.
constexpr float published_depth = 45.0f;

double mean_over_seen(const Receivers& receivers, const auto& value) {
  double sum = 0.0, count = 0.0;
  for (int i = 0; i < receivers.size(); ++i)
    if (receivers.valid(i)) sum += double(value(i)), count += 1.0;
  return count > 0.0 ? sum / count : 0.0;
}

vec3 extent_of_seen(const Receivers& r) {
  bool any = false;
  Bounds seen;
  for (int i = 0; i < r.size(); ++i) {
    if (!r.valid(i)) continue;
    seen = any ? Bounds{glm::min(seen.low, r.position[i]), glm::max(seen.high, r.position[i])}
               : Bounds{r.position[i], r.position[i]};
    any = true;
  }
  return seen.extent();
}

}  // namespace

Adaptive::Adaptive(const Parameters& p)
    : light_share_(float(p.number("light_share"))),
      depth_units_(float(p.number("depth"))),
      epsilon_units_(float(p.number("epsilon"))),
      lamp_width_(p.text("light") == "lamp"),
      follows_eye_(p.text("view") == "adaptive") {
  filtering_.borrows = p.text("lit") == "nearest";
  filtering_.model.most = p.integer("width");
  filtering_.model.caster_share = float(p.number("caster_share"));
  filtering_.model.literal = p.text("angles") == "literal";
}

void Adaptive::receivers_moved(bool at_rest) {
  const Receivers& r = *receivers_;
  const vec3 extent = extent_of_seen(r);
  const float across = 2.0f * std::sqrt(lamp_area_ / float(pi));  // of a disc of the lamp's area
  WidthModel& model = filtering_.model;
  model.light_diameter = lamp_width_ ? across : (extent.x + extent.y + extent.z) / (3.0f * light_share_);
  if (!at_rest) return;
  const bool eye = !r.view_depth.empty();
  const double mean =
      mean_over_seen(r, [&](int i) { return eye ? r.view_depth[i] : glm::distance(lamp_.centre, r.position[i]); });
  const float unit = float(mean) / published_depth;
  filtering_.epsilon = epsilon_units_ * unit;
  model.view_depth = eye && follows_eye_ ? depth_units_ * unit : 0.0f;
}

Filtered filter_by_rings(const PixelMap& map, int x, int y, float to_eye, const Filtering& how,
                         std::vector<std::uint8_t>& same) {
  const std::size_t i = map.index(x, y);
  Filtered out{0, float(map.open[i])};
  float caster = map.caster[i];
  if (map.open[i] != 0) {
    if (!how.borrows) return out;
    find_surface(map, x, y, how.search_radius(), how.epsilon, same);
    caster = borrowed_caster(map, x, y, how.search_radius(), same);
  }
  out.radius = filter_radius(how.model, map.depth[i], caster, to_eye);
  if (out.radius == 0) return out;
  find_surface(map, x, y, out.radius, how.epsilon, same);
  out.visibility = count_surface(map, x, y, out.radius, same).mean();
  return out;
}

void Adaptive::filter() {
  widths_ = {};
  std::vector<std::uint8_t> same;
  for (int y = 0, i = 0; y < pixels_.height; ++y)
    for (int x = 0; x < pixels_.width; ++x, ++i) {
      visibility_[i] = pixels_.open[i];
      if (!receivers_->valid(i)) continue;
      const Filtered found = filter_by_rings(pixels_, x, y, to_eye(std::size_t(i)), filtering_, same);
      visibility_[i] = found.visibility;
      widths_.note(found.radius);
    }
}

namespace {

class AdaptiveSimd final : public Packets<Adaptive> {
 public:
  using Packets::Packets;

 protected:
  void filter() override {
    bits_.set(pixels_, filtering_.epsilon, filtering_.search_radius());
    std::vector<Widths> rows(std::size_t(pixels_.height));
    const float* const to_eye = receivers_->view_depth.empty() ? nullptr : receivers_->view_depth.data();
    for_ranges(pixels_.height, 4, [&](int begin, int end) {
      std::vector<std::uint8_t> radius(std::size_t(pixels_.width));
      for (int y = begin; y < end; ++y) {
        const std::size_t first = pixels_.index(0, y);
        filter_row(bits_, pixels_, to_eye ? to_eye + first : nullptr, filtering_, y, radius.data(),
                   visibility_.data() + first);
        for (const std::uint8_t r : radius) rows[std::size_t(y)].note(r);
      }
    });
    widths_ = {};
    for (const Widths& row : rows) widths_.add(row);
  }
};

}  // namespace
}  // namespace visibility_filter

void register_visibility_filter(Registry& registry) {
  using namespace visibility_filter;
  Entry entry = entry_of_filter(
      "visibility-filter", "one ray to the lamp's centre, filtered as wide as lamp and caster ask", "Yang et al. 2019");
  entry.parameters = {
      integer_parameter("width", 20, 1, widest, "pixels", "N: the widest filter; a lit pixel looks half as far"),
      number_parameter("light_share", 11.0, 0.1, 1e4, "", "e1: mean extent of what is seen over the lamp's width"),
      number_parameter("caster_share", 12.0, 0.1, 1e4, "", "e2: the lamp's width over a caster's"),
      number_parameter("depth", 45.0, 0.1, 1e6, "units",
                       "D: distance to the eye that widths are meant for; the mean one at rest is 45 units"),
      number_parameter("epsilon", 0.3, 0.0, 1e6, "units",
                       "step in the distance to the lamp from which on neighbours lie on different surfaces"),
      choice_parameter("angles", {"clamped", "literal"},
                       "widths from how much larger the lamp is seen; literal: from how much they differ"),
      choice_parameter("light", {"extent", "lamp"},
                       "the lamp's width: a share of the extent of what is seen, as published, or the lamp's own"),
      choice_parameter("lit", {"nearest", "none"},
                       "caster of a lit pixel: that of the nearest shadowed one, or none: it stays lit"),
      choice_parameter("view", {"adaptive", "fixed"}, "widths in pixels shrink with the distance to the eye, or not")};
  entry.knobs = {{"width", {8, 12, 20, 32, 48, 63}}, {"light", {"extent", "lamp"}}};
  entry.small.set("width", 9);
  entry.kernels.emplace();
  add_pair<Adaptive, AdaptiveSimd>(registry, std::move(entry));
}

}  // namespace penumbra
