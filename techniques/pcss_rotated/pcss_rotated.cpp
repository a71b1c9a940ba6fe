#include "techniques/pcss_rotated/pcss_rotated.h"

#include "techniques/bases/shadow_map/simd.h"

namespace penumbra {
namespace pcss_rotated {
namespace {

class RotatedShadow : public AreaShadow {
 public:
  explicit RotatedShadow(const Parameters& p)
      : AreaShadow(p, float(p.number("region_bias"))), filter_scale_(float(p.number("filter_scale"))) {
    const std::string name = p.text("pattern");
    pattern_.kind = name == "poisson" ? Pattern::poisson : name == "vogel" ? Pattern::vogel : Pattern::lattice;
    pattern_.search = make_samples(pattern_.kind, p.integer("search_samples"));
    pattern_.filter = make_samples(pattern_.kind, p.integer("filter_samples"));
  }

 protected:
  void find_visibility(Tile& tile) override {
    const LightView& view = map_.view;
    const int n = view.resolution;
    const auto depth_at = [&](vec2 q) {  // outside the map nothing blocks
      if (!(q.x >= 0.0f && q.y >= 0.0f && q.x < float(n) && q.y < float(n)))
        return std::numeric_limits<float>::infinity();
      return map_.at(int(q.x), int(q.y));
    };
    Turns turns;
    timed(project_part, [&] { find_turns(pattern_.kind, tile, turns); });
    const auto at = [&](int k, float width, vec2 sample) {
      return vec2(tile.x[k], tile.y[k]) + width * placed(pattern_.kind, sample, turns.u[k], turns.v[k]);
    };
    timed(blocker_part, [&] {
      for (int k = 0; k < tile.size(); ++k) {
        const float d = tile.depth[k], width = d > view.near ? view.region(view.near, d) : -1.0f;
        const float limit = blocking_depth(d, tile.rise[k], width);
        float sum = 0.0f, count = 0.0f;
        if (width >= 0.0f)
          for (const vec2& sample : pattern_.search) {
            const float z = depth_at(at(k, width, sample));
            if (z < limit) sum += z, count += 1.0f;
          }
        tile.blocker[k] = count > 0.0f ? sum / count : 0.0f;
      }
    });
    timed(filter_part, [&] {
      for (int k = 0; k < tile.size(); ++k) {
        tile.visibility[k] = 1.0f;
        if (!(tile.blocker[k] > 0.0f)) continue;
        const float d = tile.depth[k], width = view.region(tile.blocker[k], d, filter_scale_);
        const float limit = blocking_depth(d, tile.rise[k], width);
        float closer = 0.0f;
        for (const vec2& sample : pattern_.filter) closer += depth_at(at(k, width, sample)) < limit;
        tile.visibility[k] = 1.0f - closer / float(pattern_.filter.size());
      }
    });
  }

  SamplePattern pattern_;
  float filter_scale_;
};

class RotatedShadowSimd final : public Simd<RotatedShadow> {
 public:
  using Simd::Simd;

 protected:
  void find_visibility(Tile& tile) override {
    thread_local Turns turns;
    timed(project_part, [&] { find_turns(pattern_.kind, tile, turns); });
    timed(blocker_part, [&] { find_blockers(map_, pattern_, turns, tile); });
    timed(filter_part, [&] { filter(map_, pattern_, turns, filter_scale_, tile); });
  }
};

}  // namespace
}  // namespace pcss_rotated

void register_pcss_rotated(Registry& registry) {
  Entry entry = shadow_map::AreaShadow::entry(
      {integer_parameter("search_samples", 16, 1, 1024, "samples", "samples of the blocker search"),
       integer_parameter("filter_samples", 32, 1, 1024, "samples", "samples of the filter"),
       choice_parameter("pattern", {"poisson", "vogel", "lattice"},
                        "Poisson disc turned at random; Vogel's spiral turned by interleaved gradient noise; lattice "
                        "on the square, shifted"),
       shadow_map::region_bias_parameter(), shadow_map::filter_scale_parameter()});
  entry.name = "pcss-rotated";
  entry.summary = "few samples in both regions, turned at every receiver";
  entry.citation = "Fernando 2005; Jimenez 2014 (interleaved gradient noise)";
  entry.knobs.push_back({"filter_samples", {8, 12, 16, 24, 32, 48, 64, 96, 128}, true});
  add_pair<pcss_rotated::RotatedShadow, pcss_rotated::RotatedShadowSimd>(registry, std::move(entry));
}

}  // namespace penumbra
