// What must hold for every technique: the tests walk the registry, so a new one is tested by existing.
#include <hwy/highway.h>
#include <hwy/targets.h>
#include <malloc.h>
#include <tbb/task_arena.h>

#include <set>

#include "cuda/host/registry.h"
#include "harness/catalogue/catalogue.h"
#include "harness/measure/parity.h"
#include "scenes/error.h"
#include "scenes/scene_file.h"
#include "techniques/bases/random.h"
#include "tests/support.h"

namespace penumbra {
namespace {

/// Between the default and the end of the range that is farther from it, in the middle; of a range over decades in the
/// middle of the exponents.
double between(double fallback, double low, double high) {
  const bool decades = low > 0.0 && high / low > 100.0;
  const double to_low = decades ? fallback / low : fallback - low,
               to_high = decades ? high / fallback : high - fallback;
  const double end = to_low > to_high ? low : high;
  return decades ? std::sqrt(fallback * end) : 0.5 * (fallback + end);
}

/// The values to test of one parameter: every choice; of a number the default and one other value.
std::vector<ParameterValue> values_to_test(const Parameter& p) {
  if (!p.allowed.empty()) return p.allowed;
  if (std::holds_alternative<int>(p.fallback))
    return {p.fallback, std::clamp(17, int(p.low), int(std::min(p.high, 1e9)))};
  if (const double* fallback = std::get_if<double>(&p.fallback)) return {*fallback, between(*fallback, p.low, p.high)};
  return {p.fallback};
}

/// Both ends of the range of a real parameter.
std::vector<ParameterValue> ends_of(const Parameter& p) {
  if (!std::holds_alternative<double>(p.fallback)) return {};
  return {p.low, p.high};
}

/// Kernels may be executed on the host, which takes its time: scenes of a quarter. So does code that is sanitized.
bool executed_on_host(const Entry& entry) {
  return entry.backend == Backend::cuda;
}
int edge(const Entry& entry, int usual) {
  return std::max(4, usual / (executed_on_host(entry) || sanitized ? 2 : 1));
}

using Values = std::vector<ParameterValue> (*)(const Parameter&);

/// Is it the default of a parameter that small parameters cut by more than a factor of four? It would only take longer.
bool takes_longer(const Entry& entry, const Parameter& p, const ParameterValue& value) {
  const auto small = entry.small.all().find(p.name);
  if (small == entry.small.all().end() || value != p.fallback || !std::holds_alternative<int>(value)) return false;
  return std::get<int>(value) > 4 * std::get<int>(small->second);
}

/// The small parameters, and for every parameter each of its other values.
std::vector<Parameters> parameter_sets(const Entry& entry, Values values = values_to_test) {
  std::vector<Parameters> sets = {test::small_parameters(entry)};
  for (const Parameter& p : entry.parameters)
    for (const ParameterValue& value : values(p)) {
      if (takes_longer(entry, p, value) || value == sets[0].all().at(p.name)) continue;
      sets.push_back(sets[0]);
      sets.back().set(p.name, value);
    }
  return sets;
}

struct Case {
  Entry entry;
  Parameters parameters;
  friend void PrintTo(const Case& c, std::ostream* out) { *out << c.entry.title() << " " << c.parameters.describe(); }
};

std::vector<Case> all_cases(Values values, bool with_default) {
  std::vector<Case> cases;
  const Registry registry = cuda_on_host::make_registry();
  for (const Entry& entry : registry.entries()) {
    if (!entry.unavailable.empty()) continue;
    std::vector<Parameters> sets = parameter_sets(entry, values);
    if (sanitized) sets.resize(1);  // every entry once
    for (std::size_t k = with_default ? 0 : 1; k < sets.size(); ++k) cases.push_back({entry, sets[k]});
  }
  return cases;
}

std::string readable(const testing::TestParamInfo<Case>& info) {
  std::string name = info.param.entry.title() + "_" + info.param.parameters.describe();
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}

const Scene& scene_for(const Entry& entry, bool area) {
  static const Scene environment = load_scene("torus-knot-lamps"), lamp = load_scene("bunny-lamp-large");
  return area || !entry.lights.environment ? lamp : environment;
}

class EveryVariant : public testing::TestWithParam<Case> {
 protected:
  /// Empty if the parameters exclude each other.
  static std::unique_ptr<Technique> make() {
    try {
      return GetParam().entry.make(GetParam().parameters);
    } catch (const Error&) {
      return nullptr;
    } catch (const Unsupported&) {  // by this backend
      return nullptr;
    }
  }
};

/// A picture: normals of their own, some of which look away from all light or along an axis.
Scene with_normals(Scene scene) {
  for (int i = 0; i < scene.receivers.size(); ++i) {
    const RandomTriple r = random_triple(11, std::uint32_t(i));
    scene.receivers.normal[i] = glm::normalize(2.0f * vec3(r.x, r.y, r.z) - 1.0f);
    if (i < 6) scene.receivers.normal[i] = cube_direction(i, 0.0f, 0.0f);
  }
  return scene;
}

void expect_scalar_twin(const Case& variant, int receivers) {
  static const Registry registry = cuda_on_host::make_registry();
  for (const bool area : {false, true})
    for (const bool picture : {false, true}) {
      const Scene& scene = scene_for(variant.entry, area);
      if (!variant.entry.lights.accepts(scene.light) || (picture && area)) continue;
      const Scene small = thinned(scene, edge(variant.entry, picture ? receivers / 2 : receivers));
      EXPECT_LE(parity_with_scalar(registry, variant.entry, variant.parameters, picture ? with_normals(small) : small),
                variant.entry.parity)
          << scene.name << (picture ? " with normals" : "");
    }
}

TEST_P(EveryVariant, EqualsItsScalarTwin) {
  if (GetParam().entry.backend == Backend::scalar || !make()) GTEST_SKIP();
  expect_scalar_twin(GetParam(), 32);
}

TEST_P(EveryVariant, RaggedReceiverCountsGiveThePrefix) {
  const auto technique = make();
  if (!technique) GTEST_SKIP();
  Scene scene = thinned(scene_for(GetParam().entry, false), edge(GetParam().entry, 32));
  const Receivers all = test::receivers_at(scene.receivers.position);
  scene.receivers = all;
  const std::vector<vec3> whole = test::shade(*technique, scene);
  for (const int count : {1, 15, 17, 31, 33, 1000}) {
    if (count > all.size()) continue;
    scene.receivers = test::receivers_at({all.position.begin(), all.position.begin() + count});
    const std::vector<vec3> part = test::shade(*technique, scene);
    for (int i = 0; i < count - GetParam().entry.reach; ++i) ASSERT_EQ(part[i], whole[i]) << i << " of " << count;
  }
}

TEST_P(EveryVariant, ThreadsDoNotChangeABit) {
  const auto technique = make();
  if (!technique) GTEST_SKIP();
  const Scene scene = thinned(scene_for(GetParam().entry, false), edge(GetParam().entry, 32));
  std::vector<vec3> one, two;
  tbb::task_arena(1).execute([&] { one = test::shade(*technique, scene); });
  tbb::task_arena(2).execute([&] { two = test::shade(*technique, scene); });
  EXPECT_EQ(one, two);
  EXPECT_EQ(test::shade(*make(), scene), one) << "a second instance must agree";
}

TEST_P(EveryVariant, NoReceiversAndInvalidReceivers) {
  const auto technique = make();
  if (!technique) GTEST_SKIP();
  Scene scene = thinned(scene_for(GetParam().entry, false), edge(GetParam().entry, 4));
  const std::vector<vec3> before = test::shade(*technique, scene);
  scene.receivers.normal[5] = vec3(0.0f);
  const std::vector<vec3> after = test::shade(*technique, scene);
  EXPECT_EQ(after[5], vec3(0.0f)) << "what shows nothing is black";
  EXPECT_LT(test::difference({after[4]}, {before[4]}), 0.5);
  scene.receivers = test::receivers_at({});
  EXPECT_TRUE(test::shade(*technique, scene).empty());
}

TEST_P(EveryVariant, AlbedoScales) {
  const auto technique = make();
  if (!technique) GTEST_SKIP();
  Scene scene = thinned(scene_for(GetParam().entry, false), edge(GetParam().entry, 8));
  const std::vector<vec3> white = test::shade(*technique, scene);
  for (vec3& albedo : scene.receivers.albedo) albedo = {0.5f, 0.25f, 0.0f};
  const std::vector<vec3> tinted = test::shade(*technique, scene);
  for (std::size_t i = 0; i < white.size(); ++i) {
    EXPECT_NEAR(tinted[i].x, 0.5f * white[i].x, 1e-6f * std::abs(white[i].x));
    EXPECT_NEAR(tinted[i].y, 0.25f * white[i].y, 1e-6f * std::abs(white[i].y));
    EXPECT_EQ(tinted[i].z, 0.0f);
  }
}

TEST_P(EveryVariant, UpdateEqualsAFreshPrepare) {
  const auto technique = make();
  if (!technique) GTEST_SKIP();
  for (const Motion::Kind kind : {Motion::Kind::twist, Motion::Kind::rotate_light}) {
    Scene scene = thinned(scene_for(GetParam().entry, false), edge(GetParam().entry, 16));
    scene.motion = {kind, 1.0f, 8.0f, 8};
    technique->prepare(scene);
    Animation animation(scene);
    for (const int index : {1, 3}) technique->update(animation.frame(index));
    std::vector<vec3> updated(std::size_t(scene.receivers.size()));
    technique->shade({updated.data(), scene.receivers.width, scene.receivers.height});

    const Frame frame = animation.frame(3);
    Scene there = scene;
    there.mesh = frame.mesh, there.spheres = frame.spheres, there.light = frame.light;
    EXPECT_EQ(test::shade(*make(), there), updated);
  }
}

/// Bytes that the C library has handed out.
std::size_t bytes_in_use() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

TEST_P(EveryVariant, ReportsItsFootprint) {
  const auto technique = make();
  if (!technique) GTEST_SKIP();
  const Scene& scene = scene_for(GetParam().entry, false);
  const Scene thin = thinned(scene, 16);
  const std::size_t before = bytes_in_use();
  technique->prepare(executed_on_host(GetParam().entry) ? thin : scene);
  const std::size_t after = bytes_in_use(), some = 64 << 10;
  if (GetParam().entry.backend == Backend::cuda) EXPECT_GT(technique->footprint().total(), 0u) << "on the device";
  else if (after > before + some) EXPECT_GT(technique->footprint().total(), (after - before) / 8) << "it holds more";
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryVariant, testing::ValuesIn(all_cases(values_to_test, true)), readable);

// --- the ends of real parameters' ranges -----------------------------------------------------------------------------

// There are many, so what takes longest is not asked of them.
class EveryEnd : public EveryVariant {};

TEST_P(EveryEnd, IsFiniteForAnyThreadsAndEqualsItsScalarTwin) {
  const auto technique = make();
  if (!technique) GTEST_SKIP();
  const Scene scene = thinned(scene_for(GetParam().entry, false), edge(GetParam().entry, 16));
  std::vector<vec3> one, two;
  tbb::task_arena(1).execute([&] { one = test::shade(*technique, scene); });
  tbb::task_arena(2).execute([&] { two = test::shade(*technique, scene); });
  EXPECT_EQ(one, two);
  for (const vec3& radiance : one)
    for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(radiance[c]));
  if (GetParam().entry.backend != Backend::scalar) expect_scalar_twin(GetParam(), 16);
}

// A sanitized build walks defaults alone, which leaves none of them.
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(EveryEnd);
INSTANTIATE_TEST_SUITE_P(Registry, EveryEnd, testing::ValuesIn(all_cases(ends_of, false)), readable);

/// The walk itself.
TEST(Variants, RealParametersAreWalked) {
  const Parameter even = number_parameter("x", 1.0, 0.0, 4.0, "", ""),
                  decades = number_parameter("x", 1e-6, 1e-10, 1.0, "", "");
  EXPECT_EQ(values_to_test(even), (std::vector<ParameterValue>{1.0, 2.5}));
  EXPECT_NEAR(std::get<double>(values_to_test(decades)[1]), 1e-3, 1e-15);
  EXPECT_EQ(ends_of(decades), (std::vector<ParameterValue>{1e-10, 1.0}));
  const Registry registry = make_registry();
  std::set<double> scales;
  for (const Values values : {values_to_test, ends_of})
    for (const Parameters& parameters : parameter_sets(registry.find("pcss", "scalar"), values))
      scales.insert(parameters.number("light_scale"));
  EXPECT_EQ(scales, (std::set<double>{0.0, 1.0, 8.5, 16.0}));
}

// One run per instruction set present.
TEST(InstructionSets, AllAgree) {
  const Registry registry = cuda_on_host::make_registry();
  for (const Entry& entry : registry.entries()) {
    if (entry.backend != Backend::simd) continue;
    const Scene scene = thinned(scene_for(entry, false), 16);
    for (const Parameters& parameters : parameter_sets(entry)) {
      std::unique_ptr<Technique> technique;
      try {
        technique = entry.make(parameters);
      } catch (const Error&) {
        continue;
      }
      const std::vector<vec3> best = test::shade(*technique, scene);
      for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        EXPECT_LT(test::difference(test::shade(*technique, scene), best), 1e-6)
            << entry.title() << " " << parameters.describe() << " on " << hwy::TargetName(target);
        if (!technique->instruction_set().empty()) EXPECT_EQ(technique->instruction_set(), hwy::TargetName(target));
        hwy::SetSupportedTargetsForTest(0);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
      }
    }
  }
}

