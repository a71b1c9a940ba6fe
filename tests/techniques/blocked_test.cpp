// The vectorised search for blocked texels finds the bits of the scalar one.
#include "scenes/scene_file.h"
#include "techniques/bases/find_blocked.h"
#include "techniques/bases/random.h"
#include "techniques/bases/visibility_source.h"
#include "tests/support.h"
#include "tests/techniques/ways_of_visibility.h"

namespace penumbra {
namespace {

vec3 unit(std::uint64_t stream, std::uint32_t k) {
  const RandomTriple r = random_triple(stream, k);
  const float z = 2 * r.x - 1, s = std::sqrt(std::max(0.0f, 1 - z * z)), a = float(2 * pi) * r.y;
  return {s * std::cos(a), s * std::sin(a), z};
}

/// Spheres of all sizes around receivers with normals of their own; some normals and spheres along the axes.
Scene random_scene() {
  std::vector<Sphere> spheres;
  for (std::uint32_t k = 0; k < 40; ++k)
    spheres.push_back(test::cap_sphere(unit(1, k), 0.005 + (k % 4 == 0 ? 1.2 : 0.3) * double(random_triple(2, k).z)));
  for (int axis = 0; axis < 3; ++axis) {
    vec3 v(0.0f);
    v[axis] = 1.0f;
    spheres.push_back(test::cap_sphere(v, 0.3)), spheres.push_back(test::cap_sphere(-v, 0.9));
  }
  spheres.push_back({vec3(0, 0, 5), 0.0f});
  Scene scene = test::sphere_scene({}, test::receivers_at(std::vector<vec3>(300, vec3(0.0f))));
  scene.spheres.spheres = spheres;
  for (int i = 0; i < 300; ++i) {
    scene.receivers.position[i] = 0.05f * unit(3, std::uint32_t(i));
    scene.receivers.normal[i] = i < 6    ? cube_direction(i, 0, 0)
                                : i < 12 ? glm::normalize(cube_direction(i - 6, 1, 0))
                                         : unit(4, std::uint32_t(i));
  }
  return scene;
}

class FindHidden : public testing::TestWithParam<test::WayOfVisibility> {};
INSTANTIATE_TEST_SUITE_P(EveryWay, FindHidden, test::ways_of_visibility());

TEST_P(FindHidden, BitsAreThoseOfTheScalarSearch) {
  const auto [kind, n] = GetParam();
  Parameters parameters;
  parameters.set("visibility", std::string(kind)), parameters.set("resolution", n);
  VisibilitySource source(parameters.resolve(VisibilitySource::parameters(), "test"), "test");
  const Scene all = random_scene();
  for (std::size_t first = 0; first < all.spheres.size(); first += 3) {  // few at a time: together they hide everything
    Scene scene = all;
    scene.spheres.spheres = {all.spheres.spheres.begin() + std::ptrdiff_t(first),
                             all.spheres.spheres.begin() + std::ptrdiff_t(std::min(first + 3, all.spheres.size()))};
    source.prepare(scene);
    const std::size_t words = std::size_t(6 * n * n / 32);
    std::vector<std::uint32_t> found(words * 300);
    find_hidden(source.job(), 0, 300, found.data());
    for (int i = 0; i < 300; ++i) {
      BitCube blocked(n);
      source.find_blocked(i, blocked);
      for (int t = 0; t < 6 * n * n; ++t)
        if (dot_in_order(scene.receivers.normal[i], source.directions()[t]) <= 0.0f) blocked.set(t);
      const std::vector<std::uint32_t> own(found.begin() + i * std::ptrdiff_t(words),
                                           found.begin() + (i + 1) * std::ptrdiff_t(words));
      ASSERT_EQ(own, blocked.words) << "receiver " << i << ", spheres from " << first;
    }
  }
}

}  // namespace
}  // namespace penumbra
