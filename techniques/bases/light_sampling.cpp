#include "techniques/bases/light_sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes/ray_scene.h"
#include "techniques/bases/random.h"

namespace penumbra {
namespace {

/// Interleaves the bits of x and y: neighbours on the curve are neighbours on the sphere.
std::uint32_t morton(std::uint32_t x, std::uint32_t y) {
  std::uint32_t code = 0;
  for (int bit = 0; bit < 16; ++bit) code |= ((x >> bit & 1u) << (2 * bit)) | ((y >> bit & 1u) << (2 * bit + 1));
  return code;
}

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr LightSample black_sample = {{0, 1, 0}, infinity, vec3(0.0f)};

/// k samples, one in each of k equal strata of u.
template <class Sample>
void stratify(int k, std::uint64_t stream, std::vector<LightSample>& samples, const Sample& sample) {
  samples.resize(std::size_t(k));
  for (int i = 0; i < k; ++i) {
    const RandomTriple r = random_triple(stream, std::uint32_t(i));
    samples[i] = sample((double(i) + double(r.x)) / k, r.y, r.z);
  }
}

}  // namespace

EnvironmentSampler::EnvironmentSampler(const Environment& environment) : environment_(&environment) {
  const bool lat_long = environment.mapping == Mapping::lat_long;
  const int faces = lat_long ? 1 : 6, w = environment.width, h = environment.height / faces;
  const int edge = std::max(1, w / (lat_long ? 64 : 16));  // cells of about 5.6 degrees
  const int columns = (w + edge - 1) / edge, rows = (h + edge - 1) / edge;
  std::vector<std::pair<std::uint32_t, glm::ivec2>> order;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) order.emplace_back(morton(std::uint32_t(x), std::uint32_t(y)), glm::ivec2(x, y));
  std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (int face = 0; face < faces; ++face)
    for (const auto& [code, at] : order)
      add_cell(at.x * edge, std::min(w, (at.x + 1) * edge), face * h + at.y * edge,
               face * h + std::min(h, (at.y + 1) * edge));
}

void EnvironmentSampler::add_cell(int x0, int x1, int y0, int y1) {
  const Environment& e = *environment_;
  const Cell cell{int(texels_.size()), (x1 - x0) * (y1 - y0)};
  dvec3 axis(0.0);
  double sum = 0.0;
  for (int y = y0; y < y1; ++y)
    for (int i = 0; i < x1 - x0; ++i) {
      const int texel = y * e.width + (y & 1 ? x1 - 1 - i : x0 + i);  // back and forth
      texels_.push_back(texel);
      sum += double(luminance(e.radiance[texel])) * e.solid_angle(texel);
      cumulative_.push_back(sum);
      axis += dvec3(e.direction(texel, 0.5f, 0.5f));
    }
  if (sum <= 0.0) {  // black: never chosen
    texels_.resize(cell.first);
    cumulative_.resize(cell.first);
    return;
  }
  const vec3 unit(glm::normalize(axis));
  float cosine = 1.0f;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      if (x != x0 && x != x1 - 1 && y != y0 && y != y1 - 1) continue;  // the rim bounds the cell
      for (int corner = 0; corner < 4; ++corner)
        cosine = std::min(cosine, glm::dot(unit, e.direction(y * e.width + x, float(corner & 1), float(corner >> 1))));
    }
  cosine = std::max(-1.0f, cosine - 1e-6f);
  cells_.push_back(cell);
  axis_x_.push_back(unit.x), axis_y_.push_back(unit.y), axis_z_.push_back(unit.z);
  cos_radius_.push_back(cosine), sin_radius_.push_back(std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)));
  energy_.push_back(float(sum));
}

void EnvironmentSampler::make_product(const Cone& normals, Product& product) const {
  product.normals = normals;
  product.cumulative.resize(cells_.size());
  const vec3 axis = normals.axis;
  double sum = 0.0;
  for (std::size_t k = 0; k < cells_.size(); ++k) {  // the largest cosine between the two cones
    const float c = axis.x * axis_x_[k] + axis.y * axis_y_[k] + axis.z * axis_z_[k];
    const float s = std::sqrt(std::max(0.0f, 1.0f - c * c));
    const float cos_reach = cos_radius_[k] * normals.cosine - sin_radius_[k] * normals.sine;
    const float sin_reach = sin_radius_[k] * normals.cosine + cos_radius_[k] * normals.sine;
    const bool overlap = c >= cos_reach || sin_reach < 0.0f;  // below 0: together more than half a turn
    const float nearest = overlap ? 1.0f : c * cos_reach + s * sin_reach;
    sum += double(energy_[k] * std::max(0.0f, nearest));
    product.cumulative[k] = sum;
  }
}

EnvironmentSampler::Choice EnvironmentSampler::choose(const Product& product, double u, float v, float w) const {
  const double total = product.total();
  const auto& sums = product.cumulative;
  const double target = std::min(u * total, std::nextafter(total, 0.0));
  const auto k = std::size_t(std::upper_bound(sums.begin(), sums.end(), target) - sums.begin());
  const double before = k ? sums[k - 1] : 0.0, cell_weight = sums[k] - before;

  const Cell& cell = cells_[k];
  const auto first = cumulative_.begin() + cell.first, last = first + cell.count;
  const double cell_energy = *(last - 1);
  const double inside = std::min((target - before) / cell_weight * cell_energy, std::nextafter(cell_energy, 0.0));
  const auto at = std::upper_bound(first, last, inside);
  const double texel_energy = *at - (at == first ? 0.0 : *(at - 1));

  Choice choice{texels_[std::size_t(at - cumulative_.begin())], {}, 0.0};
  float density;  // per sr within the texel
  choice.direction = environment_->direction(choice.texel, v, w, &density);
  choice.pdf = cell_weight / total * (texel_energy / cell_energy) * double(density);
  return choice;
}

