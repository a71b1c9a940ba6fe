#include "techniques/pcss/rotated.h"

#include <cmath>

#include "techniques/bases/random.h"

namespace penumbra::pcss {
namespace {

std::vector<vec2> make_samples(Pattern kind, int count) {
  if (kind == Pattern::lattice) return lattice_square(count);
  std::vector<vec2> samples = kind == Pattern::poisson ? poisson_disc(count) : vogel_disc(count);
  for (vec2& s : samples) s /= float(std::sqrt(pi));  // a disc of area 1
  return samples;
}

}  // namespace

RotatedShadow::RotatedShadow(const Parameters& p, bool parallel)
    : AreaShadow(p, parallel), filter_scale_(float(p.number("filter_scale"))) {
  const std::string name = p.text("pattern");
  pattern_.kind = name == "poisson" ? Pattern::poisson : name == "vogel" ? Pattern::vogel : Pattern::lattice;
  pattern_.search = make_samples(pattern_.kind, p.integer("search_samples"));
  pattern_.filter = make_samples(pattern_.kind, p.integer("filter_samples"));
}

std::vector<Parameter> RotatedShadow::parameters() {
  std::vector<Parameter> all = AreaShadow::parameters();
  all.push_back(integer_parameter("search_samples", 16, 1, 1024, "samples", "of the blocker search"));
  all.push_back(integer_parameter("filter_samples", 32, 1, 1024, "samples", "of the filter"));
  all.push_back(choice_parameter("pattern", {"poisson", "vogel", "lattice"},
                                 "Poisson disc turned at random; Vogel's spiral turned by interleaved gradient noise; "
                                 "lattice on the square, shifted"));
  all.push_back(number_parameter("filter_scale", 1.0, 0.0, 16.0, "", "c: filter width over penumbra width"));
  return all;
}

void RotatedShadow::find_turns(const Tile& tile, std::vector<float>& u, std::vector<float>& v) const {
  u.resize(std::size_t(tile.size())), v.resize(u.size());
  for (int k = 0; k < tile.size(); ++k) {
    const int x = tile.column + k % tile.columns, y = tile.row + k / tile.columns;
    const RandomTriple random = random_triple(std::uint64_t(y) << 32 | std::uint32_t(x), 0);
    if (pattern_.kind == Pattern::lattice) {
      u[k] = random.x, v[k] = random.y;
      continue;
    }
    const float angle = float(2.0 * pi) * (pattern_.kind == Pattern::vogel ? gradient_noise(x, y) : random.x);
    u[k] = std::cos(angle), v[k] = std::sin(angle);
  }
}

void RotatedShadow::find_visibility(Tile& tile) {
  const LightView& view = map_.view;
  const int n = view.resolution;
  const auto depth_at = [&](vec2 at) {  // outside the map nothing blocks
    if (!(at.x >= 0.0f && at.y >= 0.0f && at.x < float(n) && at.y < float(n)))
      return std::numeric_limits<float>::infinity();
    return map_.at(int(at.x), int(at.y));
  };
  std::vector<float> u, v;
  timed(project_part, [&] { find_turns(tile, u, v); });
  timed(blocker_part, [&] {
    for (int k = 0; k < tile.size(); ++k) {
      const float d = tile.depth[k], width = d > view.near ? view.region(view.near, d) : -1.0f;
      float sum = 0.0f, count = 0.0f;
      if (width >= 0.0f)
        for (const vec2& sample : pattern_.search) {
          const float z = depth_at(vec2(tile.x[k], tile.y[k]) + width * placed(pattern_.kind, sample, u[k], v[k]));
          if (z < d) sum += z, count += 1.0f;
        }
      tile.blocker[k] = count > 0.0f ? sum / count : 0.0f;
    }
  });
  timed(filter_part, [&] {
    for (int k = 0; k < tile.size(); ++k) {
      tile.visibility[k] = 1.0f;
      if (!(tile.blocker[k] > 0.0f)) continue;
      const float d = tile.depth[k], width = view.region(tile.blocker[k], d, filter_scale_);
      float closer = 0.0f;
      for (const vec2& sample : pattern_.filter)
        closer += depth_at(vec2(tile.x[k], tile.y[k]) + width * placed(pattern_.kind, sample, u[k], v[k])) < d;
      tile.visibility[k] = 1.0f - closer / float(pattern_.filter.size());
    }
  });
}

}  // namespace penumbra::pcss
