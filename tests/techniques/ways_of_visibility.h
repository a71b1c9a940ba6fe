// Every way of finding the texels that spheres block, with the resolutions that it exists at.
#pragma once

#include <gtest/gtest.h>

#include <tuple>

namespace penumbra::test {

/// Values of "visibility" and "resolution".
using WayOfVisibility = std::tuple<const char*, int>;
inline auto ways_of_visibility() {
  return testing::Values(WayOfVisibility("table", 16), WayOfVisibility("table", 32), WayOfVisibility("fine", 16),
                         WayOfVisibility("fine", 32), WayOfVisibility("raster", 16), WayOfVisibility("raster", 32),
                         WayOfVisibility("raster", 64));
}

}  // namespace penumbra::test
