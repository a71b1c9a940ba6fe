#include "techniques/bases/irradiance_table.h"

#include <gtest/gtest.h>

#include "techniques/bases/light_sampling.h"
#include "techniques/bases/random.h"
#include "tests/support.h"

namespace penumbra {
namespace {

TEST(IrradianceTable, IsTheSumOverTexels) {
  std::vector<vec3> normals;
  normals.reserve(16);
  for (int i = 0; i < 16; ++i) {
    const RandomTriple r = random_triple(5, std::uint32_t(i));
    normals.push_back(glm::normalize(2.0f * vec3(r.x, r.y, r.z) - 1.0f));
  }
  for (const char* name : {"constant", "softbox", "lamps", "sun-sky"}) {
    Environment environment;
    ASSERT_TRUE(make_environment(name, environment));
    const IrradianceTable table(environment, normals);
    const EnvironmentSampler exact(environment);
    std::vector<vec3> found, expected;
    found.reserve(16), expected.reserve(16);
    for (const vec3 n : normals) found.push_back(table.at(n)), expected.push_back(exact.unshadowed(n));
    EXPECT_LT(test::difference(found, expected), 1e-3) << name;
  }
}

TEST(IrradianceTable, EvenLightFillsTheSphere) {
  const std::vector<vec3> up = {{0, 1, 0}};
  EXPECT_NEAR(IrradianceTable(test::constant_environment(), up).effective_solid_angle(), 4.0 * pi, 0.01 * pi);
  EXPECT_EQ(IrradianceTable(test::constant_environment(vec3(0.0f)), up).effective_solid_angle(), 0.0);
  Environment sun = test::constant_environment(vec3(0.0f));
  sun.radiance[std::size_t(sun.width) * std::size_t(sun.height / 4)] = vec3(100.0f);
  EXPECT_LT(IrradianceTable(sun, up).effective_solid_angle(), 0.005) << "a block or two";
}

}  // namespace
}  // namespace penumbra
