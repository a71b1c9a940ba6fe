// What the wavelet techniques share: V is found in bits, transformed to the Haar basis and multiplied with what a
// technique precomputes for each normal under the light, its plan.
//
// Per frame: OR the spheres' bits, transform V through the 4 x 4 table, multiply in the Haar basis.
//
// The solid angle goes into L, as N dw (N pixels a face), so that V stays binary and the ranking sees energy. V is
// taken as open in lines (half faces) that lie wholly below the receiver's horizon: p is 0 there, and nothing need be
// looked up.
//   scalar: the paper's CPU version, a receiver and a channel at a time.
//   simd:   B is linear in V, so the loops over L and p run once per normal and light into a functional of V
//           (sparse_product.h); receivers then share it, sixteen at a time.
//
// A plan serves one normal. Where there are more than a few, what is below the horizon is hidden in V, and the cosine,
// linear in the normal elsewhere, comes last: B = N . <L w, V>, nine functions of the light, three channels by three
// axes, for receivers of any normal.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>

#include "techniques/bases/distinct_normals.h"
#include "techniques/bases/visibility_source.h"
#include "techniques/wavelet/sparse_product.h"

namespace penumbra::wavelet {

/// Shades a receiver and a channel at a time; other backends are built upon the techniques that derive from it. A
/// `Plan` has `functions` functions; a technique holds `Plan::of_light` more.
template <class Plan>
class HaarLighting : public Technique {
 public:
  HaarLighting(const Parameters& p, const std::string& name)
      : visibility_(p, name),
        n_(visibility_.resolution()),
        all_(6 * n_ * n_),
        table_normals_(p.text("normals") == "table") {}

  void prepare(const Scene& scene, const Light& light) override {
    visibility_.prepare(scene);
    set_light(light);
    set_receivers(scene.receivers);
  }

  void update(const Frame& frame) override {
    visibility_.update(frame);
    receivers_ = &frame.receivers;
    if (frame.changed.light) set_light(frame.light);
    if (frame.changed.light || frame.changed.receivers) set_receivers(frame.receivers);
  }

  void shade(View<vec3> radiance) override {
    Visibility v;
    for (int i = 0; i < receivers_->size(); ++i) {
      radiance[i] = vec3(0.0f);
      if (!receivers_->valid(i)) continue;
      BitCube blocked(n_);
      visibility_.find_blocked(i, blocked);
      if (few()) {
        const std::uint64_t active = active_[plan_of_.index[i]];
        for (std::size_t w = 0; w < blocked.words.size(); ++w)
          if (!(active >> (w / words_per_line) & 1u)) blocked.words[w] = 0;
      } else {
        for (int t = 0; t < all_; ++t)
          if (dot_in_order(receivers_->normal[i], visibility_.directions()[t]) <= 0.0f) blocked.set(t);
      }
      v.assign(blocked);
      for (int c = 0; c < 3; ++c) {
        const double sum =
            few() ? multiply(plans_[plan_of_.index[i]], c, v) : multiply_by_axes(receivers_->normal[i], c, v);
        radiance[i][c] = receivers_->albedo[i][c] * float(sum);
      }
    }
  }

  Footprint footprint() const override {
    Footprint bytes = visibility_.footprint();
    const std::size_t function = std::size_t(all_) * sizeof(float) * 7 / 3;  // coefficients and mean pyramid
    bytes.tables += haar::binary_table().bytes();
    bytes.per_scene += (Plan::of_light + plans_.size() * Plan::functions + by_axis_.size()) * function;
    return bytes;
  }

 protected:
  /// Are there plans, few enough normals, or the light's nine functions?
  bool few() const { return plan_of_.few() || receivers_->size() == 0; }

  /// Takes in a new light, as far as it does not depend on normals.
  virtual void light_changed() {}
  /// Takes in new plans.
  virtual void plans_changed() {}
  virtual Plan make_plan(vec3 normal) const = 0;
  /// Returns a channel of the product with V, at albedo 1.
  virtual double multiply(const Plan& plan, int c, const Visibility& v) const = 0;
  /// Adds the weights of V in that product to `sink`.
  virtual void collect(const Plan& plan, int c, Collect& sink) const = 0;

