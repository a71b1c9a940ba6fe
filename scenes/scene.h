// What is lit, and what of it moves.
#pragma once

#include <string>

#include "scenes/carry.h"
#include "scenes/light.h"
#include "scenes/receivers.h"
#include "scenes/sphere_set.h"

namespace penumbra {

/// Periodic motion; phase = sin(2 pi frame / period) for shapes and cameras, frame / period for lights.
struct Motion {
  enum class Kind { none, twist, bend, rigid, rotate_light, orbit, dolly };
  Kind kind = Kind::none;
  /// Radians: largest angle at the top (twist, bend), largest angle (rigid, orbit), per period (light). Dolly: natural
  /// logarithm of the eye's largest distance to its target over that at rest.
  float amount = 0.0f;
  float period = 16.0f;  ///< frames
  int frames = 1;        ///< how many frames a run walks through
  Carry carry = Carry::rigid;
  vec3 centre{0.0f};  ///< shapes and lamps turn about the vertical axis through it
  vec3 travel{0.0f};  ///< m: how far what blocks light goes besides, at most
  bool moves_occluder() const { return kind == Kind::twist || kind == Kind::bend || kind == Kind::rigid; }
  bool moves_camera() const { return kind == Kind::orbit || kind == Kind::dolly; }
};

/// A thing of a scene: so many vertices, triangles and spheres of it in a row, and how they move.
struct Entity {
  struct Range {
    std::size_t first = 0, count = 0;
    std::size_t end() const { return first + count; }
  };
  std::string name;
  Range vertices, triangles, spheres;
  Motion motion = {};  ///< its own; none: as the scene's says
};

/// Rest state of everything. Techniques receive it once, in prepare(). All of it is counted from `origin`, which lies
/// near the receivers: what a scene looks like does not depend on where it lies.
struct Scene {
  std::string name;
  dvec3 origin{0.0};             ///< in the coordinates of the scene's file
  Mesh mesh;                     ///< of all entities, one after the other, and of mirrors
  SphereSet spheres;             ///< of all entities
  std::vector<Entity> entities;  ///< none: all is one
  std::string objective;         ///< that the spheres were fitted for; empty if they were given
  Receivers receivers;
  Light light;
  Motion motion;
  ReceiverSpec receiver_spec;
};

/// What differs from the frame before.
struct Changes {
  bool mesh = false, spheres = false, receivers = false, light = false;
};

/// One moment. The references stay valid until the next frame is made.
struct Frame {
  double time;  ///< frame number
  const Mesh& mesh;
  const SphereSet& spheres;
  const Light& light;
  const Receivers& receivers;
  Changes changed;
};

/// Walks a scene through its motions. Meshes deform and carry their spheres along; spheres without a mesh follow the
/// motion themselves. An entity without a motion of its own follows the scene's.
class Animation {
 public:
  /// The scene must outlive this and its frames.
  explicit Animation(const Scene& scene);
  explicit Animation(const Scene&& scene) = delete;
  /// What does not move is the scene's own.
  Frame frame(int index);
  const Scene& scene() const { return scene_; }
  /// Does something that blocks light move?
  bool deforms() const { return !moving_.empty(); }
  /// The scene's receivers as they are asked for in a frame: a camera may move.
  ReceiverSpec receiver_spec(int index) const;
  /// The longest motion's.
  int frames() const;

 private:
  /// An entity that moves, apart from the others.
  struct Moving {
    Entity entity;
    Mesh rest, mesh;
    SphereSet rest_spheres, spheres;
    Bounds box;  ///< at rest
    SphereCarrier carrier;
  };
  void begin(const Entity& entity);
  void move(Moving& part, int index);

  const Scene& scene_;
  std::vector<Moving> moving_;
  Mesh mesh_;
  SphereSet spheres_;
  Light light_;
  Receivers receivers_;
};

}  // namespace penumbra
