#include "harness/measure/truth_rounds.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "harness/measure/interrupt.h"
#include "harness/results/metrics.h"
#include "techniques/bases/blocked.h"
#include "techniques/bases/random.h"
#include "techniques/bases/ray_packets.h"

namespace penumbra {
namespace {

constexpr double quick = 0.05;            // of noise or more
constexpr int rays_of_quick_rounds = 16;  // per receiver
constexpr int rays_under_lamps = 256;
constexpr int rays_of_pilot = 32;
constexpr int rounds_for_visibility = 2, rounds_for_variance = 3;  // of the pilot
constexpr int wanted_rounds = 12;
constexpr int large_of_one_normal = 1 << 16, large_of_a_cone = 1 << 11;  // samples

/// Its upper half tells rounds apart; receivers are told apart by the lower one.
std::uint64_t stream_of(int round) {
  return std::uint64_t(std::uint32_t(round)) << 32;
}
std::uint64_t pilot_stream(int round) {
  return stream_of(~round);
}

/// The mean of the samples as one normal sees them.
dvec3 open_to(const std::vector<LightSample>& shared, vec3 normal) {
  constexpr std::size_t block = 64;  // few enough for sums of floats
  dvec3 sum(0.0);
  for (std::size_t first = 0; first < shared.size(); first += block) {
    vec3 part(0.0f);
    for (std::size_t i = first; i < std::min(shared.size(), first + block); ++i)
      part += std::max(0.0f, glm::dot(normal, shared[i].direction)) * shared[i].weight;
    sum += dvec3(part);
  }
  return sum / double(shared.size());
}

double share_of(double part, double whole) {
  return whole > 0.0 ? std::clamp(part / whole, 0.0, 1.0) : 0.0;
}

}  // namespace

TruthRounds::TruthRounds(const Frame& frame, const ReferenceSettings& settings, std::size_t light, Reference& out)
    : frame_(frame),
      settings_(settings),
      out_(out),
      rays_(frame.mesh),
      samples_(frame.light),
      sum_(out.mean.pixels.size(), dvec3(0.0)),
      squares_(sum_),
      open_(sum_),
      light_(light) {
  gather();
  if (!products_.empty() && settings.truth_noise < quick) allocate();
}

/// Orders the receivers group by group, neighbours together, and cuts them into packets.
void TruthRounds::gather() {
  const Receivers& r = frame_.receivers;
  NormalTable table;
  if (environment_of(frame_.light)) table = NormalTable::of(r.normal);
  else table.index.assign(r.normal.size(), 0), table.cones.resize(1);
  for (const int i : tile_order(r.width, r.height))
    if (r.valid(i)) order_.push_back(i);
  std::stable_sort(order_.begin(), order_.end(), [&](int a, int b) { return table.index[a] < table.index[b]; });

  const int rays = settings_.truth_noise >= quick ? rays_of_quick_rounds : rays_under_lamps;
  for (int k = 0; k < int(order_.size()); ++k) {
    const int group = table.index[order_[k]];
    if (packets_.empty() || packets_.back().group != group) first_of_group_.push_back(int(packets_.size()));
    if (packets_.empty() || packets_.back().group != group || packets_.back().count == RayPacket::size)
      packets_.push_back({k, 0, group, rays});
    ++packets_.back().count;
  }
  first_of_group_.push_back(int(packets_.size()));
  if (!environment_of(frame_.light)) return;
  products_.resize(table.cones.size());
  tbb::parallel_for(std::size_t(0), products_.size(),
                    [&](std::size_t k) { samples_.make_product(table.cones[k], products_[k]); });
}

void TruthRounds::forget() {
  std::fill(sum_.begin(), sum_.end(), dvec3(0.0));
  squares_ = open_ = sum_;
  rounds_ = 0;
}

/// Leaves `visible_` and, as the rounds so far, what tells their variance.
void TruthRounds::run_pilot() {
  for (Packet& packet : packets_) packet.rays = rays_of_pilot;
  int next = 0;
  for (; next < rounds_for_visibility; ++next) trace_all(pilot_stream(next));
  visible_.assign(sum_.size(), vec3(0.0f));
  for (const int i : order_)
    for (int c = 0; c < 3; ++c) visible_[i][c] = float(share_of(sum_[i][c], open_[i][c]));
  forget();
  for (; rounds_ < rounds_for_variance; ++rounds_) trace_all(pilot_stream(next + rounds_));
  finish();
}

/// Gives every packet its rays a round.
void TruthRounds::allocate() {
  run_pilot();
  const double wanted = settings_.truth_noise * rms(out_.mean, valid_receivers(frame_.receivers));
  std::vector<double> variance;
  double mean = 0.0, sum = 0.0;
  for (const Packet& packet : packets_) {
    variance.push_back(round_variance(packet));
    mean += variance.back() * packet.count / double(order_.size());
  }
  // A pilot sees little: where it saw no variance, a tenth of the mean is taken for it.
  for (std::size_t k = 0; k < packets_.size(); ++k)
    sum += packets_[k].count * std::pow(variance[k] = 0.9 * variance[k] + 0.1 * mean, 0.4);
  // Rounds of n = s variance^0.4 rays leave sum(variance (n / rays_of_pilot)^-1.5) / rounds = wanted^2 receivers.
  const double allowed = wanted * wanted * double(order_.size()) * wanted_rounds;
  const double scale = allowed > 0.0 ? rays_of_pilot * std::pow(sum / allowed, 2.0 / 3.0) : 0.0;
  const int most = std::clamp(settings_.most_rays / fewest, rays_of_quick_rounds, 2048);
  for (std::size_t k = 0; k < packets_.size(); ++k) {
    const double rays = std::clamp(scale * std::pow(variance[k], 0.4), double(rays_of_quick_rounds), double(most));
    packets_[k].rays = std::min(most, 1 << int(std::lround(std::log2(rays))));
  }
  forget();
}

/// Of one round, mean over the packet's receivers and channels.
double TruthRounds::round_variance(const Packet& packet) const {
  double sum = 0.0;
  for (int k = packet.first; k < packet.first + packet.count; ++k) {
    const vec3 v = out_.variance.pixels[order_[k]];
    sum += double(v.x) + double(v.y) + double(v.z);
  }
  return sum * rounds_ / (3.0 * packet.count);
}

void TruthRounds::round(int index) {
  trace_all(stream_of(index));
  ++rounds_;
}

int TruthRounds::most_rounds() const {
  return std::max(fewest, int(double(settings_.most_rays) / std::max(1.0, rays_per_round())));
}

double TruthRounds::rays_per_round() const {
  double sum = 0.0;
  for (const Packet& packet : packets_) sum += double(packet.rays) * packet.count;
  return sum / std::max(1.0, double(order_.size()));
}

void TruthRounds::trace_all(std::uint64_t stream) {
  if (light_ > 0) stream = stream_of(int(mix_bits(stream ^ light_) >> 32));  // lights are sampled independently
  if (products_.empty())
    tbb::parallel_for(std::size_t(0), packets_.size(), [&](std::size_t k) { trace_lamp(packets_[k], stream); });
  else
    tbb::parallel_for(std::size_t(1), first_of_group_.size(), [&](std::size_t k) {
      if (!interrupted()) trace_group(first_of_group_[k - 1], first_of_group_[k], stream);
    });
  stop_if_interrupted();
}

void TruthRounds::trace_lamp(const Packet& packet, std::uint64_t stream) {
  if (interrupted()) return;
  Scratches& scratch = scratches_.local();
  const LightSample* samples[RayPacket::size];
  for (int k = 0; k < packet.count; ++k) {
    const int i = order_[packet.first + k];
    samples_.draw(frame_.receivers.position[i], frame_.receivers.normal[i], packet.rays,
                  mix_bits(stream | std::uint32_t(i)), scratch[k]);
    samples[k] = scratch[k].samples.data();
  }
  vec3 estimates[RayPacket::size];
  dvec3 open[RayPacket::size];
  estimate(packet, samples, estimates, open);
  for (int k = 0; k < packet.count; ++k) add(order_[packet.first + k], dvec3(estimates[k]), open[k]);
}

/// Draws what the packets of a group share, and traces them.
void TruthRounds::trace_group(int begin, int end, std::uint64_t stream) {
  const Pools pools = draw_pools(begin, end, stream);
  tbb::parallel_for(begin, end, [&](int k) {
    if (!interrupted()) trace_shared(packets_[k], pools, stream);
  });
}

TruthRounds::Pools TruthRounds::draw_pools(int begin, int end, std::uint64_t stream) const {
  Pools pools;
  std::map<int, int> members;  // by rays
  for (int k = begin; k < end; ++k) members[packets_[k].rays] += packets_[k].count;
  const auto group = std::size_t(packets_[begin].group);
  const auto draw = [&](int rays, std::size_t set, std::vector<LightSample>& samples) {
    const std::uint64_t own = std::uint64_t(group) << 40 | std::uint64_t(rays) << 20 | set;
    samples_.draw_shared(products_[group], rays, mix_bits(stream ^ mix_bits(own)), samples);
  };
  for (const auto& [rays, count] : members) {
    auto& sets = pools.sets[rays];
    sets.resize(std::size_t(std::min(count, std::clamp(count / 8, 8, 256))));
    tbb::parallel_for(std::size_t(0), sets.size(), [&, rays = rays](std::size_t set) { draw(rays, set, sets[set]); });
  }
  if (visible_.empty()) return pools;
  const Cone& normals = products_[group].normals;
  draw(one_normal(normals) ? large_of_one_normal : large_of_a_cone, 0xfffff, pools.large);
  if (one_normal(normals)) pools.open = open_to(pools.large, normals.axis);
  return pools;
}

void TruthRounds::trace_shared(const Packet& packet, const Pools& pools, std::uint64_t stream) {
  Scratches& scratch = scratches_.local();
  const auto& sets = pools.sets.at(packet.rays);
  const LightSample* samples[RayPacket::size];
  for (int k = 0; k < packet.count; ++k) {
    const int i = order_[packet.first + k];
    const auto& set = sets[mix_bits(stream | std::uint32_t(i)) % sets.size()];
    LightSampler::face(set, frame_.receivers.normal[i], scratch[k].samples);
    samples[k] = scratch[k].samples.data();
  }
  vec3 estimates[RayPacket::size];
  dvec3 open[RayPacket::size];
  estimate(packet, samples, estimates, open);
  for (int k = 0; k < packet.count; ++k) {
    const int i = order_[packet.first + k];
    if (visible_.empty()) {
      add(i, dvec3(estimates[k]), open[k]);
      continue;
    }
    const bool one = one_normal(products_[packet.group].normals);
    const dvec3 better = one ? pools.open : open_to(pools.large, frame_.receivers.normal[i]);
    add(i, dvec3(estimates[k]) - dvec3(visible_[i]) * (open[k] - better), better);
  }
}

/// Of every receiver of a packet: what its samples bring, and what they would if nothing were in the way.
void TruthRounds::estimate(const Packet& packet, const LightSample* const* samples, vec3* estimates,
                           dvec3* open) const {
  const auto count = std::size_t(packet.count);
  const std::span<const int> which(&order_[packet.first], count);
  estimate_packet(rays_, frame_.receivers, which, {samples, count}, packet.rays, estimates);
  for (std::size_t k = 0; k < count; ++k) {
    open[k] = dvec3(0.0);
    for (int j = 0; j < packet.rays; ++j) open[k] += dvec3(samples[k][j].weight);
    open[k] /= double(packet.rays);
  }
}

void TruthRounds::add(int receiver, dvec3 value, dvec3 open) {
  sum_[receiver] += value;
  squares_[receiver] += value * value;
  open_[receiver] += open;
}

void TruthRounds::finish() {
  out_.rays_per_receiver = int(std::lround(double(rounds_) * rays_per_round()));
  for (const int i : order_) {
    const dvec3 mean = sum_[i] / double(rounds_), albedo(frame_.receivers.albedo[i]);
    const dvec3 spread = glm::max(dvec3(0.0), squares_[i] / double(rounds_) - mean * mean);
    out_.mean.pixels[i] = vec3(albedo * mean);
    out_.variance.pixels[i] = vec3(albedo * albedo * spread / double(rounds_ - 1));
    out_.unshadowed.pixels[i] = vec3(albedo * open_[i] / double(rounds_));
  }
}

}  // namespace penumbra
