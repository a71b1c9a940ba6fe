// A tree that follows a mesh that moves: what it answers, and when it is built anew.
#include "scenes/ray_scene.h"

#include <random>

#include "scenes/tree_decay.h"
#include "tests/support.h"

namespace penumbra {
namespace {

/// A ball of bent shape: every corner is pushed outwards by a wave.
Mesh bent(float by) {
  Mesh mesh = make_sphere({0, 0, 0}, 1.0f, 48);
  for (vec3& p : mesh.positions) p *= 1.0f + by * std::sin(5.0f * p.x + 3.0f * p.y);
  return mesh;
}

int different_answers(const RayScene& a, const RayScene& b) {
  std::mt19937 random(11);
  std::normal_distribution<float> along;
  const auto point = [&](float size) { return size * vec3(along(random), along(random), along(random)); };
  int different = 0, met = 0;
  for (int k = 0; k < 4000; ++k) {
    RayPacket packet = {};
    for (int i = 0; i < RayPacket::size; ++i)
      packet.set(i, point(1.5f), glm::normalize(point(1.0f)), std::numeric_limits<float>::infinity());
    const unsigned in_a = a.occluded(packet, RayPacket::size) & a.meets_box(packet, RayPacket::size);
    different += in_a != b.occluded(packet, RayPacket::size);
    met += in_a != 0;
  }
  EXPECT_GT(met, 1000);
  return different;
}

TEST(RayScene, AMovedMeshAnswersAsAFreshOne) {
  RayScene moved(bent(0.0f));
  for (const float by : {0.1f, 0.3f, -0.4f, 0.6f}) {
    moved.move(bent(by));
    EXPECT_EQ(different_answers(moved, RayScene(bent(by))), 0) << by;
  }
  moved.move(make_box(vec3(-0.5f), vec3(0.5f)));
  EXPECT_EQ(different_answers(moved, RayScene(make_box(vec3(-0.5f), vec3(0.5f)))), 0) << "other triangles";
  moved.move(Mesh{});
  EXPECT_FALSE(moved.occluded({0, 2, 0}, {0, -1, 0}, 10.0f));
  moved.move(bent(0.2f));
  EXPECT_EQ(different_answers(moved, RayScene(bent(0.2f))), 0);
}

/// Every other corner leaves the ball: boxes of what was near grow.
TEST(RayScene, ATreeThatFellApartIsBuiltAnew) {
  Mesh mesh = make_sphere({0, 0, 0}, 1.0f, 48);
  const TreeDecay decay(mesh);
  EXPECT_EQ(decay.growth(mesh), 1.0);
  Mesh larger = mesh;
  for (vec3& p : larger.positions) p *= 7.0f;
  EXPECT_NEAR(decay.growth(larger), 1.0, 1e-5) << "in any unit";
  EXPECT_TRUE(decay.same_triangles(larger));
  Mesh torn = mesh;
  for (std::size_t i = 0; i < torn.positions.size(); ++i) torn.positions[i].x += i % 2 ? 3.0f : 0.0f;
  EXPECT_TRUE(decay.has_decayed(torn));
  EXPECT_FALSE(TreeDecay(torn).has_decayed(torn));
  RayScene moved(mesh);
  moved.move(mesh);
  moved.move(torn);
  EXPECT_EQ(different_answers(moved, RayScene(torn)), 0);
  torn.triangles.pop_back();
  EXPECT_FALSE(decay.same_triangles(torn));
}

}  // namespace
}  // namespace penumbra
