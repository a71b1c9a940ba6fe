#include "scenes/image.h"

#include <OpenImageIO/deepdata.h>
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>

#include "scenes/colour.h"
#include "tests/support.h"

namespace penumbra {
namespace {

using test::messages_of;
using ::testing::HasSubstr;
using ::testing::Not;

void expect_near(vec3 a, vec3 b, float tolerance = 1e-4f) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "channel " << c;
}

class ImageFiles : public ::testing::Test {
 protected:
  std::string at(const std::string& name) const { return folder_.path() + "/" + name; }

  static OIIO::ImageSpec spec(int width, int height, std::vector<std::string> channels,
                              OIIO::TypeDesc type = OIIO::TypeDesc::FLOAT) {
    OIIO::ImageSpec spec(width, height, int(channels.size()), type);
    spec.channelnames = channels;
    spec.alpha_channel = spec.channelindex("A");
    return spec;
  }

  /// Every pixel has the same values.
  std::string save(const std::string& name, const OIIO::ImageSpec& spec, const std::vector<float>& pixel) const {
    return save_parts(name, {spec}, {pixel});
  }
  std::string save_parts(const std::string& name, const std::vector<OIIO::ImageSpec>& specs,
                         const std::vector<std::vector<float>>& pixels) const {
    const auto output = OIIO::ImageOutput::create(name);
    for (std::size_t part = 0; part < specs.size(); ++part) {
      std::vector<float> values;
      for (int i = 0; i < specs[part].width * specs[part].height; ++i)
        values.insert(values.end(), pixels[part].begin(), pixels[part].end());
      const bool open = part == 0 ? output->open(at(name), int(specs.size()), specs.data())
                                  : output->open(at(name), specs[part], OIIO::ImageOutput::AppendSubimage);
      EXPECT_TRUE(open && output->write_image(OIIO::TypeDesc::FLOAT, values.data())) << output->geterror();
    }
    output->close();
    return at(name);
  }
  std::string save_exr(const std::string& name, std::vector<std::string> channels, const std::vector<float>& p) const {
    return save(name, spec(4, 2, std::move(channels)), p);
  }

  /// A Radiance picture of 10 x 4 equal pixels (r, g, b) / 128, without run lengths.
  std::string radiance(const std::string& name, const std::string& header, uvec3 p = {128, 32, 64}) const {
    std::string bytes = header + "-Y 4 +X 10\n";
    for (int i = 0; i < 40; ++i)
      for (const unsigned v : {p.x, p.y, p.z, 129u}) bytes += char(v);
    return folder_.write(name, bytes);
  }
  vec3 radiance_pixel(const std::string& header, uvec3 p = {128, 32, 64}) const {
    return load_image(radiance("p.hdr", header, p)).pixels[7];
  }