LightSample EnvironmentSampler::sample(const Product& product, double u, float v, float w) const {
  if (!(product.total() > 0.0)) return black_sample;
  const Choice choice = choose(product, u, v, w);
  const float cosine = std::max(0.0f, glm::dot(product.normals.axis, choice.direction));
  return {choice.direction, infinity, environment_->radiance[choice.texel] * float(double(cosine) / (pi * choice.pdf))};
}

LightSample EnvironmentSampler::shared_sample(const Product& product, double u, float v, float w) const {
  if (!(product.total() > 0.0)) return black_sample;
  const Choice choice = choose(product, u, v, w);
  return {choice.direction, infinity, environment_->radiance[choice.texel] * float(1.0 / (pi * choice.pdf))};
}

vec3 EnvironmentSampler::unshadowed(vec3 normal) const {
  dvec3 sum(0.0);
  for (const int texel : texels_) {
    const float cosine = glm::dot(normal, environment_->direction(texel, 0.5f, 0.5f));
    if (cosine > 0.0f)
      sum += dvec3(environment_->radiance[texel]) * (double(cosine) * environment_->solid_angle(texel));
  }
  return vec3(sum / pi);
}

std::size_t EnvironmentSampler::bytes() const {
  return cells_.size() * (sizeof(Cell) + 6 * sizeof(float)) + texels_.size() * (sizeof(int) + sizeof(double));
}

LightSample sample_point(const AreaLight& light, vec3 to_light, vec3 normal) {
  const float distance2 = glm::dot(to_light, to_light);
  if (distance2 == 0.0f) return {normal, 0.0f, vec3(0.0f)};
  const float distance = std::sqrt(distance2);
  const vec3 direction = to_light / distance;
  const float receiver_cosine = std::max(0.0f, glm::dot(normal, direction));
  const float light_cosine = std::max(0.0f, -glm::dot(light.normal, direction));
  const double geometry = light.area() * double(receiver_cosine * light_cosine) / (pi * double(distance2));
  return {direction, distance, vec3(float(geometry))};
}

LightSample sample_area(const AreaLight& light, vec3 position, vec3 normal, float u, float v) {
  LightSample sample = sample_point(light, light.point(u, v) - position, normal);
  sample.weight *= light.radiance;
  return sample;
}

LightSampler::LightSampler(const Light& light) : area_(area_light_of(light)) {
  if (const Environment* environment = environment_of(light)) environment_ = EnvironmentSampler(*environment);
}

void LightSampler::draw(vec3 position, vec3 normal, int k, std::uint64_t stream, Scratch& scratch) const {
  if (!area_) {
    if (scratch.product.cumulative.empty() || scratch.product.normals.axis != normal)
      environment_.make_product({normal, 0.0f, 1.0f}, scratch.product);
    return stratify(k, stream, scratch.samples,
                    [&](double u, float v, float w) { return environment_.sample(scratch.product, u, v, w); });
  }
  scratch.samples.resize(std::size_t(k));
  const RandomTriple shift = random_triple(stream, ~0u);
  for (int i = 0; i < k; ++i) {
    const vec2 at = shifted_hammersley(i, k, shift);
    scratch.samples[i] = sample_area(*area_, position, normal, at.x, at.y);
  }
}

void LightSampler::draw_shared(const EnvironmentSampler::Product& product, int k, std::uint64_t stream,
                               std::vector<LightSample>& samples) const {
  stratify(k, stream, samples,
           [&](double u, float v, float w) { return environment_.shared_sample(product, u, v, w); });
}

void LightSampler::face(std::span<const LightSample> shared, vec3 normal, std::vector<LightSample>& own) {
  own.resize(shared.size());
  for (std::size_t i = 0; i < shared.size(); ++i) {
    const float cosine = std::max(0.0f, glm::dot(normal, shared[i].direction));
    own[i] = {shared[i].direction, shared[i].distance, cosine * shared[i].weight};
  }
}

void LightSampler::normalise(vec3 unshadowed, std::vector<LightSample>& samples) {
  dvec3 sum(0.0);
  for (const LightSample& s : samples) sum += dvec3(s.weight);
  const dvec3 exact = dvec3(unshadowed) * double(samples.size());
  for (int c = 0; c < 3; ++c)
    if (sum[c] > 0.0)
      for (LightSample& s : samples) s.weight[c] *= float(exact[c] / sum[c]);
}

vec3 estimate_radiance(const RayScene& rays, vec3 origin, const std::vector<LightSample>& samples) {
  dvec3 sum(0.0);
  for (const LightSample& s : samples)
    if (s.weight != vec3(0.0f) && !rays.occluded(origin, s.direction, s.reach())) sum += dvec3(s.weight);
  return vec3(sum / double(samples.size()));
}

}  // namespace penumbra
