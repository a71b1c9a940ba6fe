#include "techniques/visibility_filter/surface_bits.h"

#include <algorithm>

#include "techniques/bases/for_ranges.h"

namespace penumbra::visibility_filter {

void SurfaceBits::place(int wide, int high) {
  if (wide == width && high == height) return;  // all that is ever set is set anew
  width = wide, height = high, stride = stride_for(wide);
  std::uint64_t** planes[] = {&open,   &seen,      &right,    &down,        &down_right, &down_left,
                              &joined, &near_dark, &near_lit, &near_joined, &mixed,      &whole};
  memory_.assign(std::size(planes) * words(), 0);
  std::uint64_t* next = memory_.data();
  for (std::uint64_t** plane : planes) *plane = next, next += words();
}

void SurfaceBits::set_row(const PixelMap& map, std::optional<float> epsilon, int y) {
  for (int w = 1; w < stride - 1; ++w) {
    const int begin = 64 * w - margin, count = std::min(64, width - begin);
    std::uint64_t lit = 0, there = 0;
    for (int i = 0; i < count; ++i) {
      const std::size_t k = pixel(begin + i, y);
      lit |= std::uint64_t(map.open[k] != 0) << i, there |= std::uint64_t(map.depth[k] == map.depth[k]) << i;
    }
    open[word(w, y)] = lit, seen[word(w, y)] = there;
    if (!epsilon) continue;
    std::uint64_t links[4] = {};
    for (int i = 0; i < count; ++i) {
      const Links bits = links_of(map.depth.data(), width, height, begin + i, y, *epsilon);
      links[0] |= std::uint64_t(bits.right) << i, links[1] |= std::uint64_t(bits.down) << i;
      links[2] |= std::uint64_t(bits.down_right) << i, links[3] |= std::uint64_t(bits.down_left) << i;
    }
    right[word(w, y)] = links[0], down[word(w, y)] = links[1];
    down_right[word(w, y)] = links[2], down_left[word(w, y)] = links[3];
    joined[word(w, y)] = links[0] & links[1] & links[2] & links[3];
  }
}

void SurfaceBits::set(const PixelMap& map, std::optional<float> epsilon, int r) {
  place(map.width, map.height);
  for_ranges(height, 8, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      set_row(map, epsilon, y);
      for (int w = 1; w < stride - 1; ++w) look_across(w, y, r);
    }
  });
  for_ranges(height, 8, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int w = 1; w < stride - 1; ++w) look_along(w, y, r);
  });
}

}  // namespace penumbra::visibility_filter
