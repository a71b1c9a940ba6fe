// The techniques' kernels, executed on the host (or on a device, where there is one).
#include <gmock/gmock.h>

#include "cuda/availability.h"
#include "cuda/haar.h"
#include "cuda/host/registry.h"
#include "harness/catalogue/catalogue.h"
#include "harness/measure/parity.h"
#include "scenes/scene_file.h"
#include "techniques/visibility_filter/adaptive.h"
#include "tests/support.h"
#include "tests/techniques/ways_of_visibility.h"

namespace penumbra::cuda_on_host {
namespace {

// --- equal to the bit where nothing is summed in another order -------------------------------------------------------

template <From from>
__global__ void blocked_words(VisibilitySpans v, ReceiverSpans receivers, Span<std::uint32_t> out) {
  PENUMBRA_SHARED(std::uint32_t, words, most_words);
  PENUMBRA_SHARED(int, entry, receiver_threads);
  PENUMBRA_SHARED(Cap, cap, receiver_threads);
  PENUMBRA_SHARED(std::uint64_t, touched, receiver_threads);
  const std::size_t i = blockIdx.x;
  find_blocked<from>(v, {entry, cap, touched}, receivers.position[i], active_lines(v, receivers.normal[i]),
                     receivers.on_occluder[i] != 0, words);
  __syncthreads();
  for (unsigned w = threadIdx.x; w < v.words(); w += receiver_threads) out[i * v.words() + w] = words[w];
}

__global__ void two_levels(int n, Span<const std::uint32_t> words, Span<float> level1, Span<float> means,
                           Span<std::uint16_t> blocks, BinaryTableSpan table) {
  const TwoLevelVisibility<Span<float>, Span<std::uint16_t>> v{n, level1, means, blocks, table};
  find_blocks(words, v);
  transform_means(v);
}

class EveryVisibility : public testing::TestWithParam<test::WayOfVisibility> {};
INSTANTIATE_TEST_SUITE_P(Kernels, EveryVisibility, test::ways_of_visibility());

TEST_P(EveryVisibility, BlockedTexelsAndTheirTransformEqualTheScalarOnes) {
  const auto [kind, n] = GetParam();
  Parameters parameters;
  parameters.set("visibility", std::string(kind));
  parameters.set("resolution", n);
  VisibilitySource source(parameters.resolve(VisibilitySource::parameters(), "test"), "test");
  Scene scene = thinned(load_scene("torus-knot-lamps"), 5);
  scene.receivers.on_occluder[3] = 1;
  scene.receivers.position[4] = scene.spheres.spheres[0].centre;  // inside a sphere
  scene.spheres.spheres[1].radius = 0.0f;
  for (int i = 0; i < scene.receivers.size(); i += 2)
    scene.receivers.normal[i] = glm::normalize(vec3(0.3f * float(i % 5) - 0.5f, 1.0f - 0.2f * float(i), 0.7f));
  source.prepare(scene);

  const Stream stream;
  DeviceVisibility device(source);
  device.upload(stream, source, {true, true, true, true});
  DeviceReceivers receivers;
  receivers.upload(stream, scene.receivers);
  const std::size_t words = device.spans().words(), count = std::size_t(scene.receivers.size());
  Buffer<std::uint32_t> out;
  out.resize(count * words);
  if (device.from() == From::table)
    launch(stream, PENUMBRA_KERNEL(blocked_words<From::table>), unsigned(count), receiver_threads, device.spans(),
           receivers.spans(), out.span());
  else
    launch(stream, PENUMBRA_KERNEL(blocked_words<From::raster>), unsigned(count), receiver_threads, device.spans(),
           receivers.spans(), out.span());
  std::vector<std::uint32_t> found(count * words);
  out.download(stream, found.data());

  Buffer<std::int8_t> table;
  table.upload(stream, std::span(&haar::binary_table()[0][0], std::size_t(16) * 65536));
  Buffer<float> level1, means;
  Buffer<std::uint16_t> blocks;
  wavelet::Visibility expected;
  for (int i = 0; i < int(count); ++i) {
    BitCube blocked(n);
    source.find_blocked(i, blocked);
    const std::uint64_t active = lines_above_horizon(source.cones(), scene.receivers.normal[i]);
    for (std::size_t w = 0; w < words; ++w)
      if (!(active >> (w / words_per_line) & 1u)) blocked.words[w] = 0;
    const std::vector<std::uint32_t> own(found.begin() + i * std::ptrdiff_t(words),
                                         found.begin() + (i + 1) * std::ptrdiff_t(words));
    ASSERT_EQ(own, blocked.words) << "receiver " << i;

    expected.assign(blocked);
    level1.resize(expected.store.level1.size()), blocks.resize(level1.size()), means.resize(expected.means.size());
    launch(stream, PENUMBRA_KERNEL(two_levels), 1, 64, n,
           Span<const std::uint32_t>{out.span().data + i * int(words), words}, level1.span(), means.span(),
           blocks.span(), BinaryTableSpan{table.span()});
    std::vector<float> own_level1(level1.size()), own_means(means.size());
    std::vector<std::uint16_t> own_blocks(blocks.size());
    level1.download(stream, own_level1.data()), means.download(stream, own_means.data());
    blocks.download(stream, own_blocks.data());
    EXPECT_EQ(own_level1, expected.store.level1);
    EXPECT_EQ(own_means, expected.means);
    EXPECT_EQ(own_blocks, expected.store.blocks);
  }
}

// --- every technique -------------------------------------------------------------------------------------------------

/// Do the kernels run on a device here?
bool on_device() {
  return penumbra::make_registry().states().at(Backend::cuda).available();
}

std::vector<std::string> techniques() {
  std::vector<std::string> names;
  const Registry registry = cuda_on_host::make_registry();
  for (const Entry& entry : registry.entries())
    if (entry.backend == Backend::cuda) names.push_back(entry.name);
  return names;
}

class EveryKernel : public testing::TestWithParam<std::string> {
 protected:
  /// Small tables, so that the host's time goes into the kernels.
  std::unique_ptr<Technique> make(const std::string& backend = "cuda") const {
    const Entry& entry = registry().find(GetParam(), backend);
    Parameters parameters = test::small_parameters(entry);
    if (entry.backend == Backend::cuda)
      for (const Parameter& p : entry.kernels->parameters) parameters.set(p.name, p.allowed.back());
    return make_technique(entry, parameters);
  }
  static const Registry& registry() {
    static const Registry all = cuda_on_host::make_registry();
    return all;
  }
  Scene scene() const {
    return load_scene(registry().find(GetParam(), "cuda").lights.environment ? "torus-knot-lamps" : "bunny-lamp-large");
  }
};
INSTANTIATE_TEST_SUITE_P(Kernels, EveryKernel, testing::ValuesIn(techniques()), [](const auto& technique) {
  std::string name = technique.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST_P(EveryKernel, TheOrderOfThreadsAndBlocksDoesNotChangeABit) {
  const Scene small = thinned(scene(), 9);
  const std::vector<vec3> forward = test::shade(*make(), small);
  for (const Order order : {Order::reversed, Order::shuffled}) {
    set_order(order);
    EXPECT_EQ(test::shade(*make(), small), forward);
  }
  set_order(Order::forward);
}

TEST_P(EveryKernel, TakesAnyNumberOfReceivers) {
  Scene some = thinned(scene(), 32);
  const Receivers all = test::receivers_at(some.receivers.position);
  const auto technique = make();
  for (const int count : {0, 1, 31, 33, 1000}) {
    some.receivers = test::receivers_at({all.position.begin(), all.position.begin() + count});
    const std::vector<vec3> image = test::shade(*technique, some), expected = test::shade(*make("scalar"), some);
    ASSERT_EQ(image.size(), std::size_t(count));
    if (count > 0) EXPECT_LE(test::difference(image, expected), registry().find(GetParam(), "cuda").parity);
  }
}

TEST_P(EveryKernel, TakesAMillionReceivers) {
  if (GetParam() == "wavelet-product" || GetParam() == "wavelet-dense") GTEST_SKIP() << "shares wavelet's kernels";
  Scene many = thinned(scene(), 16);
  const Receivers few = many.receivers;
  constexpr int count = 1 << 20;
  many.receivers = test::receivers_at(std::vector<vec3>(count, few.position[0]));
  many.receivers.width = 1024, many.receivers.height = 1024;
  // Only so many show anything that the host is done within seconds.
  for (int i = 0; i < count; ++i)
    if (i % 4099 != 0) many.receivers.normal[i] = vec3(0.0f);
  many.receivers.position[4099 * 255] = few.position[77];
  const std::vector<vec3> image = test::shade(*make(), many), expected = test::shade(*make("scalar"), many);
  EXPECT_LE(test::difference(image, expected), registry().find(GetParam(), "cuda").parity);
  EXPECT_EQ(image[1], vec3(0.0f));
}

TEST_P(EveryKernel, TakesAnyNumberOfSpheres) {
  if (!registry().find(GetParam(), "cuda").lights.environment) GTEST_SKIP() << "sees the mesh";
  Scene some = thinned(scene(), 3);
  SphereSet many;
  for (int k = 0; k < 4096; ++k)
    many.spheres.push_back(
        {vec3(0.05f * float(k % 64) - 1.6f, 0.6f + 0.01f * float(k % 7), 0.05f * float(k / 64) - 1.6f),
         0.02f + 0.001f * float(k % 5)});
  some.spheres = many;
  EXPECT_LE(test::difference(test::shade(*make(), some), test::shade(*make("scalar"), some)),
            registry().find(GetParam(), "cuda").parity);
  some.spheres = {};
  std::vector<vec3> expected;
  try {
    expected = test::shade(*make("scalar"), some);
  } catch (const Unsupported&) {
    EXPECT_THROW(test::shade(*make(), some), Unsupported);
    return;
  }
  EXPECT_LE(test::difference(test::shade(*make(), some), expected), registry().find(GetParam(), "cuda").parity);
}

TEST_P(EveryKernel, SaysThatMemoryRanOutAndRecovers) {
  if (on_device()) GTEST_SKIP() << "a device has its own limit";
  const Scene small = thinned(scene(), 4);
  const auto technique = make();
  set_memory_limit(1000);
  EXPECT_THROW(test::shade(*technique, small), DeviceError);
  set_memory_limit(~std::size_t(0));
  EXPECT_EQ(test::shade(*make(), small), test::shade(*technique, small));
}

TEST_P(EveryKernel, SeveralFramesReplayTheSameImage) {
  const Scene small = thinned(scene(), 6);
  const auto technique = make();
  const std::vector<vec3> first = test::shade(*technique, small);
  std::vector<vec3> again(first.size());
  Animation animation(small);
  for (int frame = 0; frame < 2; ++frame) {
    technique->update({0.0, small.mesh, small.spheres, small.light, small.receivers, {}});
    technique->shade({again.data(), small.receivers.width, small.receivers.height});
    EXPECT_EQ(again, first);
  }
  for (const char* stage : {"upload", "kernels", "download"})
    EXPECT_THAT(technique->stages(), testing::Contains(testing::Field(&Stage::name, stage)));
}

// Shadow maps: regions, links, quadtrees and blur do the very same operations.
TEST(Kernels, MultiScaleShadowsEqualTheScalarOnesToTheBit) {
  const Registry registry = cuda_on_host::make_registry();
  const Scene small = thinned(load_scene("bunny-lamp-large"), 48);
  Parameters parameters;
  parameters.set("map", 128);
  parameters.set("search", std::string("sampled"));
  parameters.set("filter", std::string("nearest"));
  const auto shaded = [&](const char* backend) {
    const Entry& entry = registry.find("fast-pcss", backend);
    return test::shade(*make_technique(entry, parameters), small);
  };
  if (on_device()) EXPECT_LT(test::difference(shaded("cuda"), shaded("scalar")), 1e-5) << "its own exp and atan2";
  else EXPECT_EQ(shaded("cuda"), shaded("scalar"));
}

TEST(Kernels, WalksOverTheMapEqualTheScalarOnesToTheBit) {
  const Registry registry = cuda_on_host::make_registry();
  Scene disc = thinned(load_scene("soft-random"), 40);
  const AreaLight lamp = *area_light_of(disc.light);
  disc.light = make_disc(lamp.centre, lamp.normal, 0.4f, lamp.radiance);
  for (const Scene& scene :
       {thinned(load_scene("bunny-lamp-large"), 40), thinned(load_scene("soft-random"), 40), disc}) {
    const auto shaded = [&](const char* backend) {
      const Entry& entry = registry.find("shadow-map-traced", backend);
      return test::shade(*make_technique(entry, test::small_parameters(entry)), scene);
    };
    if (on_device()) EXPECT_LT(test::difference(shaded("cuda"), shaded("scalar")), 1e-3) << "its own sine and cosine";
    else EXPECT_EQ(shaded("cuda"), shaded("scalar")) << scene.name;
  }
}

/// The scalar filter over what packets of rays find, as on the device.
class RingsOverPackets final : public visibility_filter::Adaptive {
 public:
  using Adaptive::Adaptive;

 protected:
  void trace() override { visibility_filter::trace_packets(rays_, *receivers_, lamp_.centre, pixels_); }
};

TEST(Kernels, FiltersEqualTheScalarOnesToTheBit) {
  const Registry registry = cuda_on_host::make_registry();
  const Entry& entry = registry.find("visibility-filter", "cuda");
  for (const char* name : {"bunny-lamp-large", "soft-random"})
    for (const int width : {20, 63}) {
      const Scene scene = thinned(load_scene(name), 70);
      Parameters parameters = test::small_parameters(entry);
      parameters.set("width", width);
      RingsOverPackets rings(parameters);
      const std::vector<vec3> found = test::shade(*make_technique(entry, parameters), scene),
                              expected = test::shade(rings, scene);
      if (on_device()) EXPECT_LT(test::difference(found, expected), 1e-3) << "its own arc tangent";
      else EXPECT_EQ(found, expected) << name << " " << width;
      EXPECT_GT(rings.counters().at("filtered"), 100u);
    }
}

// --- can it run here -------------------------------------------------------------------------------------------------

TEST(Availability, SaysWhatIsWrongInAFewWords) {
  CudaProbe good{13000, 13000, "", 1, "Some Device", 90, 75};
  EXPECT_EQ(why_unavailable(good), "");
  CudaProbe p = good;
  p.driver = 0, p.devices = 0, p.error = "no driver";
  EXPECT_EQ(why_unavailable(p), "no CUDA device (no driver is installed)");
  p = good, p.driver = 12080, p.devices = 0, p.error = "insufficient driver";
  EXPECT_EQ(why_unavailable(p), "the driver is too old: it knows CUDA 12.8, this build needs 13.0");
  p = good, p.devices = 0, p.error = "no CUDA-capable device is detected";
  EXPECT_EQ(why_unavailable(p), "no CUDA device (no CUDA-capable device is detected)");
  p = good, p.devices = 0;
  EXPECT_EQ(why_unavailable(p), "no CUDA device");
  p = good, p.capability = 61;
  EXPECT_EQ(why_unavailable(p), "the device is too old: Some Device has compute capability 6.1, this build needs 7.5");
  p = good, p.error = "out of memory";
  EXPECT_EQ(why_unavailable(p), "CUDA failed: out of memory");
}

TEST(Availability, EveryTechniqueWithKernelsIsListedWhetherItCanRunOrNot) {
  const Registry registry = penumbra::make_registry();
  for (const std::string& name : techniques()) {
    const Entry& cuda = registry.find(name, "cuda");
    EXPECT_EQ(cuda.unavailable.empty(), on_device()) << name;
    for (const Parameter& p : registry.find(name, "scalar").parameters)
      EXPECT_THAT(cuda.parameters, testing::Contains(testing::Field(&Parameter::name, p.name)));
  }
}

}  // namespace
}  // namespace penumbra::cuda_on_host
