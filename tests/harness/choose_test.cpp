// `penumbra choose` as a whole, on small scenes.
#include "harness/choose/choose.h"

#include <fmt/format.h>

#include <set>

#include "harness/catalogue/catalogue.h"
#include "harness/choose/finals.h"
#include "harness/choose/new_scene.h"
#include "harness/commands/answer_screen.h"
#include "harness/report/screen.h"
#include "scenes/scene_file.h"
#include "tests/harness/screens.h"
#include "tests/support.h"

namespace penumbra {
namespace {

class Choices : public testing::Test {
 protected:
  Choices() {
    static const test::TemporaryFolder cache;  // one for all tests: fits take seconds
    setenv("PENUMBRA_CACHE", cache.path().c_str(), 1);
    const Registry all = make_registry();
    for (const Entry& entry : all.entries())
      for (const char* name : {"ray-traced", "pixel-basis", "sh-lighting", "pcss", "moment-shadows"})
        if (entry.name == name && entry.backend != Backend::cuda) registry_.add(entry);
  }
  ~Choices() override { unsetenv("PENUMBRA_CACHE"); }

  std::string scene(const std::string& light, const std::string& more = "") const {
    return folder_.write(
        "scene.toml", "name = \"tiny\"\n[occluder]\nmesh = \"box\"\nfit = { height = 0.5, on_ground = true }\n" + more +
                          "[receivers]\nplane = { half_extent = 1.5, resolution = 24 }\n[light]\n" + light + "\n");
  }
  Answer choose_on(const std::string& file, const Bound& bound, bool moving = false) {
    ChooseSettings settings;
    settings.scene = file, settings.bound = bound, settings.moving = moving;
    settings.threads = 1, settings.repetitions = 3;
    ResultsFolder folder(folder_.path() + "/out");
    folder.begin({}, {});
    Progress progress;
    Answer answer = choose(settings, registry_, folder, progress);
    rows_ = folder.rows();
    return answer;
  }