  /// A channel of the light times an axis of the direction, over pi, and what is kept of it.
  virtual Sparse light_by_axis(int c, int axis) const = 0;

  /// Of three channels per plan; or, if there are no plans, one of nine, channel by channel and axis by axis.
  std::vector<Functional> make_functionals() const {
    std::vector<Functional> all(few() ? plans_.size() : 1);
    if (few())
      tbb::parallel_for(std::size_t(0), plans_.size(), [&](std::size_t k) {
        Collect sink(n_);
        for (int c = 0; c < 3; ++c) sink.set_channel(c), collect(plans_[k], c, sink);
        all[k] = sink.take();
      });
    else all[0] = functional_by_axis();
    return all;
  }

  std::uint64_t lines_above(vec3 normal) const { return lines_above_horizon(visibility_.cones(), normal); }
  /// Returns max(0, N . w) / pi by texel.
  std::vector<double> cosine_lobe(vec3 normal) const {
    std::vector<double> lobe;
    for (const vec3& w : visibility_.directions()) lobe.push_back(std::max(0.0, double(glm::dot(normal, w))) / pi);
    return lobe;
  }
  /// Returns the values times L N dw of a channel.
  Function times_light(std::vector<double> values, int c) const {
    for (int t = 0; t < all_; ++t) values[t] *= double(light_.radiance[t][c]) * double(light_.solid_angle[t]) * n_ * n_;
    return Function(n_, values);
  }
  Function light_function(int c) const { return times_light(std::vector<double>(all_, 1.0), c); }
  /// Returns an axis of the directions over pi, by texel.
  std::vector<double> axis_lobe(int axis) const {
    std::vector<double> values;
    for (const vec3& w : visibility_.directions()) values.push_back(double(w[axis]) / pi);
    return values;
  }

  VisibilitySource visibility_;
  int n_, all_;
  const Receivers* receivers_ = nullptr;
  std::vector<vec3> normals_;  ///< per receiver, as used: exact, or the nearest entry of the 6 x 8 x 8 table
  DistinctNormals plan_of_;
  std::vector<Plan> plans_;
  std::vector<std::uint64_t> active_;  ///< lines above the horizon, per plan

 private:
  void set_light(const Light& light) {
    light_ = CubeLight(*environment_of(light), n_);
    light_changed();
  }

  void set_receivers(const Receivers& receivers) {
    receivers_ = &receivers;
    normals_ = receivers.normal;
    if (table_normals_)
      for (vec3& n : normals_)
        if (n != vec3(0.0f)) n = cube_texel_direction(cube_texel(n, 8), 8);
    // And the zero normal of pixels that show nothing.
    plan_of_ = DistinctNormals::of(normals_, (table_normals_ ? table_entries : most_exact) + 1);
    plans_.resize(plan_of_.normals.size()), active_.resize(plans_.size());
    tbb::parallel_for(std::size_t(0), plans_.size(), [&](std::size_t k) {
      plans_[k] = make_plan(plan_of_.normals[k]);
      active_[k] = lines_above(plan_of_.normals[k]);
    });
    by_axis_.clear();
    for (int k = 0; k < 9 && !few(); ++k) by_axis_.push_back(light_by_axis(k / 3, k % 3));
    plans_changed();
  }

  double multiply_by_axes(vec3 normal, int c, const Visibility& v) const {
    double sum = 0.0;
    for (int axis = 0; axis < 3; ++axis)
      sum += double(normal[axis]) * inner_product(by_axis_[std::size_t(c) * 3 + std::size_t(axis)], v);
    return sum;
  }

  Functional functional_by_axis() const {
    Collect sink(n_, 9);
    for (int k = 0; k < 9; ++k) {
      sink.set_channel(k);
      inner_product(by_axis_[std::size_t(k)].function, by_axis_[std::size_t(k)].kept, sink);
    }
    return sink.take();
  }

  /// Of the published table of normals; and of normals that are not worth more than plans of their own.
  static constexpr std::size_t table_entries = 6 * 8 * 8, most_exact = 8;

  bool table_normals_;
  std::vector<Sparse> by_axis_;  ///< light_by_axis() of all channels and axes; empty if there are plans
  CubeLight light_;
};

}  // namespace penumbra::wavelet
