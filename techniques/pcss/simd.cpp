#include "techniques/pcss/simd.h"

#include "techniques/pcss/hard_shadow.h"
#include "techniques/pcss/kernel.h"
#include "techniques/pcss/moment_shadow.h"

namespace penumbra::pcss {
namespace {

/// What every member vectorises alike.
template <class Scalar>
class Simd : public Scalar {
 public:
  template <class... Args>
  explicit Simd(const Parameters& p, const Args&... args) : Scalar(p, args..., true) {}
  std::string instruction_set() const override { return simd::target(); }

 protected:
  void find_unshadowed(const LampOutline& lamp, int begin, int end, float* factor) const override {
    simd::find_unshadowed(lamp, *this->receivers_, begin, end, factor);
  }
  void project_tile(Tile& tile) const override { simd::project(this->map_.view, *this->receivers_, this->bias_, tile); }
};

class HardShadowSimd final : public Simd<HardShadow> {
 public:
  using Simd::Simd;

 protected:
  void find_visibility(Tile& tile) override {
    timed(filter_part, [&] { simd::hard_shadow(map_, kernel_, tile); });
  }
};

class SoftShadowSimd final : public Simd<SoftShadow> {
 public:
  using Simd::Simd;

 protected:
  void find_regions(Tile& tile) const override {
    if (options_.overlap) return SoftShadow::find_regions(tile);  // four look-ups of sizes of their own
    simd::search_regions(map_.view, levels_, options_, tile);
  }
  void make_filter_regions(Tile& tile) const override { simd::filter_regions(map_.view, levels_, options_, tile); }
  Blockers blockers_in(const Tile& tile, int k, Sum how, bool depths) const override {
    const float d = tile.depth[k];
    if (how == Sum::texels) return simd::blockers_of_texels(map_, texels_of(tile.x[k], tile.y[k], tile.width[k]), d);
    return simd::blockers_of_square(map_, levels_, samples_, tile.square[k], options_.depth, d, how, depths);
  }
  void blur_image(const MaskedImage& image, MaskedImage& between, std::vector<float>& out) const override {
    for_ranges(image.height, 8, [&](int begin, int end) { simd::blur_rows(image, kernel_, begin, end, between); });
    for_ranges(image.height, 8,
               [&](int begin, int end) { simd::blur_columns(between, kernel_, begin, end, out.data()); });
  }
};

class RotatedShadowSimd final : public Simd<RotatedShadow> {
 public:
  using Simd::Simd;

 protected:
  void find_visibility(Tile& tile) override {
    thread_local simd::Turns turns;
    timed(project_part, [&] { find_turns(tile, turns.u, turns.v); });
    timed(blocker_part, [&] { simd::rotated_blockers(map_, pattern_, turns, tile); });
    timed(filter_part, [&] { simd::rotated_filter(map_, pattern_, turns, filter_scale_, tile); });
  }
};

class MomentShadowSimd final : public Simd<MomentShadow> {
 public:
  using Simd::Simd;

 protected:
  void find_visibility(Tile& tile) override {
    timed(blocker_part, [&] { simd::moment_blockers(map_.view, table_, moment_bias_, tile); });
    timed(filter_part, [&] { simd::moment_filter(map_.view, table_, moment_bias_, filter_scale_, tile); });
  }
};

}  // namespace

template <class Member>
Maker simd_maker() {
  return [](const Parameters& p) { return std::make_unique<Member>(p); };
}
Maker simd_hard_shadow() {
  return simd_maker<HardShadowSimd>();
}
Maker simd_rotated_shadow() {
  return simd_maker<RotatedShadowSimd>();
}
Maker simd_moment_shadow() {
  return simd_maker<MomentShadowSimd>();
}
Maker simd_soft_shadow(SoftOptions (*options)(const Parameters&)) {
  return [options](const Parameters& p) { return std::make_unique<SoftShadowSimd>(p, options(p)); };
}

}  // namespace penumbra::pcss