/// A lamp that lies among the receivers, on the mesh or has no area, an image of one pixel, two mirrors that see each
/// other: every image is finite and not negative, and what shows nothing is black.
TEST(Variants, LampsThatTouchAndImagesOfOnePixelAreDefined) {
  const Mesh box = make_box({-0.5f, 0.0f, -0.5f}, {0.5f, 1.0f, 0.5f});
  const auto picture = [&](int pixels, std::vector<Mirror> mirrors, const AreaLight& lamp) {
    Scene scene;
    scene.name = "hard";
    scene.mesh = box;
    add_mirrors(scene.mesh, mirrors);
    scene.receiver_spec = {Camera{{0.4f, 1.5f, 3.0f}, {0, 0.4f, 0}, 40.0f, pixels, pixels}, vec3(0.7f), mirrors};
    scene.receivers = make_receivers(scene.receiver_spec, scene.mesh);
    scene.light = lamp;
    return scene;
  };
  const auto wall = [](float z) { return Mirror{MirrorPlane{{0, 1, z}, {9, 0, 0}, {0, 9, 0}}, true}; };
  const Scene scenes[] = {picture(12, {}, make_disc({1, 0, 1}, {0, 1, 0}, 0.3f, vec3(5.0f))),
                          picture(12, {}, make_rectangle({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, vec3(5.0f))),
                          picture(12, {}, make_disc({1, 3, 1}, {0, -1, 0}, 0.0f, vec3(5.0f))),
                          picture(1, {}, make_disc({1, 3, 1}, {0, -1, 0}, 0.5f, vec3(5.0f))),
                          picture(12, {wall(-2.0f), wall(4.0f)}, make_disc({1, 3, 1}, {0, -1, 0}, 0.5f, vec3(5.0f)))};
  const Registry registry = make_registry();
  for (const Entry& entry : registry.entries()) {
    if (!entry.lights.area || entry.backend == Backend::cuda) continue;
    for (const Scene& scene : scenes) {
      const std::vector<vec3> image = test::shade(*entry.make(test::small_parameters(entry)), scene);
      for (int i = 0; i < scene.receivers.size(); ++i)
        for (int c = 0; c < 3; ++c) {
          const float value = image[std::size_t(i)][c];
          EXPECT_TRUE(std::isfinite(value) && value >= 0.0f) << entry.title() << " " << value;
          if (!scene.receivers.valid(i)) EXPECT_EQ(value, 0.0f) << entry.title();
        }
    }
  }
}

/// What a frame of a moving camera shows does not depend on the frames before it.
TEST(Variants, FramesOfACameraForgetThoseBefore) {
  const Registry registry = cuda_on_host::make_registry();
  for (const Entry& entry : registry.entries()) {
    if (!entry.unavailable.empty()) continue;
    Scene scene = scene_for(entry, false);
    const int pixels = edge(entry, 8);
    scene.receiver_spec.kind = Camera{{0.8f, 1.6f, 3.0f}, {0, 0.5f, 0}, 40.0f, pixels, pixels};
    scene.receivers = make_receivers(scene.receiver_spec, scene.mesh);
    for (const Motion::Kind kind : {Motion::Kind::orbit, Motion::Kind::dolly}) {
      scene.motion = {kind, 0.5f, 8.0f, 8};
      const auto after = [&](std::initializer_list<int> frames) {
        const auto technique = entry.make(test::small_parameters(entry));
        Animation animation(scene);
        technique->prepare(scene);
        for (const int index : frames) technique->update(animation.frame(index));
        std::vector<vec3> image(std::size_t(scene.receivers.size()));
        technique->shade({image.data(), scene.receivers.width, scene.receivers.height});
        return image;
      };
      EXPECT_EQ(after({1, 6, 3}), after({3})) << entry.title();
    }
  }
}

/// A parameter that is read in another's place changes nothing. One end of its range against the other, for receivers
/// on the ground, on the mesh and of a camera. (Other backends equal this one.)
TEST(Variants, EveryRealParameterMatters) {
  const Registry registry = make_registry();
  for (const Entry& entry : registry.entries()) {
    const std::vector<Parameters> sets = parameter_sets(entry, ends_of);
    if (entry.backend != Backend::simd || sets.size() == 1) continue;
    const Scene ground = thinned(scene_for(entry, false), 16);
    Scene mesh = ground;
    mesh.receivers = make_receivers({MeshVertices{}, vec3(1.0f)}, mesh.mesh);
    Scene view = ground;
    Camera camera;
    camera.width = camera.height = 24;
    view.receivers = make_receivers({camera, vec3(1.0f)}, view.mesh);
    for (const Parameter& p : entry.parameters) {
      if (ends_of(p).empty()) continue;
      bool matters = false;
      for (const Scene* scene : std::initializer_list<const Scene*>{&ground, &mesh, &view}) {
        if (matters) continue;
        std::vector<vec3> image[2];
        for (int k = 0; k < 2; ++k) {
          Parameters parameters = sets[0];
          parameters.set(p.name, ends_of(p)[std::size_t(k)]);
          image[k] = test::shade(*entry.make(parameters), *scene);
        }
        matters = test::difference(image[0], image[1]) > 1e-5;
      }
      EXPECT_TRUE(matters) << entry.title() << " " << p.name;
    }
  }
}

}  // namespace
}  // namespace penumbra