  test::TemporaryFolder folder_;
};

const std::string plain = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";

// The resolution line gives two axes, slow one first, and the way in which each is walked; y is up.
TEST_F(ImageFiles, RadianceLiesAsItsResolutionLineSays) {
  constexpr int width = 10, height = 4;
  for (const bool rows : {true, false})
    for (const char sx : {'+', '-'})
      for (const char sy : {'+', '-'}) {
        const std::string x = fmt::format("{}X 10", sx), y = fmt::format("{}Y 4", sy);
        std::string bytes = plain + (rows ? y + " " + x : x + " " + y) + "\n";
        const auto put = [&](int i, int j) {  // i-th along x's way, j-th along y's
          const int column = sx == '+' ? i : width - 1 - i, row = sy == '-' ? j : height - 1 - j;
          bytes += {char(128), char(column * 10), char(row * 20), char(129)};
        };
        for (int slow = 0; slow < (rows ? height : width); ++slow)
          for (int fast = 0; fast < (rows ? width : height); ++fast) rows ? put(fast, slow) : put(slow, fast);
        const Image image = load_image(folder_.write("turned.hdr", bytes));
        ASSERT_EQ(image.width, width);
        ASSERT_EQ(image.height, height);
        for (int row = 0; row < height; ++row)
          for (int column = 0; column < width; ++column)
            ASSERT_EQ(image.pixels[row * width + column], vec3(128, column * 10, row * 20) / 128.0f) << x << y << rows;
      }
}

TEST_F(ImageFiles, RadianceExposureIsUndoneAndSaid) {
  expect_near(radiance_pixel(plain), {1, 0.25f, 0.5f});
  expect_near(radiance_pixel("#?RADIANCE\nEXPOSURE=4.0\nFORMAT=32-bit_rle_rgbe\n\n"), vec3(1, 0.25f, 0.5f) / 4.0f);
  expect_near(radiance_pixel("#?RADIANCE\nEXPOSURE= 4 \nEXPOSURE=0.5\nEXPOSURE=1e1\n\n"), vec3(1, 0.25f, 0.5f) / 20.0f);
  expect_near(radiance_pixel("#?RADIANCE\nCOLORCORR= 2 0.5 1\nCOLORCORR=1 1 4\nEXPOSURE=2\n\n"),
              {0.25f, 0.25f, 0.0625f});
  // Moved in: of a picture that this one was made from.
  expect_near(radiance_pixel("#?RADIANCE\n\tEXPOSURE=9\n\n"), {1, 0.25f, 0.5f});
  const std::string said =
      messages_of([&] { load_image(radiance("e.hdr", "#?RADIANCE\nEXPOSURE=4\nEXPOSURE=2\n\n")); });
  for (const char* part : {"e.hdr", "EXPOSURE", "divided by 8"}) EXPECT_THAT(said, HasSubstr(part));
  EXPECT_EQ(messages_of([&] { load_image(radiance("p.hdr", plain)); }), "");
  for (const char* bad :
       {"EXPOSURE=0", "EXPOSURE=-1", "EXPOSURE=bright", "EXPOSURE=nan", "COLORCORR=1 2", "PRIMARIES=1"})
    EXPECT_THAT(test::error_of([&] { radiance_pixel("#?RADIANCE\n" + std::string(bad) + "\n\n"); }),
                HasSubstr(std::string(bad).substr(0, std::string(bad).find('='))));
}

TEST_F(ImageFiles, RadianceHeadersComeInManyForms) {
  const std::string format = "FORMAT=32-bit_rle_rgbe\n";
  for (const std::string& header :
       {"#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n" + std::string(), "#?RADIANCE\nSOFTWARE=x\n\n" + std::string(),
        "#?RGBE\n" + format + "GAMMA=1.0\n\n", format + "\n",
        "#?RADIANCE\n# a comment\nVIEW= -vtv\nPIXASPECT=0.9\nFORMAT = 32-bit_rle_rgbe \n\n" + std::string(),
        "#?RADIANCE\n" + format + "PRIMARIES= .64 .33 .29 .6 .15 .06 .333 .333\n\n"})
    expect_near(radiance_pixel(header), {1, 0.25f, 0.5f});
  expect_near(radiance_pixel("#?RGBE\nGAMMA=2\n\n"), {1, 0.0625f, 0.25f});
  const auto error = [&](const std::string& bytes) {
    return test::error_of([&] { load_image(folder_.write("bad.hdr", bytes)); });
  };
  EXPECT_THAT(error("#?RADIANCE\nFORMAT=ascii\n\n-Y 1 +X 1\nabcd"), HasSubstr("FORMAT is 'ascii'"));
  EXPECT_THAT(error("#?RADIANCE\nno end"), HasSubstr("does not end"));
  for (const char* line : {"-Y 4 +Y 10", "4 10", "-Y 4", "-Y 99999999999 +X 1", "-Y -4 +X 2"})
    EXPECT_THAT(error(plain + line + "\nabcd"), HasSubstr(line));
  EXPECT_THAT(error(plain + "-Y 0 +X 4\n"), HasSubstr("empty"));
  EXPECT_THAT(error(plain + "-Y 100000 +X 200000\nabcd"), HasSubstr("20000"));
  EXPECT_THAT(error(plain + "-Y 10000 +X 20000\nabcd"), HasSubstr("claims"));
  // Radiance 1's run lengths: (1 1 1 n) repeats the pixel before.
  EXPECT_THAT(error(plain + "-Y 1 +X 10\n" + std::string("\x80\x80\x80\x81\x01\x01\x01\x09", 8)), HasSubstr("ra_rgbe"));
}

TEST_F(ImageFiles, RadianceColoursBecomeRec709) {
  const std::string xyze = "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n";
  expect_near(radiance_pixel(xyze, {122, 128, 139}), vec3(1), 0.015f);  // D65
  EXPECT_THAT(messages_of([&] { load_image(radiance("x.hdr", xyze)); }), HasSubstr("XYZ"));
  // Red and green change places; white is the same, so that nothing else happens.
  const std::string swapped = "#?RADIANCE\nPRIMARIES=.30 .60 .64 .33 .15 .06 .3127 .3290\n\n";
  expect_near(radiance_pixel(swapped), {0.25f, 1, 0.5f});
  EXPECT_THAT(messages_of([&] { load_image(radiance("x.hdr", swapped)); }), HasSubstr("primaries"));
  EXPECT_THAT(test::error_of([&] { radiance_pixel("#?RADIANCE\nPRIMARIES=0 0 0 0 0 0 0 0\n\n"); }),
              HasSubstr("span no colours"));
}

TEST(Colour, PrimariesConvertAsPublished) {
  // ACES 2065-1 to sRGB with Bradford adaptation, as colour configurations of OpenColorIO print it.
  const Chromaticities ap0{{0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.0770}, {0.32168, 0.33767}};
  const glm::dmat3 m = convert_primaries(ap0, rec709);
  const double published[3][3] = {{2.52168619, -1.13413099, -0.38755520},
                                  {-0.27647991, 1.37271909, -0.09623917},
                                  {-0.01537806, -0.15297534, 1.16835340}};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) EXPECT_NEAR(m[column][row], published[row][column], 1e-6);
  // Rec. 709 as ICC profiles write it, under D50.
  const Chromaticities d50{{0.6484, 0.3309}, {0.3212, 0.5979}, {0.1559, 0.0660}, {0.3457, 0.3585}};
  EXPECT_TRUE(same_colours(d50, rec709));
  EXPECT_FALSE(same_colours(radiance_primaries, rec709));
  EXPECT_NEAR(luminance_weights(rec709).y, 0.7152, 1e-4);  // green's share of luminance
  for (const float v : {0.0f, 0.02f, 0.216f, 1.0f}) EXPECT_NEAR(srgb_encode(srgb_decode(v)), v, 1e-6);
}

