#include "harness/results/metrics.h"

#include <nlohmann/json.hpp>

#include <numeric>

#include "harness/results/filter.h"
#include "tests/support.h"

namespace penumbra {
namespace {

using test::grey;

// By hand: differences 0.1, -0.3, 0, 0 in every channel against the reference 1, 1, 2, 0.
TEST(Metrics, HandComputed) {
  const Image reference = grey({1, 1, 2, 0}, 4), image = grey({1.1f, 0.7f, 2, 0}, 4);
  const std::vector<Region> regions = {Region::lit, Region::penumbra, Region::lit, Region::umbra};
  const ErrorReport report = compare_images(image, reference, regions, std::vector<bool>(4, true), 1.0);
  EXPECT_NEAR(report.all.rmse, std::sqrt((0.01 + 0.09) / 4), 1e-7);
  EXPECT_NEAR(*report.all.rel_rmse, std::sqrt(0.1 / 4) / std::sqrt(6.0 / 4), 1e-7);
  EXPECT_NEAR(report.all.max, 0.3, 1e-7);
  EXPECT_NEAR(report.all.mean_signed, -0.05, 1e-7);
  EXPECT_NEAR(*report.all.psnr, 20 * std::log10(2 / std::sqrt(0.025)), 1e-5);
  EXPECT_EQ(report.all.receivers, 4u);
  EXPECT_FALSE(report.all.ssim) << "too small for a window";
  EXPECT_FALSE(report.all.flip);
  EXPECT_EQ(report.region[0].receivers, 1u);
  EXPECT_NEAR(report.region[0].rmse, 0.0, 1e-9);
  EXPECT_NEAR(report.region[1].rmse, 0.3, 1e-7);
  EXPECT_NEAR(report.region[1].mean_signed, -0.3, 1e-7);
  EXPECT_NEAR(report.region[2].rmse, std::sqrt(0.01 / 2), 1e-7);
  EXPECT_NEAR(*report.region[2].rel_rmse, std::sqrt(0.005) / std::sqrt(1.5), 1e-7) << "over the whole image's RMS";
}

TEST(Metrics, ChannelsCountEach) {
  Image reference = grey({1, 1}, 2), image = reference;
  image.pixels[0].y = 1.6f;
  const Errors e = compare_images(image, reference, std::vector<Region>(2, Region::lit), {true, true}, 1.0).all;
  EXPECT_NEAR(e.rmse, std::sqrt(0.36 / 6), 1e-6);
  EXPECT_NEAR(e.mean_signed, 0.1, 1e-6);
}

TEST(Metrics, NegativeValuesAreCountedNotClamped) {
  const Errors e = compare_images(grey({-1, 0, -2}, 3), grey({0, 0, 0}, 3), std::vector<Region>(3, Region::lit),
                                  {true, true, true}, 1)
                       .all;
  EXPECT_EQ(e.negative, 6u);
  EXPECT_NEAR(e.mean_signed, -1.0, 1e-7);
}

TEST(Metrics, InvalidReceiversDoNotCount) {
  const Image reference = grey({1, 5}, 2), image = grey({1, 0}, 2);
  const Errors e = compare_images(image, reference, std::vector<Region>(2, Region::lit), {true, false}, 1.0).all;
  EXPECT_EQ(e.receivers, 1u);
  EXPECT_EQ(e.rmse, 0.0);
  EXPECT_TRUE(std::isinf(*e.psnr));
}

TEST(Metrics, ABlackReferenceHasNoRelativeErrors) {
  const Image black = grey(std::vector<float>(144, 0.0f), 12), dim = grey(std::vector<float>(144, 0.25f), 12);
  const std::vector<bool> valid(144, true);
  const std::vector<Region> umbra(144, Region::umbra);
  const Errors wrong = compare_images(dim, black, umbra, valid, 1.0).all;
  EXPECT_NEAR(wrong.rmse, 0.25, 1e-7) << "the error itself is there";
  EXPECT_FALSE(wrong.rel_rmse);
  EXPECT_FALSE(wrong.psnr) << "no peak, no decibels";
  const ErrorReport right = compare_images(black, black, umbra, valid, 1.0);
  EXPECT_FALSE(right.all.rel_rmse) << "0 / 0 is not 0 %";
  EXPECT_FALSE(right.all.psnr);
  EXPECT_EQ(*right.all.ssim, 1.0);
  EXPECT_EQ(*right.all.flip, 0.0);
  EXPECT_FALSE(right.region[0].rel_rmse);
  const Image crumbs = grey(std::vector<float>(144, 1e-18f), 12);
  EXPECT_FALSE(compare_images(dim, crumbs, umbra, valid, 1.0, 1e-12).all.rel_rmse);
  EXPECT_NEAR(*compare_images(dim, crumbs, umbra, valid, 1.0, 1e-20).all.rel_rmse, 2.5e17, 1e12);
}

TEST(Metrics, WithoutReceiversNothingIsScored) {
  const Image image = grey({1, 2}, 2);
  const ErrorReport report = compare_images(image, image, {Region::lit, Region::lit}, {false, false}, 1.0);
  EXPECT_EQ(report.all.receivers, 0u);
  EXPECT_FALSE(report.all.rel_rmse || report.all.psnr || report.region[2].rel_rmse);
  EXPECT_FALSE(mean(image, {false, false}));
  EXPECT_EQ(*mean(image, {false, true}), dvec3(2.0));
}

TEST(Metrics, RegionsGoByTheShareThatArrives) {
  const std::vector<vec3> open(5, vec3(2.0f));
  const auto regions =
      classify({vec3(0.02f), vec3(1), vec3(1.99f), vec3(0), vec3(1)}, open, {true, true, true, true, false});
  EXPECT_EQ(regions, (std::vector<Region>{Region::umbra, Region::penumbra, Region::lit, Region::umbra, Region::none}));
  EXPECT_EQ(classify({vec3(0)}, {vec3(0)}, {true})[0], Region::none) << "no light, no shadow";
}

TEST(Metrics, UmbraEndsAtTwoPercentAndLitBeginsAtNinetyEight) {
  const auto region = [](float share) { return classify({vec3(4 * share)}, {vec3(4.0f)}, {true})[0]; };
  EXPECT_EQ(region(0.0199f), Region::umbra);
  EXPECT_EQ(region(0.0201f), Region::penumbra);
  EXPECT_EQ(region(0.9799f), Region::penumbra);
  EXPECT_EQ(region(0.9801f), Region::lit);
  EXPECT_EQ(classify({vec3(0.02f)}, {vec3(1.0f)}, {true})[0], Region::penumbra) << "under, not at";
  EXPECT_EQ(classify({vec3(0.98f)}, {vec3(1.0f)}, {true})[0], Region::penumbra);
  // Blue is the least of luminance: 0.98 of red and green, nothing of blue, is a penumbra of 0.9.
  EXPECT_EQ(classify({vec3(0.99f, 0.99f, 0)}, {vec3(1.0f)}, {true})[0], Region::penumbra);
  EXPECT_EQ(classify({vec3(0, 0, 0.25f)}, {vec3(1.0f)}, {true})[0], Region::umbra) << "a quarter of blue is 1.8 %";
}

TEST(Metrics, ExposureBringsTheBrightestToEightTenths) {
  std::vector<float> values(1000, 0.5f);
  values[3] = 1e6f;  // one firefly does not decide
  EXPECT_NEAR(exposure_for(grey(values, 100), std::vector<bool>(1000, true)), 1.6, 1e-5);
  EXPECT_EQ(exposure_for(grey({0, 0}, 2), {true, true}), 1.0);
  EXPECT_NEAR(exposure_for(grey({0, 0}, 2), {true, true}, 4.0), 0.2, 1e-12) << "black: the light decides";
  EXPECT_NEAR(exposure_for(grey({0, 1e-18f}, 2), {true, true}, 4.0), 0.2, 1e-12);
  std::vector<float> ramp(101);
  std::iota(ramp.begin(), ramp.end(), 1.0f);
  EXPECT_NEAR(exposure_for(grey(ramp, 101), std::vector<bool>(101, true)), 0.008, 1e-9) << "99 % of 0 to 100 is 99";
  std::vector<float> one(1000, 0.0f);
  one[7] = 1.6f;
  EXPECT_NEAR(exposure_for(grey(one, 100), std::vector<bool>(1000, true), 4.0), 0.5, 1e-6);
}

// By hand: two constant images have no variance, so SSIM = (2ab + C1) / (a^2 + b^2 + C1).
TEST(Metrics, SsimOfConstants) {
  const auto map = ssim_map(std::vector<float>(144, 0.5f), std::vector<float>(144, 0.25f), 12, 12);
  const double expected = (2 * 0.5 * 0.25 + 1e-4) / (0.25 + 0.0625 + 1e-4);
  int windows = 0;
  for (const float v : map) {
    if (std::isnan(v)) continue;
    EXPECT_NEAR(v, expected, 1e-5);
    ++windows;
  }
  EXPECT_EQ(windows, 4);
}

TEST(Metrics, SsimAndFlipOfEqualImages) {
  std::vector<float> values;
  for (int i = 0; i < 400; ++i) values.push_back(float(i % 17) / 17);
  for (const float v : ssim_map(values, values, 20, 20))
    if (!std::isnan(v)) EXPECT_NEAR(v, 1.0f, 1e-6f);
  for (const float v : flip_map(grey(values, 20), grey(values, 20), 1.0)) EXPECT_EQ(v, 0.0f);
}

// By hand: black against white differs by L* 100, chroma 0; the largest difference is that of green and blue.
TEST(Metrics, FlipOfBlackAgainstWhite) {
  const Image black = grey(std::vector<float>(900, 0.0f), 30), white = grey(std::vector<float>(900, 1e6f), 30);
  const float flip = flip_map(black, white, 1.0)[15 * 30 + 15];
  EXPECT_GT(flip, 0.95f);
  EXPECT_LE(flip, 1.0f);
}

TEST(Metrics, GaussianSumsToOneAndFilterKeepsConstants) {
  const Kernel kernel = gaussian_kernel(1.5, 5);
  EXPECT_NEAR(std::accumulate(kernel.begin(), kernel.end(), 0.0), 1.0, 1e-12);
  for (const float v : filter(std::vector<float>(35, 3.0f), 7, 5, kernel, kernel)) EXPECT_NEAR(v, 3.0f, 1e-6f);
  std::vector<float> dot(49, 0.0f);
  dot[24] = 1.0f;
  const auto spread = filter(dot, 7, 7, {0.25, 0.5, 0.25}, {0.25, 0.5, 0.25});
  EXPECT_FLOAT_EQ(spread[24], 0.25f);
  EXPECT_FLOAT_EQ(spread[23], 0.125f);
  EXPECT_FLOAT_EQ(spread[16], 0.0625f);
}

// tests/data/expected.json comes from scikit-image and flip-evaluator (scripts/check_metrics.py).
TEST(Metrics, AgreeWithIndependentImplementations) {
  const std::string data = PENUMBRA_TEST_DATA;
  const auto expected = nlohmann::json::parse(std::ifstream(data + "/expected.json"));
  const Image clean = load_image(data + "/clean.exr"), noisy = load_image(data + "/noisy.exr");
  const std::vector<bool> all(clean.pixels.size(), true);
  const ErrorReport report =
      compare_images(noisy, clean, std::vector<Region>(all.size(), Region::lit), all, expected["exposure"]);
  EXPECT_NEAR(*report.all.ssim, expected["ssim"], 2e-6);
  EXPECT_NEAR(*report.all.flip, expected["flip"], 2e-6);
}

}  // namespace
}  // namespace penumbra
