#include "harness/measure/sequence.h"

#include "harness/report/tables.h"
#include "harness/results/row_json.h"

#include "tests/support.h"

namespace penumbra {
namespace {

/// Radiance 1 in even frames, 1 + step in odd ones.
class Blinking : public Technique {
 public:
  explicit Blinking(float step) : step_(step) {}
  void prepare(const Scene&, const Light&) override {}
  void update(const Frame& frame) override { value_ = 1.0f + (int(frame.time) % 2 ? step_ : 0.0f); }
  void shade(View<vec3> radiance) override {
    for (std::size_t i = 0; i < radiance.size(); ++i) radiance[i] = vec3(value_);
  }
  Footprint footprint() const override { return {}; }

 private:
  float step_, value_ = 0.0f;
};

TEST(Sequence, FlickerIsTheChangeOfError) {
  const test::TemporaryFolder folder;
  setenv("PENUMBRA_CACHE", (folder.path() + "/cache").c_str(), 1);
  Scene scene;
  scene.name = "floating";
  scene.mesh = make_box({-0.1f, 50.0f, -0.1f}, {0.1f, 50.2f, 0.1f});  // too far up to be seen in the errors
  scene.spheres.spheres = {{{0, 50.1f, 0}, 0.2f}};
  scene.receiver_spec = {PlaneGrid{1.0f, 16, 0.0f}, vec3(1.0f)};
  scene.receivers = make_receivers(scene.receiver_spec, scene.mesh);
  scene.light = test::constant_environment();
  scene.motion = {Motion::Kind::rigid, 1.0f, 4.0f, 4};
  ReferenceSettings settings;
  settings.truth_noise = 0.01;
  std::vector<double> shares;
  const Sequence sequence(scene, settings, [&](double share) { shares.push_back(share); });
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  for (const double frame : {0.0, 0.25, 0.5, 0.75}) EXPECT_GE(std::count(shares.begin(), shares.end(), frame), 1);
  EXPECT_LE(shares.back(), 1.0);

  Blinking steady(0.0f), blinking(0.25f);
  const SequenceErrors calm = sequence.score(steady, 1.0, folder.path() + "/calm.png");
  ASSERT_EQ(calm.rel_rmse.size(), 4u);
  ASSERT_EQ(calm.flicker.size(), 3u);
  EXPECT_LT(*calm.flicker[0], 0.01);
  const SequenceErrors loud = sequence.score(blinking, 1.0, folder.path() + "/loud.png");
  for (const auto& flicker : loud.flicker) EXPECT_NEAR(*flicker, 0.25, 0.01);
  EXPECT_NEAR(*loud.rel_rmse[1], 0.25, 0.01);
  EXPECT_EQ(loud.coverage, std::vector<double>(4, 1.0));
  EXPECT_GT(loud.carry_ms, 0.0);
  const Image sheet = load_image(folder.path() + "/loud.png");
  EXPECT_EQ(sheet.width, 4 * 16 + 3 * 2);
  EXPECT_EQ(sheet.height, 3 * 16 + 2 * 2);
  unsetenv("PENUMBRA_CACHE");

  Row row;
  row.id.scene = "floating", row.id.technique = "blinking", row.id.backend = "scalar", row.score.sequence = loud,
  row.timing.frame_ms = {1.0};
  EXPECT_NE(make_sequence_table({row}).find("| floating | blinking |"), std::string::npos);
  EXPECT_EQ(make_sequence_table({Row{}}), "");
  const Row back = row_from_json(to_json(row).dump());
  ASSERT_TRUE(back.score.sequence);
  EXPECT_EQ(back.score.sequence->flicker, loud.flicker);
}

TEST(Sequence, FramesInTheDarkDoNotCount) {
  Row row;
  row.id.scene = "s", row.id.technique = "t", row.id.backend = "scalar", row.timing.frame_ms = {1.0};
  row.score.sequence = SequenceErrors{{0.02, std::nullopt, 0.04}, {std::nullopt, 0.01}, {}, std::nullopt, 0.0};
  EXPECT_NE(make_sequence_table({row}).find("| 3 | 3 | 4 | 1 | undefined |"), std::string::npos)
      << make_sequence_table({row});
  const Row back = row_from_json(to_json(row).dump());
  EXPECT_EQ(back.score.sequence->rel_rmse, row.score.sequence->rel_rmse);
  EXPECT_FALSE(back.score.sequence->rel_noise);
  row.score.sequence->rel_rmse = {std::nullopt, std::nullopt};
  EXPECT_NE(make_sequence_table({row}).find("| 2 | undefined | undefined | 1 |"), std::string::npos);
}

TEST(Sequence, BlackFramesAndSheetsThatCannotBeWritten) {
  const test::TemporaryFolder folder;
  setenv("PENUMBRA_CACHE", (folder.path() + "/cache").c_str(), 1);
  Scene scene;
  scene.name = "dark";
  scene.receiver_spec = {PlaneGrid{1.0f, 8, 0.0f}, vec3(1.0f)};
  scene.receivers = make_receivers(scene.receiver_spec, scene.mesh);
  scene.light = make_disc({0, 2, 0}, {0, 1, 0}, 0.5f, vec3(1.0f));
  scene.motion = {Motion::Kind::rigid, 1.0f, 4.0f, 2};
  const Sequence sequence(scene, {}, [](double) {});
  Blinking steady(0.0f);
  const SequenceErrors errors = sequence.score(steady, 1.0, folder.write("file", "") + "/below-a-file.png");
  unsetenv("PENUMBRA_CACHE");
  ASSERT_EQ(errors.rel_rmse.size(), 2u);
  EXPECT_FALSE(errors.rel_rmse[0] || errors.rel_rmse[1] || errors.flicker[0] || errors.rel_noise);
}

}  // namespace
}  // namespace penumbra
