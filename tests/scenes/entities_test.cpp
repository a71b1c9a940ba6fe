// Scenes of several things: where they lie in mesh and sphere set, and how each moves.
#include <cmath>

#include "scenes/scene_file.h"
#include "scenes/scene_outline.h"
#include "tests/support.h"

namespace penumbra {
namespace {

const std::string rest =
    "[receivers]\nplane = { half_extent = 2.0, resolution = 4 }\n[light]\nenvironment = \"constant\"\n";
const std::string box = "mesh = \"box\"\nfit = { height = 1.0, on_ground = true }\nspheres = [[0, 0, 0, 0.5]]\n";

Scene load_text(const std::string& text) {
  const test::TemporaryFolder folder;
  return load_scene(folder.write("e.toml", text));
}

std::string error_for(const std::string& text) {
  return test::error_of([&] { load_text(text); });
}

TEST(Entities, TheShortFormIsOneEntity) {
  const Scene one = load_text("[occluder]\n" + box + rest), same = load_text("[[entity]]\n" + box + rest);
  ASSERT_EQ(one.entities.size(), 1u);
  EXPECT_EQ(one.entities[0].vertices.count, one.mesh.positions.size());
  EXPECT_EQ(one.mesh.positions, same.mesh.positions);
  EXPECT_EQ(one.mesh.triangles, same.mesh.triangles);
  EXPECT_EQ(same.spheres.spheres[0].centre, one.spheres.spheres[0].centre);
  EXPECT_EQ(same.entities[0].name, "entity 1");
}

const std::string two_things =
    "[[entity]]\nname = \"left\"\nmesh = \"box\"\nfit = { height = 1.0, on_ground = true, at = [-1, 0, 0] }\n"
    "spheres = [[0, 0, 0, 0.5]]\n"
    "motion = { kind = \"rigid\", amount = 0.0, travel = [0, 0.25, 0.5], period = 4, frames = 5 }\n"
    "[[entity]]\nmesh = \"torus\"\nfit = { height = 0.5, on_ground = true, at = [1, 0, 0] }\n"
    "spheres = [[1, 0, 0, 0.4], [-1, 0, 0, 0.4]]\n";

TEST(Entities, FollowOneAnotherAndMoveOnTheirOwn) {
  const Scene scene = load_text(two_things + rest);
  ASSERT_EQ(scene.entities.size(), 2u);
  const Entity &left = scene.entities[0], &ring = scene.entities[1];
  EXPECT_EQ(left.name, "left");
  EXPECT_EQ(ring.vertices.first, left.vertices.end());
  EXPECT_EQ(ring.triangles.end(), scene.mesh.triangles.size());
  EXPECT_EQ(ring.spheres.first, 1u);
  EXPECT_EQ(ring.spheres.end(), scene.spheres.size());
  for (std::size_t t = 0; t < scene.mesh.triangles.size(); ++t)
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(scene.mesh.triangles[t][c] < ring.vertices.first, t < ring.triangles.first) << "of its own vertices";

  Animation animation(scene);
  EXPECT_TRUE(animation.deforms());
  EXPECT_EQ(animation.frames(), 5);
  const Frame frame = animation.frame(1);  // sin(2 pi / 4) = 1
  for (std::size_t i = 0; i < scene.mesh.positions.size(); ++i) {
    const vec3 by = i < ring.vertices.first ? vec3(0, 0.25f, 0.5f) : vec3(0.0f);
    EXPECT_LT(glm::distance(frame.mesh.positions[i], scene.mesh.positions[i] + by), 1e-6f);
  }
  EXPECT_LT(glm::distance(frame.spheres.spheres[0].centre, scene.spheres.spheres[0].centre + vec3(0, 0.25f, 0.5f)),
            1e-5f);
  EXPECT_EQ(frame.spheres.spheres[2].centre, scene.spheres.spheres[2].centre);
}

TEST(Entities, SpheresOfTheSecondMoveWithTheSecond) {
  const Scene scene =
      load_text("[[entity]]\n" + box +
                "[[entity]]\nmesh = \"sphere\"\nfit = { height = 1.0, at = [2, 0.5, 0] }\n"
                "spheres = [[0, 0, 0, 1]]\nmotion = { kind = \"rigid\", amount = 0.0, travel = [0, 1, 0], "
                "period = 4 }\n" +
                rest);
  Animation animation(scene);
  const Frame frame = animation.frame(1);
  EXPECT_EQ(frame.spheres.spheres[0].centre, scene.spheres.spheres[0].centre);
  EXPECT_LT(glm::distance(frame.spheres.spheres[1].centre, vec3(2, 1.5f, 0)), 1e-4f);
}

/// An entity turns about its own middle; one without a motion follows the scene's.
TEST(Entities, TurnAboutTheirOwnMiddle) {
  const std::string turning =
      "[[entity]]\nmesh = \"box\"\nfit = { height = 1.0, at = [3, 0.5, 0] }\n"
      "motion = { kind = \"rigid\", amount = 1.5707963267948966, period = 4 }\n";
  const std::string still = "[[entity]]\nmesh = \"sphere\"\nfit = { height = 1.0, at = [1, 0.5, 0] }\n";
  const Scene scene =
      load_text(turning + still + rest + "[motion]\nkind = \"rigid\"\namount = 1.5707963267948966\nperiod = 4\n");
  Animation animation(scene);
  const Frame frame = animation.frame(1);
  Mesh first, second;
  first.triangles = second.triangles = {{0, 1, 2}};
  const auto middle = [&](const Entity& entity) {
    dvec3 sum(0.0);
    for (std::size_t i = entity.vertices.first; i < entity.vertices.end(); ++i) sum += dvec3(frame.mesh.positions[i]);
    return sum / double(entity.vertices.count);
  };
  EXPECT_LT(glm::distance(middle(scene.entities[0]), dvec3(3, 0.5, 0)), 1e-5) << "on the spot";
  EXPECT_LT(glm::distance(middle(scene.entities[1]), dvec3(0, 0.5, -1)), 1e-3) << "about the axis: +x goes to -z";
}

TEST(Entities, MirrorsStayWhereTheyAre) {
  const std::string camera =
      "[receivers]\ncamera = { eye = [0, 2, 5], target = [0, 0.5, 0], width = 8, height = 6 }\n"
      "[light]\nenvironment = \"constant\"\n[[mirror]]\nsphere = { centre = [2, 0.5, 1], radius = 0.5 }\n";
  const Scene scene = load_text("[occluder]\nmesh = \"box\"\n" + camera +
                                "[motion]\nkind = \"rigid\"\ntravel = [0, 1, 0]\nperiod = 4\n");
  Animation animation(scene);
  const Frame frame = animation.frame(1);
  const std::size_t own = scene.entities[0].vertices.count;
  ASSERT_LT(own, scene.mesh.positions.size());
  EXPECT_NEAR(frame.mesh.positions[0].y, scene.mesh.positions[0].y + 1.0f, 1e-6f);
  for (std::size_t i = own; i < scene.mesh.positions.size(); ++i)
    EXPECT_EQ(frame.mesh.positions[i], scene.mesh.positions[i]);
}

/// A count that a suite chooses is for all entities with a mesh, in even shares; outline and scene agree.
TEST(Entities, ShareTheSpheresThatASuiteAsksFor) {
  const test::TemporaryFolder folder;
  const std::string path = folder.write(
      "s.toml",
      "[[entity]]\nmesh = \"sphere\"\nfit = { height = 1.0, at = [-1, 0.5, 0] }\nspheres = 2\n"
      "[[entity]]\nmesh = \"none\"\nspheres = [[0, 3, 0, 0.2]]\n"
      "[[entity]]\nmesh = \"box\"\nfit = { height = 1.0, at = [1, 0.5, 0] }\nspheres = 3\nobjective = \"k-means\"\n" +
          rest);
  SphereChoice choice;
  EXPECT_EQ(read_outline(path).objective, "mixed");
  EXPECT_EQ(read_outline(path).spheres, 6u);
  choice.count = 5, choice.objective = Objective::k_means;
  EXPECT_EQ(read_outline(path, choice).spheres, 6u);
  const Scene scene = load_scene(path, choice);
  EXPECT_EQ(scene.entities[0].spheres.count, 3u);
  EXPECT_EQ(scene.entities[1].spheres.count, 1u);
  EXPECT_EQ(scene.entities[2].spheres.count, 2u);
  EXPECT_EQ(scene.objective, "mixed") << "one is given";
}

TEST(Entities, MistakesAreNamed) {
  EXPECT_NE(
      error_for("[[entity]]\n" + box + "name = \"a\"\n[[entity]]\n" + box + "name = \"a\"\n" + rest).find("another"),
      std::string::npos);
  EXPECT_NE(error_for("[[entity]]\n" + box + "motion = { kind = \"twist\" }\n" + rest + "[motion]\nkind = \"bend\"\n")
                .find("moves nothing"),
            std::string::npos);

  EXPECT_NE(error_for(rest).find("[[entity]]"), std::string::npos);
  EXPECT_NE(error_for("[occluder]\n" + box + "[[entity]]\n" + box + rest).find("[[entity]]"), std::string::npos);
  EXPECT_NE(error_for("[[entity]]\n" + box + "colour = 1\n" + rest).find("entity[0].colour"), std::string::npos);
  EXPECT_NE(error_for("[[entity]]\n" + box + "motion = { kind = \"orbit\" }\n" + rest).find("twist, bend, rigid"),
            std::string::npos);
  EXPECT_NE(error_for("[[entity]]\n" + box + "name = \"a/b\"\n" + rest).find("name"), std::string::npos);
  EXPECT_NE(
      error_for("[occluder]\n" + box + rest + "[motion]\nkind = \"rotate-light\"\ntravel = [0, 1, 0]\n").find("travel"),
      std::string::npos);
  EXPECT_NE(error_for("[occluder]\n" + box + "name = \"x\"\n" + rest).find("occluder.name"), std::string::npos);
}

}  // namespace
}  // namespace penumbra
