// Every entry says whether it looks at spheres: what does not is measured once for all sets of them.
#include "harness/catalogue/catalogue.h"
#include "scenes/error.h"
#include "scenes/scene_file.h"
#include "techniques/registry.h"
#include "tests/support.h"

namespace penumbra {
namespace {

Scene scene_with(const std::string& spheres, bool environment) {
  const test::TemporaryFolder folder;
  const std::string light = environment ? "environment = \"sun-sky\""
                                        : "area = { centre = [0, 3, 0], edge_u = [1, 0, 0], edge_v = [0, 0, 1] }";
  return load_scene(folder.write(
      "scene.toml", "name = \"s\"\n[occluder]\nmesh = \"box\"\nspheres = " + spheres +
                        "\n[receivers]\nplane = { half_extent = 1.5, resolution = 8, y = -1.0 }\n[light]\n" + light +
                        "\n"));
}

/// The defaults, and every value of a choice with which the entry says that it does not look: a wrong "no" would cost
/// rows, a wrong "yes" only time.
std::vector<Parameters> choices(const Entry& entry) {
  std::vector<Parameters> all = {Parameters().resolve(entry.parameters, entry.title())};
  for (const Parameter& p : entry.parameters)
    for (const ParameterValue& value : p.allowed) {
      if (value == p.fallback) continue;
      Parameters given;
      given.set(p.name, value);
      given = given.resolve(entry.parameters, entry.title());
      if (!entry.reads_spheres(given)) all.push_back(given);
    }
  return all;
}

TEST(ReadsSpheres, EveryEntrySaysWhatItsImageDependsOn) {
  const Registry registry = make_registry();
  for (const bool environment : {true, false}) {
    const Scene here = scene_with("[[0, 0, 0, 0.8]]", environment),
                there = scene_with("[[0.5, 0, 0, 0.5]]", environment);
    for (const Entry& entry : registry.entries()) {
      if (entry.backend != Backend::scalar || !entry.lights.accepts(here.light)) continue;
      for (const Parameters& parameters : choices(entry)) {
        std::vector<vec3> a, b;
        try {
          a = test::shade(*entry.make(parameters), here), b = test::shade(*entry.make(parameters), there);
        } catch (const Error&) {  // choices that exclude each other
          continue;
        }
        EXPECT_EQ(a != b, entry.reads_spheres(parameters)) << entry.title() << " " << parameters.describe();
      }
    }
  }
}

TEST(ReadsSpheres, BackendsAgree) {
  const Registry registry = make_registry();
  for (const Entry& entry : registry.entries())
    for (const Parameters& parameters : choices(entry))
      EXPECT_EQ(entry.reads_spheres(parameters), registry.find(entry.name, "scalar").reads_spheres(parameters))
          << entry.title();
}

}  // namespace
}  // namespace penumbra