TEST_F(ImageFiles, LuminanceAndChroma) {
  const vec3 rgb(0.8f, 0.4f, 0.2f);
  const auto chroma = [&](const Chromaticities& primaries) {
    const glm::dmat3 m = xyz_from_rgb(primaries);
    const auto y = float(rgb.x * m[0].y + rgb.y * m[1].y + rgb.z * m[2].y);
    return std::vector<float>{y, (rgb.z - y) / y, (rgb.x - y) / y};
  };
  const std::vector<std::string> channels = {"Y", "BY", "RY"};
  expect_near(load_image(save_exr("yc.exr", channels, chroma(rec709))).pixels[3], rgb);
  expect_near(load_image(save_exr("l.exr", {"Z", "l.Y", "l.BY", "l.RY"},
                                  [&] {
                                    auto p = chroma(rec709);
                                    p.insert(p.begin(), 9.0f);
                                    return p;
                                  }()))
                  .pixels[3],
              rgb);
  OIIO::ImageSpec own = spec(4, 2, channels);
  const float xy[8] = {0.30f, 0.60f, 0.64f, 0.33f, 0.15f, 0.06f, 0.3127f, 0.3290f};  // red is green, green red
  own.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), xy);
  const Chromaticities swapped{{0.30, 0.60}, {0.64, 0.33}, {0.15, 0.06}, {0.3127, 0.3290}};
  expect_near(load_image(save("own.exr", own, chroma(swapped))).pixels[3], {rgb.y, rgb.x, rgb.z});
  expect_near(load_image(save_exr("y.exr", {"Y"}, {0.5f})).pixels[3], vec3(0.5f));

  std::string bytes = test::read_text(at("yc.exr"));  // as if every second sample of chroma were left out
  const std::size_t sampling = bytes.find(std::string("BY\0", 3)) + 3 + 8;
  bytes[sampling] = bytes[sampling + 4] = 2;
  EXPECT_THAT(test::error_of([&] { load_image(folder_.write("half.exr", bytes)); }), HasSubstr("luminance and chroma"));
}

