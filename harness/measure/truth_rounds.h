// The truth's rounds: independent stratified estimates of every receiver, until their mean is known well enough.
//
// The mean of the rounds is the truth, and the variance of that mean is the rounds' over their number: the gain of
// stratification counts, and nothing is assumed of it.
//   environments   A round draws some sets of samples for every group of bases/normal_table.h, anew in each round, and
//                  each receiver takes one of its group's by a hash of itself and of the round: whom it shares a set
//                  with changes from round to round.
//                  What arrives unoccluded needs no rays, and a larger set tells it better. So a receiver's estimate is
//                    sum(weight V) / n - visible (sum(weight) / n - the larger set's),
//                  a control variate: its expectation is that of the first term, whatever number `visible` is.
//                  Rays per round differ. A pilot, five rounds of 32 rays, tells `visible`, the share of light that
//                  reaches a receiver, and the variance of packets of 16 neighbours. It is then thrown away, so neither
//                  mean nor variance depends on what it found. Of n strata the variance falls about as n^-1.5, so the
//                  least rays in all are those of n ~ (variance)^0.4.
//   lamps          Samples depend on the place: every receiver draws its own, 256 a round.
// A quick look, at 5 % of noise or more, gets by with rounds of 16 rays.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <map>

#include "harness/measure/reference.h"
#include "harness/measure/truth_samples.h"
#include "scenes/ray_scene.h"
#include "techniques/bases/normal_table.h"

namespace penumbra {

class TruthRounds {
 public:
  static constexpr int fewest = 8;

  /// `light`: the number of the frame's light among those of its scene, which tells their samples apart.
  TruthRounds(const Frame& frame, const ReferenceSettings& settings, std::size_t light, Reference& out);

  void round(int index);
  /// Writes mean, variance and unshadowed radiance so far.
  void finish();
  int most_rounds() const;
  /// Under environments rounds are few: one more may be enough.
  int rounds_to_next_look() const { return products_.empty() ? std::max(4, rounds_ / 4) : std::max(1, rounds_ / 8); }
  double rays_per_round() const;  ///< per receiver, in the mean

 private:
  /// Up to 16 receivers, neighbours of one group: order_[first] and on.
  struct Packet {
    int first, count, group;
    int rays;  ///< per receiver and round
  };
  /// What a group's receivers share in one round.
  struct Pools {
    std::map<int, std::vector<std::vector<LightSample>>> sets;  ///< by the number of their samples
    std::vector<LightSample> large;  ///< tells what arrives unoccluded; empty as long as nothing is known of visibility
    dvec3 open{0.0};                 ///< of a group of one normal: what arrives unoccluded
  };
  using Scratches = std::array<LightSampler::Scratch, RayPacket::size>;

  void gather();
  void allocate();
  void trace_all(std::uint64_t stream);
  void trace_lamp(const Packet& packet, std::uint64_t stream);
  void trace_group(int begin, int end, std::uint64_t stream);
  void trace_shared(const Packet& packet, const Pools& pools, std::uint64_t stream);
  Pools draw_pools(int begin, int end, std::uint64_t stream) const;
  void estimate(const Packet& packet, const LightSample* const* samples, vec3* estimates, dvec3* open) const;
  void add(int receiver, dvec3 value, dvec3 open);
  void run_pilot();
  void forget();
  double round_variance(const Packet& packet) const;

  const Frame& frame_;
  const ReferenceSettings settings_;
  Reference& out_;
  RayScene rays_;
  TruthSamples samples_;
  std::vector<int> order_;       ///< valid receivers, packet after packet
  std::vector<Packet> packets_;  ///< group after group
  std::vector<int> first_of_group_;
  std::vector<EnvironmentSampler::Product> products_;  ///< per group; none under a lamp
  std::vector<dvec3> sum_, squares_, open_;
  std::vector<vec3> visible_;  ///< share of what arrives that reaches a receiver; empty without a pilot
  tbb::enumerable_thread_specific<Scratches> scratches_;
  std::uint64_t light_;  ///< 0 for the first of a scene
  int rounds_ = 0;
};

}  // namespace penumbra
