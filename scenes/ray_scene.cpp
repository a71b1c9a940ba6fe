#include "scenes/ray_scene.h"

#if PENUMBRA_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <limits>

#include "scenes/error.h"
#include "scenes/tree_decay.h"

namespace penumbra {
namespace {

#if PENUMBRA_EMBREE_MAJOR >= 4
void intersect1(RTCScene scene, RTCRayHit* ray) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  rtcIntersect1(scene, ray, &arguments);
}
void occluded1(RTCScene scene, RTCRay* ray) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  rtcOccluded1(scene, ray, &arguments);
}
void occluded16(const int* valid, RTCScene scene, bool alike, RTCRay16* rays) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.flags = alike ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
  rtcOccluded16(valid, scene, rays, &arguments);
}
void intersect16(const int* valid, RTCScene scene, RTCRayHit16* rays) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect16(valid, scene, rays, &arguments);
}
#else
void intersect1(RTCScene scene, RTCRayHit* ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, ray);
}
void occluded1(RTCScene scene, RTCRay* ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, ray);
}
void occluded16(const int* valid, RTCScene scene, bool alike, RTCRay16* rays) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = alike ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  rtcOccluded16(valid, scene, &context, rays);
}
void intersect16(const int* valid, RTCScene scene, RTCRayHit16* rays) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(valid, scene, &context, rays);
}
#endif

constexpr float infinity = std::numeric_limits<float>::infinity();

RTCRay make_ray(vec3 origin, vec3 direction, float near, float far) {
  RTCRay ray{};
  ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
  ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
  ray.tnear = near, ray.tfar = far;
  ray.mask = ~0u;
  return ray;
}

/// Embree ends the program at a ray that is no number; such a ray meets nothing.
bool is_number(vec3 origin, vec3 direction) {
  const float sum = (origin.x + origin.y + origin.z) + (direction.x + direction.y + direction.z);
  return std::isfinite(sum);
}

/// A packet in Embree's terms; lanes from `count` on are switched off, and those of rays that are no numbers.
void fill(const RayPacket& packet, int count, RTCRay16& rays, int* valid) {
  float* origin[3] = {rays.org_x, rays.org_y, rays.org_z};
  float* direction[3] = {rays.dir_x, rays.dir_y, rays.dir_z};
  for (int c = 0; c < 3; ++c) {
    std::copy_n(packet.origin[c], RayPacket::size, origin[c]);
    std::copy_n(packet.direction[c], RayPacket::size, direction[c]);
  }
  std::copy_n(packet.far, RayPacket::size, rays.tfar);
  std::fill_n(rays.tnear, RayPacket::size, 0.0f);
  std::fill_n(rays.time, RayPacket::size, 0.0f);
  std::fill_n(rays.mask, RayPacket::size, ~0u);
  std::fill_n(rays.id, RayPacket::size, 0u);
  std::fill_n(rays.flags, RayPacket::size, 0u);
  for (int i = 0; i < RayPacket::size; ++i) {
    float sum = 0.0f;
    for (int c = 0; c < 3; ++c) sum += packet.origin[c][i] + packet.direction[c][i];
    valid[i] = i < count && sum - sum == 0.0f ? -1 : 0;  // infinite or not a number: the difference is no number
    // Where Embree has no packets of 16 it splits them, and looks at the interval alone.
    if (!valid[i]) rays.tnear[i] = 1.0f, rays.tfar[i] = 0.0f;
  }
}

struct MeshBuffers {
  vec3* positions = nullptr;
  const uvec3* triangles = nullptr;
};

struct NearestQuery {
  MeshBuffers mesh;
  Nearest best;
};

/// Embree hands over every triangle within the query's radius; a nearer one shrinks it.
bool look_at_triangle(RTCPointQueryFunctionArguments* arguments) {
  auto& [mesh, best] = *static_cast<NearestQuery*>(arguments->userPtr);
  const uvec3 t = mesh.triangles[arguments->primID];
  const vec3 from(arguments->query->x, arguments->query->y, arguments->query->z);
  const vec3 point = nearest_point(from, mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]);
  const float distance = glm::distance(from, point);
  if (!(distance < best.distance)) return false;
  best = {distance, point};
  arguments->query->radius = distance;
  return true;
}

