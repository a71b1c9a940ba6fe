#include "scenes/scene_file.h"

#include "scenes/assets.h"
#include "tests/support.h"

namespace penumbra {
namespace {

const char* good_receivers = "[receivers]\nplane = { half_extent = 1.0, resolution = 4 }\n";
const char* good_light = "[light]\nenvironment = \"constant\"\n";
const char* good_occluder = "[occluder]\nmesh = \"box\"\n";

std::string scene_text(const std::string& occluder, const std::string& receivers, const std::string& light,
                       const std::string& rest = "") {
  return "name = \"t\"\n" + occluder + receivers + light + rest;
}

std::string error_for(const std::string& text) {
  const test::TemporaryFolder folder;
  const std::string path = folder.write("t.toml", text);
  return test::error_of([&] { load_scene(path); });
}

Scene load_text(const std::string& text) {
  const test::TemporaryFolder folder;
  return load_scene(folder.write("t.toml", text));
}

TEST(SceneFile, EveryShippedSceneLoads) {
  const auto names = shipped_names("library");
  for (const char* needed : {"bunny-city", "bunny-studio", "torus-knot-sunset", "torus-knot-lamps",
                             "resting-sphere-constant", "bunny-lamp-small", "bunny-lamp-large"})
    EXPECT_NE(std::find(names.begin(), names.end(), needed), names.end()) << needed;
  for (const std::string& name : names) {
    const Scene scene = load_scene(name);
    EXPECT_EQ(scene.name, name);
    EXPECT_FALSE(scene.mesh.empty());
    if (environment_of(scene.light)) EXPECT_FALSE(scene.spheres.empty());
    EXPECT_GT(scene.receivers.size(), 0);
  }
}

TEST(SceneFile, EveryKeyWorks) {
  const Scene scene = load_text(
      scene_text("[occluder]\nmesh = \"sphere\"\nfit = { height = 4.0, on_ground = true }\nspheres = [[0, 0, 0, 1], "
                 "[1, 0, 0, 0.5]]\n",
                 "[receivers]\ncamera = { eye = [0, 2, 9], target = [0, 2, 0], vertical_fov = 30, width = 8, height = "
                 "6, ground = -1.0 }\n"
                 "albedo = [0.1, 0.2, 0.3]\n",
                 "[light]\narea = { centre = [0, 9, 0], normal = [0, -1, 0], radius = 2.0, radiance = [1, 2, 3] }\n",
                 "[motion]\nkind = \"bend\"\namount = 0.5\nperiod = 8\nframes = 3\n"));
  EXPECT_NEAR(bounds(scene.mesh).low.y, 0.0f, 1e-6f);
  EXPECT_NEAR(bounds(scene.mesh).high.y, 4.0f, 1e-5f);
  EXPECT_EQ(scene.spheres.spheres[0].radius, 2.0f) << "fit carries the spheres along";
  EXPECT_EQ(scene.spheres.spheres[0].centre, vec3(0, 2, 0));
  EXPECT_EQ(scene.receivers.width, 8);
  EXPECT_EQ(scene.receivers.albedo[0], vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(area_light_of(scene.light)->shape, AreaLight::Shape::disc);
  EXPECT_EQ(scene.motion.kind, Motion::Kind::bend);
  EXPECT_EQ(scene.motion.frames, 3);
  EXPECT_EQ(load_text(scene_text("[occluder]\nmesh = \"bowl\"\n", "[receivers]\nvertices = true\n",
                                 "[light]\nenvironment = \"sun-sky\"\nrotation = 1.5\n"))
                .receivers.height,
            1);
}

struct BadScene {
  const char* what;
  std::string text;
  std::vector<std::string> says;
};

TEST(SceneFile, MistakesNameFileLineKeyAndWhatIsAllowed) {
  const std::vector<BadScene> bad = {
      {"not TOML", "name = \n", {"t.toml:1", "not valid TOML"}},
      {"nothing at all", "x = 1\n", {"'occluder'"}},
      {"unknown section",
       scene_text(good_occluder, good_receivers, good_light, "[fog]\ndensity = 1\n"),
       {"t.toml:8", "'fog'", "motion"}},
      {"unknown key",
       scene_text("[occluder]\nmesh = \"box\"\ncolour = 1\n", good_receivers, good_light),
       {"t.toml:4", "occluder.colour", "fit, mesh, objective, seed, spheres, up"}},
      {"unknown up",
       scene_text("[occluder]\nmesh = \"box\"\nup = \"x\"\n", good_receivers, good_light),
       {"t.toml:4", "occluder.up", "allowed are y, z"}},
      {"seed of something else",
       scene_text("[occluder]\nmesh = \"box\"\nseed = 3\n", good_receivers, good_light),
       {"occluder.seed", "primitives"}},
      {"unknown mesh",
       scene_text("[occluder]\nmesh = \"teapot\"\n", good_receivers, good_light),
       {"t.toml:3", "occluder.mesh", "bunny", "torus-knot"}},
      {"two receivers",
       scene_text(good_occluder, "[receivers]\nplane = { half_extent = 1, resolution = 4 }\nvertices = true\n",
                  good_light),
       {"receivers", "exactly one", "camera"}},
      {"no receivers", scene_text(good_occluder, "[receivers]\n", good_light), {"exactly one"}},
      {"resolution 0",
       scene_text(good_occluder, "[receivers]\nplane = { half_extent = 1.0, resolution = 0 }\n", good_light),
       {"t.toml:5", "receivers.plane.resolution", "[1, 4096]"}},
      {"resolution 10^6",
       scene_text(good_occluder, "[receivers]\nplane = { half_extent = 1.0, resolution = 1000000 }\n", good_light),
       {"[1, 4096]"}},
      {"text for number",
       scene_text(good_occluder, "[receivers]\nplane = { half_extent = \"a\", resolution = 4 }\n", good_light),
       {"half_extent", "number"}},
      {"nan",
       scene_text(good_occluder, "[receivers]\nplane = { half_extent = nan, resolution = 4 }\n", good_light),
       {"half_extent"}},
      {"no light", scene_text(good_occluder, good_receivers, "[light]\n"), {"t.toml", "environment", "area"}},
      {"a second lamp that is none",
       scene_text(good_occluder, good_receivers,
                  "[[light.area]]\ncentre = [0,1,0]\nedge_u = [1,0,0]\nedge_v = [0,0,1]\n[[light.area]]\ncentre = "
                  "[0,1,0]\n"),
       {"light.area[1]", "edge_u"}},
      {"unknown light",
       scene_text(good_occluder, good_receivers, "[light]\nenvironment = \"moon\"\n"),
       {"light.environment", "city", "lamps"}},
      {"bad mapping",
       scene_text(good_occluder, good_receivers, "[light]\nenvironment = \"city\"\nmapping = \"globe\"\n"),
       {"light.mapping", "angular"}},
      {"bad vector",
       scene_text(good_occluder, good_receivers,
                  "[light]\narea = { centre = [0, 1], edge_u = [1,0,0], edge_v = [0,0,1] }\n"),
       {"light.area.centre", "three"}},
      {"missing edge",
       scene_text(good_occluder, good_receivers, "[light]\narea = { centre = [0, 1, 0] }\n"),
       {"edge_u"}},
      {"bad albedo",
       scene_text(good_occluder, std::string(good_receivers) + "albedo = [2, 0, 0]\n", good_light),
       {"receivers.albedo"}},
      {"bad spheres",
       scene_text("[occluder]\nmesh = \"box\"\nspheres = [[0, 0, 0]]\n", good_receivers, good_light),
       {"occluder.spheres", "radius"}},
      {"no spheres",
       scene_text("[occluder]\nmesh = \"box\"\nspheres = 0\n", good_receivers, good_light),
       {"occluder.spheres", "[1, 4096]"}},
      {"unknown objective",
       scene_text("[occluder]\nmesh = \"box\"\nspheres = 4\nobjective = \"best\"\n", good_receivers, good_light),
       {"t.toml:5", "occluder.objective", "cover, shadow"}},
      {"objective without count",
       scene_text("[occluder]\nmesh = \"box\"\nspheres = [[0, 0, 0, 1]]\nobjective = \"cover\"\n", good_receivers,
                  good_light),
       {"occluder.objective", "by count"}},
      {"open mesh",
       scene_text("[occluder]\nmesh = \"bowl\"\nspheres = 4\n", good_receivers, good_light),
       {"t.toml:4", "not closed", "96 of"}},
      {"bad carry",
       scene_text(good_occluder, good_receivers, good_light, "[motion]\nkind = \"bend\"\ncarry = \"bones\"\n"),
       {"motion.carry", "rigid, affine"}},
      {"missing sphere file",
       scene_text("[occluder]\nmesh = \"box\"\nspheres = \"x.json\"\n", good_receivers, good_light),
       {"t.toml:4", "x.json"}},
      {"fit without mesh",
       scene_text("[occluder]\nmesh = \"none\"\nspheres = 4\n", good_receivers, good_light),
       {"no mesh"}},
      {"vertices without mesh",
       scene_text("[occluder]\nmesh = \"none\"\n", "[receivers]\nvertices = true\n", good_light),
       {"no mesh"}},
      {"bad motion",
       scene_text(good_occluder, good_receivers, good_light, "[motion]\nkind = \"fly\"\n"),
       {"motion.kind", "twist"}},
  };
  for (const BadScene& scene : bad) {
    const std::string message = error_for(scene.text);
    for (const std::string& part : scene.says)
      EXPECT_NE(message.find(part), std::string::npos) << scene.what << ": " << message << " does not say " << part;
    EXPECT_EQ(message.find('\n'), std::string::npos) << scene.what;
  }
}

TEST(SceneFile, PathsAreRelativeToTheFile) {
  const test::TemporaryFolder folder;
  folder.write("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("s.json", "{\"spheres\": [[0, 0, 0, 1]]}");
  const Scene scene = load_scene(folder.write(
      "t.toml", scene_text("[occluder]\nmesh = \"tri.obj\"\nspheres = \"s.json\"\n", good_receivers, good_light)));
  EXPECT_EQ(scene.mesh.triangles.size(), 1u);
  EXPECT_EQ(scene.spheres.size(), 1u);
}

/// A pyramid with normals that stands on z = 1 with its apex at (1, 2, 4), as a program with z up writes it.
const char* pyramid_with_z_up =
    "v 0 1 1\nv 3 1 1\nv 3 3 1\nv 0 3 1\nv 1 2 4\nvn 0 0 -1\nvn 0 -0.6 0.8\nvn 0.6 0 0.8\nvn 0 0.6 0.8\nvn -0.6 0 0.8\n"
    "f 4//1 3//1 2//1 1//1\nf 1//2 2//2 5//2\nf 2//3 3//3 5//3\nf 3//4 4//4 5//4\nf 4//5 1//5 5//5\n";

TEST(SceneFile, MeshesWithZUpAreTurnedUpright) {
  const test::TemporaryFolder folder;
  folder.write("pyramid.obj", pyramid_with_z_up);
  const auto load = [&](const std::string& more) {
    return load_scene(
        folder.write("t.toml", scene_text("[occluder]\nmesh = \"pyramid.obj\"\n" + more, good_receivers, good_light)));
  };
  const Scene lying = load("up = \"y\"\n"), upright = load("up = \"z\"\nspheres = [[1, 2, 4, 0.5]]\n");
  EXPECT_EQ(bounds(upright.mesh).low, vec3(0, 1, -3));
  EXPECT_EQ(bounds(upright.mesh).high, vec3(3, 4, -1));
  EXPECT_EQ(upright.spheres.spheres[0].centre, vec3(1, 4, -2)) << "at the apex, as in the file";
  ASSERT_EQ(upright.mesh.positions.size(), lying.mesh.positions.size());
  for (std::size_t i = 0; i < lying.mesh.positions.size(); ++i) {
    const vec3 p = lying.mesh.positions[i], n = lying.mesh.normals[i];
    EXPECT_EQ(upright.mesh.positions[i], vec3(p.x, p.z, -p.y));
    EXPECT_EQ(upright.mesh.normals[i], vec3(n.x, n.z, -n.y));
  }
  double volume = 0.0;
  for (const uvec3& t : upright.mesh.triangles) {
    const vec3 a = upright.mesh.positions[t.x], b = upright.mesh.positions[t.y], c = upright.mesh.positions[t.z];
    volume += double(glm::dot(a, glm::cross(b, c))) / 6.0;
    EXPECT_GT(glm::dot(glm::cross(b - a, c - a), upright.mesh.normals[t.x]), 0.0f);
  }
  EXPECT_NEAR(volume, 3.0 * 2.0 * 3.0 / 3.0, 1e-5) << "its outside is outside";

  const Scene fitted = load("up = \"z\"\nfit = { height = 6.0, on_ground = true }\nspheres = [[1, 2, 4, 0.5]]\n");
  EXPECT_EQ(bounds(fitted.mesh).low.y, 0.0f);
  EXPECT_EQ(bounds(fitted.mesh).high.y, 6.0f) << "the height is that of the turned mesh";
  EXPECT_EQ(fitted.spheres.spheres[0].centre, vec3(-1, 6, 0));
}

TEST(SceneFile, SpheresAreFittedToTheTurnedMesh) {
  const test::TemporaryFolder folder;
  folder.write("pyramid.obj", pyramid_with_z_up);
  const auto load = [&](const std::string& more) {
    return load_scene(folder.write(
        "t.toml", scene_text("[occluder]\nmesh = \"pyramid.obj\"\nspheres = 8\n" + more, good_receivers, good_light)));
  };
  const Scene upright = load("up = \"z\"\n");
  for (const Sphere& s : upright.spheres.spheres) {
    EXPECT_GT(s.centre.y, 0.9f);
    EXPECT_LT(s.centre.z, -0.9f);
  }
}

TEST(SceneFile, MeshWithNanNamesTheKey) {
  const test::TemporaryFolder folder;
  folder.write("bad.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n");
  const std::string path =
      folder.write("t.toml", scene_text("[occluder]\nmesh = \"bad.obj\"\n", good_receivers, good_light));
  const std::string message = test::error_of([&] { load_scene(path); });
  EXPECT_NE(message.find("t.toml:3"), std::string::npos) << message;
  EXPECT_NE(message.find("bad.obj"), std::string::npos) << message;
}

TEST(SceneFile, UnknownNameListsTheShippedOnes) {
  const std::string message = test::error_of([] { load_scene("no-such-scene"); });
  EXPECT_NE(message.find("bunny-city"), std::string::npos);
}

TEST(SceneFile, MissingAssetNamesItsPackage) {
  for (const Asset& asset : assets()) EXPECT_FALSE(asset.package.empty() || asset.licence.empty()) << asset.name;
  EXPECT_EQ(asset_file("no-such-asset", "mesh"), "");
}

TEST(SceneFile, AssetsMayBeMembersOfAnArchive) {
  const test::TemporaryFolder cache;
  const char* before = std::getenv("PENUMBRA_CACHE");
  const std::string kept = before ? before : "";
  setenv("PENUMBRA_CACHE", cache.path().c_str(), 1);
  EXPECT_EQ(mesh_by_name("elephant").triangles.size(), 5558u) << "as its OFF header says";
  EXPECT_TRUE(asset_file("elephant", "mesh").starts_with(cache.path())) << "unpacked once";
  before ? setenv("PENUMBRA_CACHE", kept.c_str(), 1) : unsetenv("PENUMBRA_CACHE");
}

TEST(SceneFile, SphereCountCanBeOverridden) {
  const Scene scene = load_scene("torus-knot-lamps", {8, Objective::k_means});
  EXPECT_EQ(scene.spheres.size(), 8u);
  EXPECT_EQ(scene.objective, "k-means");
  EXPECT_NE(test::error_of([] {
              load_scene("resting-sphere-constant", {{}, Objective::cover});
            }).find("no count"),
            std::string::npos);
}

}  // namespace
}  // namespace penumbra
