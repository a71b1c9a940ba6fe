#include "techniques/visibility_filter/chen_2016.h"

#include <algorithm>

#include "techniques/bases/for_ranges.h"
#include "techniques/visibility_filter/kernel.h"

namespace penumbra {
namespace visibility_filter {

namespace {

float mean_about(const PixelMap& map, const Receivers& receivers, int x, int y, int r) {
  Counted counted;
  for (int v = std::max(0, y - r); v <= std::min(map.height - 1, y + r); ++v)
    for (int u = std::max(0, x - r); u <= std::min(map.width - 1, x + r); ++u) {
      const int i = v * map.width + u;
      if (receivers.valid(i)) counted.all += 1, counted.open += map.open[i];
    }
  return counted.mean();
}

}  // namespace

void Fixed::filter() {
  for (int y = 0, i = 0; y < pixels_.height; ++y)
    for (int x = 0; x < pixels_.width; ++x, ++i)
      visibility_[i] = receivers_->valid(i) ? mean_about(pixels_, *receivers_, x, y, radius_) : 1.0f;
}

namespace {

class FixedSimd final : public Packets<Fixed> {
 public:
  using Packets::Packets;

 protected:
  void filter() override {
    bits_.set(pixels_, std::nullopt, radius_);
    for_ranges(pixels_.height, 4, [&](int begin, int end) {
      for (int y = begin; y < end; ++y) box_row(bits_, radius_, y, visibility_.data() + pixels_.index(0, y));
    });
  }
};

}  // namespace
}  // namespace visibility_filter

void register_chen_2016(Registry& registry) {
  using namespace visibility_filter;
  Entry entry = entry_of_filter("chen-2016", "one ray to the lamp's centre, and a box filter", "Chen et al. 2016");
  entry.parameters = {integer_parameter("width", 9, 1, widest, "pixels", "of the box; an even one counts as one less")};
  entry.knobs = {{"width", {3, 5, 9, 15, 21, 31}}};
  entry.kernels.emplace();
  add_pair<Fixed, FixedSimd>(registry, std::move(entry));
}

}  // namespace penumbra
