// The kernels of filters over binary visibility, executed on the host: equal to the ring loop to the bit.
#include "cuda/surfaces.h"

#include <gtest/gtest.h>

#include "tests/techniques/random_pixels.h"

namespace penumbra::cuda_on_host {
namespace {

using namespace visibility_filter;  // NOLINT: what is tested

struct Size {
  int width, height;
};
constexpr Size sizes[] = {{90, 40}, {1, 1}, {31, 9}, {32, 9}, {33, 9}, {63, 5}, {64, 5}, {65, 70}, {3, 130}, {129, 2}};

std::vector<float> downloaded(const Stream& stream, const DeviceSurfaces& surfaces, const PixelMap& map) {
  std::vector<float> out(map.depth.size());
  copy_to_host(stream, out.data(), surfaces.visibility().data, out.size() * sizeof(float));
  return out;
}

/// Casters near and far, so that filters have all widths.
PixelMap map_of(Size size, unsigned seed) {
  PixelMap map = test::random_map(size.width, size.height, seed);
  for (std::size_t i = 0; i < map.caster.size(); ++i) map.caster[i] *= float(1 + i % 5);
  return map;
}

TEST(SurfaceKernels, FilterAsRingsDo) {
  const Stream stream;
  DeviceSurfaces surfaces;
  std::vector<std::uint8_t> same;
  unsigned seed = 0;
  std::size_t between = 0, widths = 0;
  for (const Size size : sizes)
    for (const int most : {63, 1, 2, 20, 41}) {
      const PixelMap map = map_of(size, ++seed);
      std::vector<float> to_eye(map.depth.size());
      for (std::size_t i = 0; i < to_eye.size(); ++i) to_eye[i] = 1.0f + 0.1f * float(i % 7);
      const Filtering how{{most, 3.0f, 12.0f, false, seed % 2 == 0 ? 1.5f : 0.0f}, 0.3f, seed % 3 != 0};
      Buffer<float> eye;
      eye.upload(stream, to_eye);
      surfaces.resize(stream, size.width, size.height);
      surfaces.upload(stream, map);
      surfaces.queue_filter(stream, how, eye.span());
      const std::vector<float> found = downloaded(stream, surfaces, map);
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
          const std::size_t i = map.index(x, y);
          const Filtered rings = filter_by_rings(map, x, y, to_eye[i], how, same);
          ASSERT_EQ(found[i], rings.visibility)
              << size.width << " x " << size.height << ", " << most << ": " << x << ", " << y;
          between += rings.visibility > 0.0f && rings.visibility<1.0f, widths += rings.radius> 3;
        }
    }
  EXPECT_GT(between, 2000u);
  EXPECT_GT(widths, 2000u);
}

TEST(SurfaceKernels, BoxesCountAllThatIsSeen) {
  const Stream stream;
  DeviceSurfaces surfaces;
  unsigned seed = 0;
  for (const Size size : sizes)
    for (const int r : {31, 0, 4}) {
      const PixelMap map = map_of(size, ++seed);
      surfaces.resize(stream, size.width, size.height);
      surfaces.upload(stream, map);
      surfaces.queue_box(stream, r);
      const std::vector<float> found = downloaded(stream, surfaces, map);
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
          Counted counted;
          for (int v = std::max(0, y - r); v <= std::min(size.height - 1, y + r); ++v)
            for (int u = std::max(0, x - r); u <= std::min(size.width - 1, x + r); ++u)
              if (const std::size_t i = map.index(u, v); !std::isnan(map.depth[i]))
                counted.all += 1, counted.open += map.open[i];
          const bool seen = !std::isnan(map.depth[map.index(x, y)]);
          ASSERT_EQ(found[map.index(x, y)], seen ? counted.mean() : 1.0f) << size.width << ": " << x << ", " << y;
        }
    }
}

}  // namespace
}  // namespace penumbra::cuda_on_host
