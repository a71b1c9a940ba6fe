#include "scenes/ray_scene.h"

#if PENUMBRA_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "scenes/error.h"

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
void occluded16(const int* valid, RTCScene scene, RTCRay16* rays) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
  rtcOccluded16(valid, scene, rays, &arguments);
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
void occluded16(const int* valid, RTCScene scene, RTCRay16* rays) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  rtcOccluded16(valid, scene, &context, rays);
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

bool count_memory(void* user, ssize_t bytes, bool) {
  *static_cast<std::atomic<ssize_t>*>(user) += bytes;
  return true;
}

}  // namespace

struct RayScene::Impl {
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = nullptr;
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

void RayScene::build(const Mesh& mesh) {
  if (impl_->scene) rtcReleaseScene(impl_->scene);
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);  // no light through the edges between triangles
  box_ = bounds(mesh);
  lift_ = 1e-4f * glm::length(box_.extent());
  box_.low -= 0.1f * lift_;  // room for rounding
  box_.high += 0.1f * lift_;
  if (!mesh.empty()) {
    RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* positions = static_cast<vec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 sizeof(vec3), mesh.positions.size()));
    auto* triangles = static_cast<uvec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                  sizeof(uvec3), mesh.triangles.size()));
    if (!positions || !triangles) throw Error("Embree has no memory for {} triangles", mesh.triangles.size());
    std::copy(mesh.positions.begin(), mesh.positions.end(), positions);
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), triangles);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(impl_->scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(impl_->scene);
  if (const RTCError error = rtcGetDeviceError(impl_->device); error != RTC_ERROR_NONE)
    throw Error("Embree cannot build the scene (error {})", int(error));
}

Hit RayScene::intersect(vec3 origin, vec3 direction, float near) const {
  RTCRayHit query{};
  query.ray = make_ray(origin, direction, near, infinity);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  intersect1(impl_->scene, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {infinity, 0, 0, 0, vec3(0.0f)};
  return {query.ray.tfar, query.hit.primID, query.hit.u, query.hit.v,
          vec3(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z)};
}

bool RayScene::occluded(vec3 origin, vec3 direction, float far) const {
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
  unsigned bits = 0;
  for (int i = 0; i < size; ++i) bits |= (enter[i] > leave[i] ? 0u : 1u) << i;  // NaN counts as meeting
  return bits & ((1u << count) - 1u);
}

unsigned RayScene::occluded(const RayPacket& packet, int count) const {
  alignas(64) int valid[RayPacket::size];
  alignas(64) RTCRay16 rays;
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
  for (int i = 0; i < RayPacket::size; ++i) valid[i] = i < count ? -1 : 0;
  occluded16(valid, impl_->scene, &rays);
  unsigned bits = 0;
  for (int i = 0; i < count; ++i) bits |= (rays.tfar[i] < 0.0f ? 1u : 0u) << i;
  return bits;
}

std::size_t RayScene::bytes() const {
  return std::size_t(std::max<ssize_t>(0, impl_->bytes));
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
