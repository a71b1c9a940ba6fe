// visibility-filter: the width of every pixel's filter follows from how large lamp and nearest caster are seen, and a
// mask keeps it on its surface (Yang et al. 2019). A lit pixel has no caster of its own: it takes the one of the
// nearest shadowed pixel on its surface within half the widest filter.
#include <algorithm>
#include <cmath>

#include "techniques/bases/for_ranges.h"
#include "techniques/visibility_filter/filter_width.h"
#include "techniques/visibility_filter/visibility_filter.h"

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

/// Of the pixels that were filtered.
struct Widths {
  std::size_t filtered = 0, sum = 0;
  int narrowest = 0, widest = 0;
  void note(int r) { add({1, std::size_t(2 * r + 1), 2 * r + 1, 2 * r + 1}); }
  void add(const Widths& other) {
    narrowest = filtered == 0         ? other.narrowest
                : other.filtered == 0 ? narrowest
                                      : std::min(narrowest, other.narrowest);
    widest = std::max(widest, other.widest);
    filtered += other.filtered, sum += other.sum;
  }
};

class Adaptive : public FilteredVisibility {
 public:
  explicit Adaptive(const Parameters& p)
      : borrows_(p.text("lit") == "nearest"),
        light_share_(float(p.number("light_share"))),
        depth_units_(float(p.number("depth"))),
        epsilon_units_(float(p.number("epsilon"))),
        lamp_width_(p.text("light") == "lamp"),
        follows_eye_(p.text("view") == "adaptive") {
    model_.most = p.integer("width");
    model_.caster_share = float(p.number("caster_share"));
    model_.literal = p.text("angles") == "literal";
  }

  std::map<std::string, std::size_t> counters() const override {
    return {{"filtered", widths_.filtered},
            {"narrowest", std::size_t(widths_.narrowest)},
            {"widest", std::size_t(widths_.widest)},
            {"sum_of_widths", widths_.sum}};
  }

 protected:
  /// D1, and at rest what the published units are in metres.
  void receivers_moved(bool at_rest) override {
    const Receivers& r = *receivers_;
    const vec3 extent = extent_of_seen(r);
    const float across = 2.0f * std::sqrt(lamp_area_ / float(pi));  // of a disc of the lamp's area
    model_.light_diameter = lamp_width_ ? across : (extent.x + extent.y + extent.z) / (3.0f * light_share_);
    if (!at_rest) return;
    const bool eye = !r.view_depth.empty();
    const double mean =
        mean_over_seen(r, [&](int i) { return eye ? r.view_depth[i] : glm::distance(lamp_.centre, r.position[i]); });
    const float unit = float(mean) / published_depth;
    epsilon_ = epsilon_units_ * unit;
    model_.view_depth = eye && follows_eye_ ? depth_units_ * unit : 0.0f;
  }

  int radius(std::size_t i, float caster) const {
    const float to_eye = receivers_->view_depth.empty() ? 1.0f : receivers_->view_depth[i];
    return filter_radius(model_, pixels_.depth[i], caster, to_eye);
  }
  int search_radius() const { return model_.most / 2; }

  void filter() override {
    widths_ = {};
    std::vector<std::uint8_t> same;
    for (int y = 0, i = 0; y < pixels_.height; ++y)
      for (int x = 0; x < pixels_.width; ++x, ++i) {
        float caster = pixels_.caster[i];
        visibility_[i] = pixels_.open[i];
        if (!receivers_->valid(i)) continue;
        if (pixels_.open[i] != 0) {
          if (!borrows_) continue;
          find_surface(pixels_, x, y, search_radius(), epsilon_, same);
          caster = borrowed_caster(pixels_, x, y, search_radius(), same);
        }
        const int r = radius(std::size_t(i), caster);
        if (r == 0) continue;
        find_surface(pixels_, x, y, r, epsilon_, same);
        visibility_[i] = count_surface(pixels_, x, y, r, same).mean();
        widths_.note(r);
      }
  }

  float epsilon_ = 0.0f;
  bool borrows_;
  Widths widths_;

 private:
  WidthModel model_;
  float light_share_, depth_units_, epsilon_units_;
  bool lamp_width_, follows_eye_;
};

class AdaptiveSimd final : public Packets<Adaptive> {
 public:
  using Packets::Packets;

 protected:
  void filter() override {
    bits_.set(pixels_, epsilon_, search_radius());
    std::vector<Widths> rows(std::size_t(pixels_.height));
    for_ranges(pixels_.height, 4, [&](int begin, int end) {
      for (int y = begin; y < end; ++y) filter_row(y, rows[y]);
    });
    widths_ = {};
    for (const Widths& row : rows) widths_.add(row);
  }

 private:
  void filter_row(int y, Widths& widths) {
    for (int x = 0, i = y * pixels_.width; x < pixels_.width; ++x, ++i) {
      visibility_[i] = pixels_.open[i];
      if (!receivers_->valid(i) || (pixels_.open[i] != 0 && (!borrows_ || !bits_.mixed(x, y)))) continue;
      const float caster = pixels_.open[i] != 0 ? bits_.borrowed_caster(x, y, search_radius()) : pixels_.caster[i];
      const int r = radius(std::size_t(i), caster);
      if (r == 0) continue;
      widths.note(r);
      if (bits_.mixed(x, y)) visibility_[i] = bits_.count(x, y, r).mean();
    }
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
  add_pair<Adaptive, AdaptiveSimd>(registry, std::move(entry));
}

}  // namespace penumbra
