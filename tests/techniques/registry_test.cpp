#include "techniques/registry.h"

#include "harness/catalogue/catalogue.h"
#include "tests/support.h"

namespace penumbra {
namespace {

Entry entry_called(const std::string& name) {
  Entry e;
  e.name = name;
  e.backend = Backend::scalar;
  return e;
}

TEST(Registry, RefusesDuplicates) {
  Registry registry;
  registry.add(entry_called("a"));
  EXPECT_NE(test::error_of([&] { registry.add(entry_called("a")); }).find("twice"), std::string::npos);
  Entry twice = entry_called("b");
  twice.parameters = {integer_parameter("k", 1, 0, 2, "", ""), integer_parameter("k", 1, 0, 2, "", "")};
  EXPECT_NE(test::error_of([&] { registry.add(twice); }).find("'k' twice"), std::string::npos);
}

TEST(Registry, UnknownNamesListWhatThereIs) {
  const Registry registry = make_registry();
  EXPECT_NE(test::error_of([&] { registry.find("radiosity", "simd"); }).find("pixel-basis"), std::string::npos);
  EXPECT_NE(test::error_of([&] { registry.find("pixel-basis", "gpu"); }).find("scalar"), std::string::npos);
}

TEST(Registry, EveryEntryIsDescribed) {
  const Registry registry = make_registry();
  for (const Entry& e : registry.entries()) {
    EXPECT_FALSE(e.summary.empty() || e.citation.empty()) << e.title();
    EXPECT_TRUE(e.lights.environment || e.lights.area) << e.title();
    for (const Parameter& p : e.parameters) {
      EXPECT_FALSE(p.meaning.empty()) << e.title() << " " << p.name;
      EXPECT_EQ(test::error_of([&] { Parameters().resolve(e.parameters, e.title()); }), "")
          << "defaults must be allowed";
    }
  }
}

TEST(Parameters, AreChecked) {
  const std::vector<Parameter> declared = {integer_parameter("rays", 64, 1, 100, "rays", "how many"),
                                           number_parameter("width", 0.5, 0.0, 1.0, "m", "how wide"),
                                           choice_parameter("mode", {"fast", "slow"}, "how")};
  const auto resolve = [&](const std::vector<std::string>& given) {
    return parse_parameters(given).resolve(declared, "test");
  };
  EXPECT_EQ(resolve({}).integer("rays"), 64);
  EXPECT_EQ(resolve({"width=1"}).number("width"), 1.0);
  EXPECT_EQ(resolve({"width=0"}).number("width"), 0.0);
  for (const int rays : {1, 100}) EXPECT_EQ(resolve({"rays=" + std::to_string(rays)}).integer("rays"), rays);
  EXPECT_EQ(resolve({"mode=slow"}).text("mode"), "slow");
  const auto message = [&](const std::string& given) { return test::error_of([&] { resolve({given}); }); };
  EXPECT_NE(message("rays=0").find("[1, 100]"), std::string::npos);
  EXPECT_NE(message("rays=101").find("[1, 100]"), std::string::npos);
  EXPECT_NE(message("width=1.001").find("[0, 1]"), std::string::npos);
  EXPECT_NE(message("width=-0.001").find("[0, 1]"), std::string::npos);
  EXPECT_NE(message("rays=1.5").find("rays"), std::string::npos);
  EXPECT_NE(message("rays=many").find("rays"), std::string::npos);
  EXPECT_NE(message("width=nan").find("width"), std::string::npos);
  EXPECT_NE(message("mode=medium").find("fast, slow"), std::string::npos);
  EXPECT_NE(message("speed=1").find("rays, width, mode"), std::string::npos);
  EXPECT_NE(message("speed").find("name=value"), std::string::npos);
}

}  // namespace
}  // namespace penumbra
