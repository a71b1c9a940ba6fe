#include "techniques/shadow_map/hard_shadow.h"

#include "techniques/bases/shadow_map/simd.h"

namespace penumbra {
namespace hard_shadow {
namespace {

class HardShadow : public AreaShadow {
 public:
  explicit HardShadow(const Parameters& p) : AreaShadow(p), kernel_(p.integer("kernel")) {}

 protected:
  void find_visibility(Tile& tile) override {
    timed(filter_part, [&] {
      const int edge = map_.resolution();
      for (int k = 0; k < tile.size(); ++k) {
        const int left = floor_int(tile.x[k]) - (kernel_ - 1) / 2, top = floor_int(tile.y[k]) - (kernel_ - 1) / 2;
        int open = 0;  // texels outside the map are empty
        for (int v = top; v < top + kernel_; ++v)
          for (int u = left; u < left + kernel_; ++u)
            open += u < 0 || v < 0 || u >= edge || v >= edge || !(map_.at(u, v) < tile.depth[k]);
        tile.visibility[k] = float(open) / float(kernel_ * kernel_);
      }
    });
  }
  int kernel_;
};

class HardShadowSimd final : public Simd<HardShadow> {
 public:
  using Simd::Simd;

 protected:
  void find_visibility(Tile& tile) override {
    timed(filter_part, [&] { filter_tile(map_, kernel_, tile); });
  }
};

}  // namespace
}  // namespace hard_shadow

void register_shadow_map(Registry& registry) {
  Entry entry = shadow_map::AreaShadow::entry(
      {integer_parameter("kernel", 1, 1, 255, "map texels", "edge of the filter; 1: a hard shadow")});
  entry.name = "shadow-map";
  entry.summary = "hard shadow of the light's centre, or a fixed filter";
  entry.citation = "Williams 1978; Reeves et al. 1987";
  entry.knobs.push_back({"kernel", {1, 3, 5, 9, 17, 33}});
  add_pair<hard_shadow::HardShadow, hard_shadow::HardShadowSimd>(registry, std::move(entry));
}

}  // namespace penumbra