bool look_at_any(RTCPointQueryFunctionArguments* arguments) {
  (*static_cast<const std::function<void(unsigned)>*>(arguments->userPtr))(arguments->primID);
  return false;
}

bool count_memory(void* user, ssize_t bytes, bool) {
  *static_cast<std::atomic<ssize_t>*>(user) += bytes;
  return true;
}

}  // namespace

struct RayScene::Impl {
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = nullptr;
  MeshBuffers buffers;
  RTCGeometry moving = nullptr;  ///< a mesh that was moved before; the scene owns it
  TreeDecay decay;
  std::atomic<ssize_t> bytes{0};
  Impl() {
    if (!device) throw Error("Embree cannot start (error {})", int(rtcGetDeviceError(nullptr)));
    rtcSetDeviceMemoryMonitorFunction(device, count_memory, &bytes);
  }
  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
};

RayScene::RayScene() : impl_(std::make_unique<Impl>()) {}
RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

void RayScene::begin(const Bounds& box) {
  if (impl_->scene) rtcReleaseScene(impl_->scene);
  impl_->scene = rtcNewScene(impl_->device);
  impl_->buffers = {};
  impl_->moving = nullptr;
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);  // no light through the edges between triangles
  box_ = box;
}

void RayScene::commit() {
  rtcCommitScene(impl_->scene);
  if (const RTCError error = rtcGetDeviceError(impl_->device); error != RTC_ERROR_NONE)
    throw Error("Embree cannot build the scene (error {})", int(error));
}

void RayScene::build(const Mesh& mesh) {
  build(mesh, false);
}