TEST_F(ImageFiles, ChannelsAreFoundByName) {
  const vec3 rgb(0.8f, 0.4f, 0.2f);
  expect_near(load_image(save_exr("a.exr", {"depth.Z", "light.R", "light.G", "light.B"}, {9, .8f, .4f, .2f})).pixels[0],
              rgb);
  expect_near(
      load_image(save_exr("b.exr", {"N.X", "N.Y", "N.Z", "B", "G", "R", "Z"}, {7, 7, 7, .2f, .4f, .8f, 9})).pixels[0],
      rgb);
  expect_near(load_image(save_exr("c.exr", {"g", "b", "r"}, {.4f, .2f, .8f})).pixels[0], rgb);
  expect_near(
      load_image(save_exr("d.exr", {"R", "G", "B", "key.R", "key.G", "key.B"}, {.8f, .4f, .2f, 7, 7, 7})).pixels[0],
      rgb);
  expect_near(load_image(save_exr("e.exr", {"mask.Y", "x.y.R", "x.y.G", "x.y.B"}, {7, .8f, .4f, .2f})).pixels[0], rgb);
  for (const auto& channels : {std::vector<std::string>{"Z"}, {"N.X", "N.Y", "N.Z"}, {"R", "G"}})
    EXPECT_THAT(test::error_of([&] { load_image(save_exr("n.exr", channels, std::vector<float>(channels.size()))); }),
                HasSubstr("no channels R, G, B or Y"));
  const auto whole = spec(4, 2, {"R", "G", "B"}, OIIO::TypeDesc::UINT);
  EXPECT_THAT(test::error_of([&] { load_image(save("u.exr", whole, {1, 1, 1})); }), HasSubstr("uint"));
  OIIO::ImageSpec mixed = spec(4, 2, {"R", "G", "B", "id"});
  mixed.channelformats = {OIIO::TypeDesc::HALF, OIIO::TypeDesc::HALF, OIIO::TypeDesc::HALF, OIIO::TypeDesc::UINT};
  expect_near(load_image(save("m.exr", mixed, {.8f, .4f, .2f, 1})).pixels[0], rgb, 1e-3f);
}

TEST_F(ImageFiles, LayersAreChosen) {
  const std::string file =
      save_exr("l.exr", {"albedo.R", "albedo.G", "albedo.B", "light.R", "light.G", "light.B", "ao.Y"},
               {7, 7, 7, .8f, .4f, .2f, 0.5f});
  const std::string several = test::error_of([&] { load_image(file); });
  for (const char* part : {"l.exr", "albedo, light", "layer ="}) EXPECT_THAT(several, HasSubstr(part));
  expect_near(load_image(file, "light").pixels[0], {.8f, .4f, .2f});
  expect_near(load_image(file, "ao").pixels[0], vec3(0.5f));
  EXPECT_THAT(test::error_of([&] { load_image(file, "Light"); }), HasSubstr("there are albedo, ao, light"));
  EXPECT_THAT(test::error_of([&] {
                load_image(save_exr("p.exr", {"R", "G", "B"}, {1, 1, 1}), "light");
              }),
              HasSubstr("belong to no layer"));
  EXPECT_THAT(test::error_of([&] { load_image(radiance("p.hdr", plain), "light"); }), HasSubstr("only OpenEXR"));
}

TEST_F(ImageFiles, PartsAreChosen) {
  const auto part = [](const char* name, std::vector<std::string> channels) {
    OIIO::ImageSpec s = spec(4, 2, std::move(channels));
    s.attribute("oiio:subimagename", name);
    return s;
  };
  const std::vector<std::string> rgb = {"R", "G", "B"}, key = {"key.R", "key.G", "key.B"};
  const std::string one = save_parts("1.exr", {part("depth", {"Z"}), part("beauty", rgb)}, {{9}, {1, 2, 3}});
  expect_near(load_image(one).pixels[0], {1, 2, 3});
  const std::string two = save_parts("2.exr", {part("left", rgb), part("right", rgb)}, {{1, 2, 3}, {4, 5, 6}});
  EXPECT_THAT(test::error_of([&] { load_image(two); }), HasSubstr("left, right"));
  expect_near(load_image(two, "right").pixels[0], {4, 5, 6});
  const std::string both = save_parts("3.exr", {part("left", key), part("right", key)}, {{1, 2, 3}, {4, 5, 6}});
  EXPECT_THAT(test::error_of([&] { load_image(both, "key"); }), HasSubstr("left.key, right.key"));
  expect_near(load_image(both, "left.key").pixels[0], {1, 2, 3});
  expect_near(load_image(both, "right").pixels[0], {4, 5, 6});
}

TEST_F(ImageFiles, DeepImagesAreRefused) {
  OIIO::ImageSpec deep = spec(2, 1, {"R", "G", "B", "A", "Z"});
  deep.deep = true;
  const auto output = OIIO::ImageOutput::create("deep.exr");
  ASSERT_TRUE(output->open(at("deep.exr"), deep));
  OIIO::DeepData data;
  data.init(deep);
  ASSERT_TRUE(output->write_deep_image(data));
  output->close();
  EXPECT_THAT(test::error_of([&] { load_image(at("deep.exr")); }), HasSubstr("deep"));
}

