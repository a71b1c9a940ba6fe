#include "techniques/bases/visibility_source.h"

#include "scenes/error.h"

namespace penumbra {

std::vector<Parameter> VisibilitySource::parameters() {
  return {choice_parameter("visibility", {"table", "fine", "raster", "rays"},
                           "spheres through the published table or a finer one, their exact caps, or rays at the mesh"),
          choice_parameter("resolution", {32, 16, 64}, "texels along a cube face edge"),
          choice_parameter("bins", {"angle", "ratio"},
                           "radius bins of visibility=table: uniform in the angle or in R / d")};
}

std::vector<Knob> VisibilitySource::knobs() {
  return {{"visibility", {"table", "fine", "raster"}}, {"resolution", {16, 32}}};
}

VisibilitySource::VisibilitySource(const Parameters& p, const std::string& owner)
    : kind_(p.text("visibility") == "rays"     ? Kind::rays
            : p.text("visibility") == "raster" ? Kind::raster
                                               : Kind::table),
      n_(p.integer("resolution")),
      shape_(p.text("visibility") == "fine"
                 ? SphereTable::fine(n_)
                 : SphereTable::published(
                       n_, p.text("bins") == "angle" ? RadiusBins::uniform_angle : RadiusBins::uniform_ratio)) {
  if (kind_ == Kind::table && n_ > 32)
    throw Error("{}: sphere tables exist at resolution 16 and 32, not {}; use visibility=raster", owner, n_);
  for (int t = 0; t < 6 * n_ * n_; ++t) directions_.push_back(cube_texel_direction(t, n_));
  cones_.assign(n_, directions_);
}

void VisibilitySource::prepare(const Scene& scene) {
  if (kind_ != Kind::rays && scene.spheres.empty()) throw Unsupported("the scene has no spheres");
  if (kind_ == Kind::rays) rays_.build(scene.mesh);
  if (kind_ == Kind::table && !table_) table_.emplace(shape_);
  receivers_ = &scene.receivers;
  spheres_ = &scene.spheres;
  lanes_.assign(scene.spheres);
  order_ = tile_order(scene.receivers.width, scene.receivers.height);
}

void VisibilitySource::update(const Frame& frame) {
  receivers_ = &frame.receivers;
  spheres_ = &frame.spheres;
  if (frame.changed.mesh && kind_ == Kind::rays) rays_.build(frame.mesh);
  if (frame.changed.spheres) lanes_.assign(frame.spheres);
  if (frame.changed.receivers) order_ = tile_order(frame.receivers.width, frame.receivers.height);
}

void VisibilitySource::find_blocked(int i, BitCube& blocked) const {
  const vec3 x = receivers_->position[i];
  if (kind_ == Kind::rays)
    return trace_texels(rays_, receivers_->ray_origin(i), receivers_->normal[i], directions_, false, blocked);
  if (receivers_->on_occluder[i]) return;  // an object's own spheres swallow its surface
  if (kind_ == Kind::raster) return rasterise_spheres(*spheres_, x, directions_, blocked);
  merge_spheres(*table_, *spheres_, x, directions_, blocked);
}

BlockedJob VisibilitySource::job() const {
  return {receivers_,   &lanes_, &cones_, table_ ? &*table_ : nullptr, kind_ == Kind::rays ? &rays_ : nullptr,
          &directions_, &order_};
}

Footprint VisibilitySource::footprint() const {
  return {table_ ? table_->bytes() : 0, rays_.bytes() + directions_.size() * 2 * sizeof(vec3),
          lanes_.x.size() * sizeof(Sphere)};
}

}  // namespace penumbra
