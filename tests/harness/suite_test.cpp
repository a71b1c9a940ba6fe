#include "harness/measure/suite.h"

#include "harness/catalogue/catalogue.h"
#include "scenes/assets.h"
#include "tests/support.h"

namespace penumbra {
namespace {

class Suites : public testing::Test {
 protected:
  Suite load(const std::string& text, int threads = 0) const {
    return load_suite(folder_.write("s.toml", text), registry_, threads);
  }
  std::string error(const std::string& text) const {
    return test::error_of([&] { load(text); });
  }
  Registry registry_ = make_registry();
  test::TemporaryFolder folder_;
};

TEST_F(Suites, EveryShippedSuiteLoads) {
  for (const std::string& name : shipped_names("suites")) {
    const Suite suite = load_suite(name, registry_, 0);
    EXPECT_EQ(suite.name, name);
    EXPECT_GE(suite.repetitions, 9);
  }
}

TEST_F(Suites, AxesMultiply) {
  const Suite suite = load(
      "name = \"s\"\nscenes = [\"a\"]\nspheres = [8, 16]\nthreads = [1, 2]\n"
      "[[technique]]\nname = \"ray-traced\"\nbackend = [\"scalar\", \"simd\"]\nparameters = { rays = [1, 2, 4], seed = "
      "[1, 2] }\n");
  EXPECT_EQ(suite.spheres.size(), 2u);
  const Suite fits = load(
      "name = \"s\"\nscenes = [\"a\"]\nspheres = [8, 16]\nobjective = [\"cover\", \"shadow\", \"grid\"]\n"
      "sequence = true\n[[technique]]\nname = \"ray-traced\"\n");
  EXPECT_EQ(fits.spheres.size(), 6u);
  EXPECT_EQ(fits.spheres[1].count, 8);
  EXPECT_EQ(fits.spheres[1].objective, Objective::shadow);
  EXPECT_TRUE(fits.sequence);
  EXPECT_EQ(suite.variants.size(), 6u + 12u) << "scalar runs on one thread only";
  EXPECT_EQ(load("name = \"s\"\nscenes = \"a\"\n[[technique]]\nname = \"ray-traced\"\n", 3).variants.back().threads, 3);
}

TEST_F(Suites, BackendsDefaultToThoseThatThereAre) {
  for (const auto& [name, backend] : {std::pair("both", Backend::simd),
                                      {"both", Backend::scalar},
                                      {"both", Backend::cuda},
                                      {"plain", Backend::scalar},
                                      {"plain", Backend::cuda},
                                      {"fast", Backend::simd},
                                      {"device", Backend::cuda}}) {
    Entry entry;
    entry.name = name, entry.backend = backend;
    registry_.add(entry);
  }
  const auto backends = [&](const std::string& name) {
    std::vector<Backend> all;
    for (const Variant& v : load("scenes = [\"a\"]\n[[technique]]\nname = \"" + name + "\"\n").variants)
      all.push_back(v.entry->backend);
    return all;
  };
  using Backends = std::vector<Backend>;
  EXPECT_EQ(backends("both"), (Backends{Backend::scalar, Backend::simd}));
  EXPECT_EQ(backends("plain"), Backends{Backend::scalar});
  EXPECT_EQ(backends("fast"), Backends{Backend::simd});
  EXPECT_EQ(backends("device"), Backends{Backend::cuda});
  const auto baseline = [&](const std::string& name) {
    return load("scenes = [\"a\"]\nbaseline = { name = \"" + name + "\" }\n[[technique]]\nname = \"both\"\n")
        .baseline->entry->backend;
  };
  EXPECT_EQ(baseline("both"), Backend::simd);
  EXPECT_EQ(baseline("plain"), Backend::scalar);
  EXPECT_EQ(load("scenes = \"a\"\n[[technique]]\nname = \"both\"\n").name, "s") << "named after its file";
}

TEST_F(Suites, BaselineAndPublishedTimes) {
  const std::string head = "name = \"s\"\nscenes = [\"a\"]\n", tail = "[[technique]]\nname = \"ray-traced\"\n";
  const std::string line = "[[published_time]]\ntable = \"1\"\nsubject = \"b\"\nvariant = \"c\"\nrow = \"d\"\n";
  const Suite suite =
      load(head + "published = \"zhu-2019-tables\"\nbaseline = { name = \"pcss\", parameters = { map = 64 } }\n" +
           tail + line + "stages = [\"x\", \"y\"]\n");
  ASSERT_TRUE(suite.baseline);
  EXPECT_EQ(suite.baseline->entry->backend, Backend::simd);
  EXPECT_EQ(suite.baseline->parameters.integer("map"), 64);
  ASSERT_EQ(suite.published_times.size(), 1u);
  EXPECT_EQ(suite.published_times[0].stages, (std::vector<std::string>{"x", "y"}));
  EXPECT_NE(error(head + tail + line).find("'published'"), std::string::npos);
  EXPECT_NE(error(head + "baseline = { name = \"pcss\", parameters = { map = [1, 2] } }\n" + tail).find("one value"),
            std::string::npos);
  EXPECT_NE(error(head + "baseline = { name = \"magic\" }\n" + tail).find("pcss"), std::string::npos);
}

TEST_F(Suites, LabelsNameWhatDiffersFromTheDefaults) {
  const Suite suite = load(
      "name = \"s\"\nscenes = [\"a\"]\n[[technique]]\nname = \"ray-traced\"\nbackend = \"scalar\"\n"
      "parameters = { rays = [64, 5] }\n");
  EXPECT_EQ(suite.variants[0].label(), "ray-traced/scalar/threads:1");
  EXPECT_EQ(suite.variants[1].label(), "ray-traced/scalar/rays:5/threads:1");
}

TEST_F(Suites, MistakesAreExplained) {
  const std::string head = "name = \"s\"\nscenes = [\"a\"]\n";
  EXPECT_NE(error(head).find("[[technique]]"), std::string::npos);
  EXPECT_NE(error("name = \"s\"\n").find("'scenes'"), std::string::npos);
  EXPECT_NE(error(head + "[[technique]]\nname = \"magic\"\n").find("pixel-basis"), std::string::npos);
  EXPECT_NE(error(head + "[[technique]]\nname = \"ray-traced\"\nbackend = \"gpu\"\n").find("scalar"),
            std::string::npos);
  EXPECT_NE(error(head + "[[technique]]\nname = \"ray-traced\"\nparameters = { rays = 0 }\n").find("s.toml:5"),
            std::string::npos);
  EXPECT_NE(error(head + "[[technique]]\nname = \"ray-traced\"\nparameters = { beams = 2 }\n").find("rays, seed"),
            std::string::npos);
  EXPECT_NE(error(head + "colour = 1\n[[technique]]\nname = \"ray-traced\"\n").find("'colour'"), std::string::npos);
  EXPECT_NE(error(head + "objective = \"nice\"\n[[technique]]\nname = \"ray-traced\"\n").find("k-means"),
            std::string::npos);
  EXPECT_NE(error(head + "repetitions = 0\n[[technique]]\nname = \"ray-traced\"\n").find("[1, 1000]"),
            std::string::npos);
  EXPECT_NE(test::error_of([&] { load_suite("none-such", registry_, 0); }).find("quick"), std::string::npos);
}

}  // namespace
}  // namespace penumbra