TEST_F(ImageFiles, TilesAndHalvesAreReadAsAll) {
  OIIO::ImageSpec tiled = spec(40, 20, {"R", "G", "B"}, OIIO::TypeDesc::HALF);
  tiled.tile_width = tiled.tile_height = 16;
  expect_near(load_image(save("t.exr", tiled, {1, .25f, .5f})).pixels[799], {1, .25f, .5f});
}

// A 2 x 1 data window of red, green at (x, y) of the plane; the display window begins at `origin` and is 4 x 2.
TEST_F(ImageFiles, TheDisplayWindowIsTheImage) {
  const auto load = [&](int x, int y, int origin, int width, int height) {
    OIIO::ImageSpec s = spec(width, height, {"R", "G", "B"});
    s.x = x, s.y = y, s.full_x = origin, s.full_y = origin, s.full_width = 4, s.full_height = 2;
    return load_image(save("w.exr", s, {1, .25f, .5f}));
  };
  const auto lit = [](const Image& image) {
    std::string map;
    for (const vec3& p : image.pixels) map += p == vec3(1, .25f, .5f) ? '#' : p == vec3(0.0f) ? '.' : '?';
    return map;
  };
  EXPECT_EQ(lit(load(0, 0, 0, 2, 1)), "##......");
  EXPECT_EQ(lit(load(1, 1, 0, 2, 1)), ".....##.");
  EXPECT_EQ(lit(load(102, 100, 100, 2, 2)), "..##..##");
  EXPECT_EQ(lit(load(-3, -3, -2, 2, 2)), "#.......");
  EXPECT_EQ(lit(load(-2, -2, 0, 8, 6)), "########");
  EXPECT_EQ(lit(load(50, 50, 0, 4, 2)), "........");
  EXPECT_EQ(lit(load(7, 7, 7, 4, 2)), "########");
  EXPECT_THAT(messages_of([&] { load(0, 0, 0, 2, 1); }), HasSubstr("6 that the file does not hold are black"));
  EXPECT_THAT(messages_of([&] { load(-2, -2, 0, 8, 6); }), HasSubstr("40 outside are cut off"));
  EXPECT_EQ(messages_of([&] { load(7, 7, 7, 4, 2); }), "");
}

TEST_F(ImageFiles, ScreenImagesAreMadeLinear) {
  const float half = 128.0f / 255.0f;
  for (const char* name : {"a.png", "a.bmp", "a.tga", "a.jpg", "a.tif", "a.ppm"}) {
    const std::string file = save(name, spec(8, 4, {"R", "G", "B"}, OIIO::TypeDesc::UINT8), {half, half, half});
    expect_near(load_image(file).pixels[5], vec3(0.2159f), 2e-3f);
    const std::string said = messages_of([&] { load_image(file); });
    EXPECT_THAT(said, HasSubstr("low dynamic range")) << name;
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  }
  expect_near(load_image(save("16.png", spec(8, 4, {"R", "G", "B"}, OIIO::TypeDesc::UINT16), {1, 0.5f, 0})).pixels[0],
              {1, 0.2140f, 0});
  expect_near(load_image(save("grey.png", spec(8, 4, {"Y"}, OIIO::TypeDesc::UINT8), {half})).pixels[0], vec3(0.2159f));
  OIIO::ImageSpec linear = spec(8, 4, {"R", "G", "B"}, OIIO::TypeDesc::UINT16), power = linear;
  linear.attribute("oiio:ColorSpace", "Linear");
  expect_near(load_image(save("linear.png", linear, {1, 0.5f, 0})).pixels[0], {1, 0.5f, 0});
  power.attribute("oiio:ColorSpace", "Gamma1.8");
  power.attribute("oiio:Gamma", 1.8f);
  expect_near(load_image(save("power.png", power, {1, 0.5f, 0})).pixels[0], {1, std::pow(0.5f, 1.8f), 0}, 1e-3f);
  const std::string floats = save("f.tif", spec(8, 4, {"R", "G", "B"}), {3, 0.5f, 0});
  expect_near(load_image(floats).pixels[0], {3, 0.5f, 0});
  EXPECT_EQ(messages_of([&] { load_image(floats); }), "");
}

