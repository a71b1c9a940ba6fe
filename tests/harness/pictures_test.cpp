#include "harness/results/pictures.h"

#include "tests/support.h"

namespace penumbra {
namespace {

using test::grey;

void expect_near(vec3 found, vec3 expected) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 1e-5f);
}

// A quarter of white is full colour.
TEST(Pictures, TooBrightIsRedTooDarkIsBlue) {
  const Image error =
      signed_error(grey({0.5f, 0.45f, 0.55f, 0.9f, 0.1f}, 5), grey(std::vector<float>(5, 0.5f), 5), 1.0);
  expect_near(error.pixels[0], vec3(1.0f));
  expect_near(error.pixels[1], {0.8f, 0.8f, 1.0f});
  expect_near(error.pixels[2], {1.0f, 0.8f, 0.8f});
  expect_near(error.pixels[3], {1.0f, 0.0f, 0.0f});
  expect_near(error.pixels[4], {0.0f, 0.0f, 1.0f});
  expect_near(signed_error(grey({0.55f}, 1), grey({0.5f}, 1), 2.0).pixels[0], {1.0f, 0.6f, 0.6f});
}

TEST(Pictures, ExposureIsAFactor) {
  expect_near(exposed(grey({0.5f}, 1), 3.0).pixels[0], vec3(1.5f));
}

// Two rows of two panels of 2 x 1, two white pixels between them.
TEST(Pictures, SheetsHoldTheirPanelsInOrder) {
  const Image a = grey({0.1f, 0.2f}, 2), b = grey({0.3f, 0.4f}, 2), c = grey({0.5f, 0.6f}, 2),
              d = grey({0.7f, 0.8f}, 2);
  const Image sheet = contact_sheet({{a, b}, {c, d}});
  ASSERT_EQ(sheet.width, 6);
  ASSERT_EQ(sheet.height, 4);
  std::vector<float> values;
  for (const vec3& p : sheet.pixels) values.push_back(p.x);
  EXPECT_EQ(values, (std::vector<float>{0.1f, 0.2f, 1, 1, 0.3f, 0.4f,  //
                                        1,    1,    1, 1, 1,    1,     //
                                        1,    1,    1, 1, 1,    1,     //
                                        0.5f, 0.6f, 1, 1, 0.7f, 0.8f}));
  EXPECT_TRUE(contact_sheet({}).pixels.empty());
}

TEST(Pictures, WhatWasWrittenIsReadBack) {
  const test::TemporaryFolder folder;
  Image image = grey({0.0f, 0.25f, 0.5f, 1.0f}, 2);
  image.pixels[1] = {0.1f, 0.2f, 0.3f};
  save_png(folder.path() + "/a.png", image);
  const Image back = load_picture(folder.path() + "/a.png");
  ASSERT_EQ(back.width, 2);
  for (std::size_t i = 0; i < 4; ++i)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(back.pixels[i][c], image.pixels[i][c], 0.005f);
  EXPECT_NE(test::error_of([] { load_picture("/no/such.png"); }), "");
}

TEST(Pictures, PanelsAreAveragedOrRepeated) {
  const Image small = panel(grey({0.1f, 0.2f}, 2), 5);
  ASSERT_EQ(small.width, 4);
  ASSERT_EQ(small.height, 2);
  EXPECT_EQ(small.pixels[1].x, 0.1f);
  EXPECT_EQ(small.pixels[6].x, 0.2f);
  const Image large = panel(grey({1, 2, 3, 4, 5, 6, 7, 8, 9}, 3), 2);
  ASSERT_EQ(large.width, 2);
  ASSERT_EQ(large.height, 2);
  EXPECT_EQ(large.pixels[0].x, 3.0f) << "of 1, 2, 4, 5";
  EXPECT_EQ(large.pixels[1].x, 4.5f) << "of 3, 6: the rest is outside";
  EXPECT_EQ(large.pixels[3].x, 9.0f);
  EXPECT_EQ(panel(grey(std::vector<float>(600, 0.0f), 2), 100).height, 100) << "tall ones, too";
}

TEST(Pictures, WidePanelsAreThinned) {
  Image wide{256, 2, {}};
  for (int i = 0; i < 512; ++i) wide.pixels.emplace_back(float(i));
  const Image sheet = contact_sheet({{wide}});
  ASSERT_EQ(sheet.width, 128);
  ASSERT_EQ(sheet.height, 1);
  EXPECT_EQ(sheet.pixels[3].x, 6.0f);
}

}  // namespace
}  // namespace penumbra