  Registry registry_;
  test::TemporaryFolder folder_;
  std::vector<Row> rows_;
};

constexpr const char* sky = "environment = \"sun-sky\"";
constexpr const char* lamp =
    "area = { centre = [1, 2, 1], edge_u = [0.5, 0, 0], edge_v = [0, 0, 0.5], radiance = [1, 1, 1] }";

/// What is said to be within the bound is, no technique stands twice, the best comes first, and the least number of
/// rays is chosen: one step fewer is beyond the bound.
TEST_F(Choices, TheAnswerHoldsWhatItSays) {
  const Bound bound{Bound::Kind::error, 0.05};
  const Answer a = choose_on(scene(sky), bound);
  ASSERT_NE(a.best(), nullptr);
  std::set<std::string> techniques;
  double before = 0.0;
  for (const Option& o : a.options) {
    EXPECT_TRUE(techniques.insert(o.row.id.technique).second) << o.label;
    EXPECT_EQ(o.within, *o.row.score.truth_error() <= 0.05) << o.label;
    EXPECT_EQ(o.row.timing.frame_ms.size(), 3u);
    if (!o.within) continue;
    EXPECT_GE(o.row.timing.median_frame_ms(), before);
    before = o.row.timing.median_frame_ms();
  }
  EXPECT_TRUE(techniques.contains("ray-traced") && techniques.contains("pixel-basis") &&
              techniques.contains("sh-lighting"));
  EXPECT_FALSE(techniques.contains("pcss"));
  ASSERT_EQ(a.impossible.size(), 1u);
  EXPECT_EQ(a.impossible[0].reason, "cannot shade an environment");
  int least = 1 << 30, most_beyond = 0;
  for (const Row& row : rows_)
    if (row.id.technique == "ray-traced") {
      const int rays = std::get<int>(row.id.parameters.at("rays"));
      if (*row.score.truth_error() <= 0.05) least = std::min(least, rays);
      else most_beyond = std::max(most_beyond, rays);
    }
  EXPECT_LT(most_beyond, least);
  EXPECT_LE(least, std::max(most_beyond + 1, int(1.09 * most_beyond)));
}

TEST_F(Choices, ALampAsksTheShadowMaps) {
  const Answer a = choose_on(scene(lamp), {Bound::Kind::error, 0.1});
  ASSERT_NE(a.best(), nullptr);
  std::set<std::string> techniques;
  for (const Option& o : a.options) techniques.insert(o.row.id.technique);
  EXPECT_TRUE(techniques.contains("pcss") && techniques.contains("moment-shadows"));
  EXPECT_FALSE(techniques.contains("sh-lighting"));
  EXPECT_EQ(a.impossible.at(0).reason, "cannot shade an area light");
}

TEST_F(Choices, UnderABudgetTheBestErrorWins) {
  const Bound bound{Bound::Kind::time, 5.0};
  const Answer a = choose_on(scene(lamp), bound);
  ASSERT_NE(a.best(), nullptr);
  for (const Option& o : a.options) {
    EXPECT_EQ(o.within, o.row.timing.median_frame_ms() <= 5.0) << o.label;
    if (o.within) EXPECT_GE(*o.row.score.truth_error(), *a.best()->row.score.truth_error()) << o.label;
  }
}

TEST_F(Choices, WhatNothingReachesIsSaid) {
  const Answer a = choose_on(scene(lamp), {Bound::Kind::time, 1e-3});
  EXPECT_EQ(a.best(), nullptr);
  ASSERT_FALSE(a.options.empty());
  EXPECT_NE(screen_of(a, 100).find("Nothing is within 0.001 ms here. Nearest: "), std::string::npos)
      << screen_of(a, 100);
  const nlohmann::json json = to_json(a);
  EXPECT_FALSE(json.at("within").get<bool>());
  EXPECT_TRUE(json.at("answer").is_null());
  EXPECT_EQ(json.at("nearest").at("label"), a.options[0].label);
}

/// At rest a table of transfer is free; when the mesh moves it is made anew every frame.
TEST_F(Choices, MovingCountsTheUpdate) {
  const auto sh = [](const Answer& a) {
    for (const Option& o : a.options)
      if (o.row.id.technique == "sh-lighting") return o;
    return Option{};
  };
  const Bound bound{Bound::Kind::error, 0.5};
  const Answer rest = choose_on(scene(sky), bound), moving = choose_on(scene(sky), bound, true);
  EXPECT_FALSE(rest.moving);
  EXPECT_TRUE(moving.moving);
  EXPECT_GT(sh(rest).moving_ms, 20.0 * sh(rest).row.timing.median_frame_ms());
  EXPECT_EQ(sh(moving).moving_ms, -1.0);
  EXPECT_GT(sh(moving).row.timing.median_frame_ms(), 20.0 * sh(rest).row.timing.median_frame_ms());
  if (rest.best()->row.id.technique == "sh-lighting")
    EXPECT_NE(screen_of(rest, 100).find("Holds while the mesh rests"), std::string::npos) << screen_of(rest, 100);
}

TEST_F(Choices, PartsAddUpToTheError) {
  const Answer a = choose_on(scene(sky), {Bound::Kind::error, 0.05});
  for (const Option& o : a.options) {
    double squares = 0.0;
    for (const ErrorPart& part : o.parts) squares += part.rel_rmse * part.rel_rmse;
    const double whole = *o.row.score.truth_error();
    // They are of fewer receivers, and they correlate: the order of magnitude is what a reader needs.
    EXPECT_GT(std::sqrt(squares), 0.4 * whole) << o.label;
    EXPECT_LT(std::sqrt(squares), 3.0 * whole) << o.label;
  }
}

TEST_F(Choices, AnOpenMeshLeavesOutWhatNeedsSpheres) {
  const std::string file = folder_.write("bowl.toml",
                                         "name = \"bowl\"\n[occluder]\nmesh = \"bowl\"\n[receivers]\nplane = { "
                                         "half_extent = 1.5, resolution = 16, y = -0.9 }\n"
                                         "[light]\nenvironment = \"constant\"\n");
  const Answer a = choose_on(file, {Bound::Kind::error, 0.1});
  ASSERT_NE(a.best(), nullptr);
  bool said = false;
  for (const Impossible& i : a.impossible)
    said = said || (i.reason.find("no spheres can be fitted") != std::string::npos &&
                    std::find(i.techniques.begin(), i.techniques.end(), "pixel-basis") != i.techniques.end());
  EXPECT_TRUE(said);
}

TEST_F(Choices, SpheresThatAreGivenAreNotReplaced) {
  const Answer a = choose_on(scene(sky, "spheres = [[0, 0.25, 0, 0.4]]\n"), {Bound::Kind::error, 0.9});
  for (const Row& row : rows_) EXPECT_EQ(row.id.spheres, 1u);
  EXPECT_TRUE(a.left_out.empty());
}

TEST_F(Choices, ABlackTruthIsAnError) {
  const std::string away = "area = { centre = [0, 3, 0], normal = [0, 1, 0], radius = 0.5, radiance = [1, 1, 1] }";
  const std::string why = test::error_of([&] { choose_on(scene(away), {Bound::Kind::error, 0.1}); });
  EXPECT_NE(why.find("the truth is black"), std::string::npos) << why;
}

TEST_F(Choices, ScreensFitWhateverTheNames) {
  Answer a = choose_on(scene(sky), {Bound::Kind::error, 0.05});
  a.scene_spheres = 0;
  for (const int width : {80, 100}) {
    EXPECT_EQ(test::lines_too_long(screen_of(a, width), width), "");
    EXPECT_LE(test::count_lines(screen_of(a, width)), 25);
  }
  for (Option& o : a.options) o.label.append(80, 'x'), o.label += "äöü";
  a.left_out = {fmt::format("{:y>60} {:z>60}", "", "")};
  while (a.options.size() < 30) a.options.push_back(a.options.back());
  const std::string screen = screen_of(a, 100);
  EXPECT_EQ(test::lines_too_long(screen.substr(screen.find("technique ")), 100), "");
}

class NewScenes : public Choices {
 protected:
  Scene made(const SceneRequest& request) { return load_scene(write_scene(request, folder_.path())); }
};

TEST_F(NewScenes, StandOnTheGroundInProportion) {
  SceneRequest request;
  request.mesh = "torus-knot", request.light = "constant", request.resolution = 16;
  SphereChoice unfitted;
  unfitted.fitted = false;
  const Scene scene = load_scene(write_scene(request, folder_.path()), unfitted);
  const Bounds box = bounds(scene.mesh);
  EXPECT_NEAR(box.low.y, 0.0f, 1e-5);
  EXPECT_NEAR(box.centre().x, 0.0f, 1e-5);
  const vec3 size = box.extent();
  const auto& plane = std::get<PlaneGrid>(scene.receiver_spec.kind);
  EXPECT_NEAR(plane.half_extent, 0.5f * std::max(size.x, size.z) + 0.8f * size.y, 1e-2f);
  EXPECT_EQ(scene.receivers.size(), 256);
  request.height = 3.0;
  EXPECT_NEAR(bounds(load_scene(write_scene(request, folder_.path()), unfitted).mesh).extent().y, 3.0f, 1e-4);
}

TEST_F(NewScenes, LampsShineAtTheMiddleOfTheMesh) {
  for (const char* text : {"0.5x0.25@0,3,0", "0.5x0.25@2,3,1", "0.5@-1,2,0.5"}) {
    SceneRequest request;
    request.mesh = "box", request.lamp = text, request.resolution = 8;
    SphereChoice unfitted;
    unfitted.fitted = false;
    const Scene scene = load_scene(write_scene(request, folder_.path()), unfitted);
    const AreaLight& light = *area_light_of(scene.light);
    const vec3 middle(0.0f, 0.5f * bounds(scene.mesh).extent().y, 0.0f);
    EXPECT_GT(glm::dot(light.normal, glm::normalize(middle - light.centre)), 0.9999f) << text;
    if (light.shape == AreaLight::Shape::rectangle) {
      EXPECT_NEAR(glm::length(light.edge_u), 0.5f, 1e-5);
      EXPECT_NEAR(glm::length(light.edge_v), 0.25f, 1e-5);
    } else {
      EXPECT_NEAR(light.area(), pi * 0.25, 1e-5);
    }
  }
}

TEST_F(NewScenes, MistakesAreSaid) {
  const auto fault = [&](SceneRequest request) {
    return test::error_of([&] { write_scene(request, folder_.path()); });
  };
  SceneRequest request;
  request.mesh = folder_.write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  EXPECT_NE(fault(request).find("none of its 1 triangles has an area"), std::string::npos) << fault(request);
  request.mesh = "no-such-mesh.obj";
  EXPECT_NE(fault(request).find("no-such-mesh.obj: no such file"), std::string::npos) << fault(request);
  request.mesh = "box", request.light = "no-such.hdr";
  EXPECT_NE(fault(request).find("--light no-such.hdr"), std::string::npos) << fault(request);
  request.lamp = "1x1@0,3,0";
  EXPECT_NE(fault(request).find("one light is allowed"), std::string::npos) << fault(request);
}

}  // namespace
}  // namespace penumbra