TEST_F(ImageFiles, TransparencyIsCounted) {
  OIIO::ImageSpec png = spec(8, 4, {"R", "G", "B", "A"}, OIIO::TypeDesc::UINT8);
  png.attribute("oiio:UnassociatedAlpha", 1);
  const std::string clear = save("0.png", png, {1, 1, 1, 0});
  EXPECT_EQ(load_image(clear).pixels[0], vec3(0.0f));
  EXPECT_THAT(messages_of([&] { load_image(clear); }), HasSubstr("32 of 32 pixels are transparent, 32 of them wholly"));
  const std::string part = save("half.png", png, {1, 128 / 255.0f, 0, 51 / 255.0f});
  expect_near(load_image(part).pixels[0], vec3(1, 0.2159f, 0) * 0.2f);  // linear, then times alpha
  EXPECT_THAT(messages_of([&] { load_image(part); }), HasSubstr("32 of 32 pixels are transparent, 0 of them wholly"));
  EXPECT_THAT(messages_of([&] { load_image(save("1.png", png, {1, 1, 1, 1})); }), Not(HasSubstr("transparent")));
  const std::string exr = save_exr("a.exr", {"R", "G", "B", "A"}, {0.5f, 0.25f, 0, 0.5f});  // multiplied already
  expect_near(load_image(exr).pixels[0], {0.5f, 0.25f, 0});
  EXPECT_THAT(messages_of([&] { load_image(exr); }), HasSubstr("8 of 8 pixels are transparent"));
}

// Letters of the picture upright: ABC over DEF. Stored as each of Exif's numbers says.
TEST_F(ImageFiles, OrientationTagsAreApplied) {
  const std::string stored[8] = {"ABCDEF", "CBAFED", "FEDCBA", "DEFABC", "ADBECF", "CFBEAD", "FCEBDA", "DAEBFC"};
  for (int number = 1; number <= 8; ++number) {
    OIIO::ImageSpec s = spec(number < 5 ? 3 : 2, number < 5 ? 2 : 3, {"R", "G", "B"});
    s.attribute("Orientation", number);
    std::vector<float> values;
    for (const char c : stored[number - 1]) values.insert(values.end(), 3, float(c - 'A'));
    const auto output = OIIO::ImageOutput::create("o.tif");
    ASSERT_TRUE(output->open(at("o.tif"), s) && output->write_image(OIIO::TypeDesc::FLOAT, values.data()));
    output->close();
    const Image image = load_image(at("o.tif"));
    ASSERT_EQ(image.width, 3) << number;
    for (int i = 0; i < 6; ++i) EXPECT_EQ(image.pixels[i].x, float(i)) << number;
  }
}

TEST_F(ImageFiles, DamageIsAnErrorThatNamesTheFile) {
  ::testing::internal::CaptureStderr();  // libpng's own words
  const auto error = [](const std::string& file) { return test::error_of([&] { load_image(file); }); };
  EXPECT_THAT(error(folder_.write("empty.exr", "")), HasSubstr("empty.exr"));
  EXPECT_THAT(error(folder_.path()), HasSubstr("folder"));
  for (const char* name : {"d.exr", "d.hdr", "d.png", "d.jpg", "d.tif", "d.bmp", "d.tga"}) {
    const bool floats = name == std::string("d.exr") || name == std::string("d.hdr");
    const OIIO::ImageSpec s = spec(64, 32, {"R", "G", "B"}, floats ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
    const std::string whole = test::read_text(save(name, s, {1, 0.25f, 0.5f}));
    for (const std::size_t size : {whole.size() / 8, whole.size() / 2, whole.size() * 9 / 10})
      EXPECT_THAT(error(folder_.write("cut-" + std::string(name), whole.substr(0, size))), HasSubstr("cut-"))
          << name << " " << size << " of " << whole.size();
    // Whatever a damaged byte does: an image or an Error of one line with the file's name.
    for (std::size_t i = 0; i < 100; ++i) {
      std::string bad = whole;
      bad[i * 7919 % std::min<std::size_t>(whole.size(), 700)] = char(i * 151 % 256);
      const std::string message = error(folder_.write("bad-" + std::string(name), bad));
      if (message.empty()) continue;
      ASSERT_THAT(message, HasSubstr("bad-")) << i;
      ASSERT_EQ(message.find('\n'), std::string::npos) << message;
    }
  }
  ::testing::internal::GetCapturedStderr();
}

}  // namespace
}  // namespace penumbra