void RayScene::build(const Mesh& mesh, bool to_be_moved) {
  begin(bounds(mesh));
  if (to_be_moved) {
    rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(impl_->scene, RTC_BUILD_QUALITY_LOW);  // a tree for each mesh: of the mesh's own quality
  }
  if (!mesh.empty()) {
    RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* positions = static_cast<vec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 sizeof(vec3), mesh.positions.size()));
    auto* triangles = static_cast<uvec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                  sizeof(uvec3), mesh.triangles.size()));
    if (!positions || !triangles) throw Error("Embree has no memory for {} triangles", mesh.triangles.size());
    std::copy(mesh.positions.begin(), mesh.positions.end(), positions);
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), triangles);
    impl_->buffers = {positions, triangles};
    if (to_be_moved) {
      rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
      impl_->moving = geometry;
      impl_->decay = TreeDecay(mesh);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(impl_->scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  commit();
}

void RayScene::move(const Mesh& mesh) {
  if (!impl_->moving || !impl_->decay.same_triangles(mesh) || impl_->decay.has_decayed(mesh)) return build(mesh, true);
  std::copy(mesh.positions.begin(), mesh.positions.end(), impl_->buffers.positions);
  rtcUpdateGeometryBuffer(impl_->moving, RTC_BUFFER_TYPE_VERTEX, 0);
  rtcCommitGeometry(impl_->moving);
  box_ = bounds(mesh);
  commit();
}

void RayScene::build(const SphereSet& set) {
  std::vector<Sphere> solid;
  std::copy_if(set.spheres.begin(), set.spheres.end(), std::back_inserter(solid),
               [](const Sphere& s) { return s.radius > 0.0f; });
  begin(bounds(set));
  if (!solid.empty()) {
    static_assert(sizeof(Sphere) == 4 * sizeof(float));  // Embree reads x, y, z, radius
    RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    auto* spheres = static_cast<Sphere*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, sizeof(Sphere), solid.size()));
    if (!spheres) throw Error("Embree has no memory for {} spheres", solid.size());
    std::copy(solid.begin(), solid.end(), spheres);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(impl_->scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  commit();
}

Hit RayScene::intersect(vec3 origin, vec3 direction, float near) const {
  if (!is_number(origin, direction)) return {infinity, 0, 0, 0, vec3(0.0f)};
  RTCRayHit query{};
  query.ray = make_ray(origin, direction, near, infinity);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  intersect1(impl_->scene, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {infinity, 0, 0, 0, vec3(0.0f)};
  return {query.ray.tfar, query.hit.primID, query.hit.u, query.hit.v,
          vec3(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z)};
}

bool RayScene::occluded(vec3 origin, vec3 direction, float far) const {
  if (!is_number(origin, direction)) return false;
  RTCRay ray = make_ray(origin, direction, 0.0f, far);
  occluded1(impl_->scene, &ray);
  return ray.tfar < 0.0f;
}

unsigned RayScene::meets_box(const RayPacket& packet, int count) const {
  constexpr int size = RayPacket::size;
  float enter[size], leave[size];
  for (int i = 0; i < size; ++i) enter[i] = 0.0f, leave[i] = packet.far[i];
  for (int c = 0; c < 3; ++c) {
    const float low = box_.low[c], high = box_.high[c];
    for (int i = 0; i < size; ++i) {
      const float inverse = 1.0f / packet.direction[c][i];
      const float a = (low - packet.origin[c][i]) * inverse, b = (high - packet.origin[c][i]) * inverse;
      const float first = a < b ? a : b, second = a < b ? b : a;
      enter[i] = first > enter[i] ? first : enter[i];
      leave[i] = second < leave[i] ? second : leave[i];
    }
  }
  constexpr float room = 1.0f + 0x1p-21f;  // every step above rounds relative to its result (Ize 2013)
  unsigned bits = 0;
  for (int i = 0; i < size; ++i) bits |= (enter[i] > leave[i] * room ? 0u : 1u) << i;  // NaN counts as meeting
  return bits & ((1u << count) - 1u);
}

unsigned RayScene::occluded(const RayPacket& packet, int count, bool alike) const {
  alignas(64) int valid[RayPacket::size];
  alignas(64) RTCRay16 rays;
  fill(packet, count, rays, valid);
  occluded16(valid, impl_->scene, alike, &rays);
  unsigned bits = 0;
  for (int i = 0; i < count; ++i) bits |= (rays.tfar[i] < 0.0f ? 1u : 0u) << i;
  return bits;
}

void RayScene::first_hits(const RayPacket& packet, int count, float* distance) const {
  alignas(64) int valid[RayPacket::size];
  alignas(64) RTCRayHit16 rays;
  fill(packet, count, rays.ray, valid);
  std::fill_n(rays.hit.geomID, RayPacket::size, RTC_INVALID_GEOMETRY_ID);
  std::fill_n(rays.hit.instID[0], RayPacket::size, RTC_INVALID_GEOMETRY_ID);
  intersect16(valid, impl_->scene, &rays);
  for (int i = 0; i < count; ++i)
    distance[i] = rays.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID ? infinity : rays.ray.tfar[i];
}

Nearest RayScene::nearest(vec3 point, float most) const {
  RTCPointQuery query{point.x, point.y, point.z, 0.0f, std::nextafter(most, infinity)};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  NearestQuery search{impl_->buffers, {query.radius, point}};
  rtcPointQuery(impl_->scene, &query, &context, look_at_triangle, &search);
  if (search.best.distance > most) search.best.distance = infinity;
  return search.best;
}

void RayScene::triangles_near(vec3 point, float reach, const std::function<void(unsigned)>& look_at) const {
  if (!impl_->buffers.triangles) return;
  RTCPointQuery query{point.x, point.y, point.z, 0.0f, std::nextafter(reach, infinity)};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(impl_->scene, &query, &context, look_at_any, const_cast<std::function<void(unsigned)>*>(&look_at));
}

std::size_t RayScene::bytes() const {
  return std::size_t(std::max<ssize_t>(0, impl_->bytes)) + impl_->decay.bytes();
}

bool inside(const RayScene& scene, vec3 point) {
  int votes = 0;
  for (int axis = 0; axis < 3; ++axis) {
    vec3 direction(0.0f);
    direction[axis] = 1.0f;
    int crossings = 0;
    float near = 0.0f;
    for (Hit hit = scene.intersect(point, direction); hit && crossings < 1000;
         hit = scene.intersect(point, direction, near)) {
      ++crossings;
      near = std::nextafter(hit.distance, infinity) + 1e-6f * hit.distance;
    }
    votes += crossings & 1;
  }
  return votes >= 2;
}

}  // namespace penumbra
