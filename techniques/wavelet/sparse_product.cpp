#include "techniques/wavelet/sparse_product.h"

#include <algorithm>
#include <cmath>

namespace penumbra::wavelet {

Function::Function(int edge, const std::vector<double>& texels) : n(edge) {
  for (int face = 0; face < 6; ++face) {
    const auto pixels = std::span(texels).subspan(std::size_t(face) * per_face(), std::size_t(per_face()));
    const auto c = haar::transform(pixels), m = haar::mean_pyramid(pixels);
    coefficients.insert(coefficients.end(), c.begin(), c.end());
    means.insert(means.end(), m.begin(), m.end());
  }
}

namespace {

/// Largest scores first; ties by position.
template <class Score>
std::vector<Term> keep_best(const Function& f, int count, Score score) {
  struct Scored {
    double score;
    Term term;
  };
  std::vector<Scored> all;
  all.reserve(f.coefficients.size());
  for (int face = 0; face < 6; ++face)
    for (int index = 1; index < f.per_face(); ++index) all.push_back({score(face, index), {face, index}});
  const auto kept = std::min(all.size(), std::size_t(count));
  const auto before = [](const Scored& a, const Scored& b) {
    if (a.score != b.score) return a.score > b.score;
    return a.term.face != b.term.face ? a.term.face < b.term.face : a.term.index < b.term.index;
  };
  std::partial_sort(all.begin(), all.begin() + std::ptrdiff_t(kept), all.end(), before);
  std::vector<Term> terms;
  for (std::size_t k = 0; k < kept; ++k) terms.push_back(all[k].term);
  return terms;
}

}  // namespace

std::vector<Term> keep_largest(const Function& f, int count, double gamma) {
  return keep_best(f, count, [&](int face, int index) {
    return std::abs(double(f.at(face, index))) * std::exp2(-gamma * haar::place_of(index).square.level);
  });
}

std::vector<Term> keep_largest_effect(const Function& p, std::span<const Function> light, int count) {
  return keep_best(p, count, [&](int face, int index) {
    const auto [s, a] = haar::place_of(index);
    double partners = 0.0;
    for (const Function& l : light) {
      for (int m = 0; m < 3; ++m) partners += std::abs(double(l.at(face, haar::coefficient_index(s, m))));
      partners += std::abs(double(l.mean(face, s))) * std::exp2(-s.level);
    }
    return std::abs(double(p.at(face, index))) * partners;
  });
}

Function times_kept(const Function& f, std::span<const Term> kept, std::vector<double> values) {
  std::vector<float> coefficients(f.coefficients.size(), 0.0f);
  const auto keep = [&](int face, int index) {
    coefficients[std::size_t(face) * f.per_face() + index] = f.at(face, index);
  };
  for (int face = 0; face < 6; ++face) keep(face, 0);
  for (const Term& t : kept) keep(t.face, t.index);
  const auto per_face = std::size_t(f.per_face());
  for (std::size_t face = 0; face < 6; ++face) {
    const auto texels = haar::inverse(std::span<const float>(coefficients).subspan(face * per_face, per_face));
    for (std::size_t k = 0; k < per_face; ++k) values[face * per_face + k] *= double(texels[k]);
  }
  return Function(f.n, values);
}

void Visibility::assign(const BitCube& blocked) {
  haar::transform_visibility(blocked, store);
  means.clear();
  const auto per_face = std::size_t(store.blocks_per_face());
  for (std::size_t face = 0; face < 6; ++face) {
    const auto m =
        haar::mean_pyramid_of_coefficients(std::span<const float>(store.level1).subspan(face * per_face, per_face));
    means.insert(means.end(), m.begin(), m.end());
  }
}

double inner_product(const Sparse& f, const Visibility& v) {
  Evaluate sink(v);
  inner_product(f.function, f.kept, sink);
  return sink.sum();
}

std::size_t Functional::bytes() const {
  return (std::size_t(channels) * slot.size() + level2.size()) * sizeof(float) + slot.size() * sizeof(std::int32_t);
}

Collect::Collect(int n, int channels) : n_(n), channels_(channels), slot_(std::size_t(6) * n * n / 16, -1) {
  for (int c = 0; c < channels; ++c) level1_[c].assign(slot_.size(), 0.0);
}

void Collect::coefficient(int face, int index, float weight) {
  const int per_face = n_ * n_ / 16;
  if (index < per_face) {
    level1_[channel_][std::size_t(face) * per_face + index] += double(weight);
    return;
  }
  const auto [s, mother] = haar::place_of(index);
  const int m = n_ / 4, deep = s.level - haar::levels_of(m);
  std::int32_t& slot = slot_[std::size_t(face) * per_face + (s.j >> deep) * m + (s.i >> deep)];
  const std::size_t size = std::size_t(channels_) * 16;
  if (slot < 0) {
    slot = std::int32_t(level2_.size() / size);
    level2_.resize(level2_.size() + size, 0.0);
  }
  const int local = haar::coefficient_index({deep, s.i & deep, s.j & deep}, mother);
  // haar::coefficient(): V's coefficient is -entry / 16 / m.
  level2_[std::size_t(slot) * size + std::size_t(channel_) * 16 + std::size_t(local)] -= double(weight) / (16.0 * m);
}

void Collect::mean(int face, haar::Square s, float weight) {
  coefficient(face, 0, weight);
  for (int level = 0; level < s.level; ++level) {  // psum(V, s) = scale + sum over ancestors of 2^l (+-V)
    const int up = s.level - level;
    const haar::Square over{level, s.i >> up, s.j >> up};
    const int qx = s.i >> (up - 1) & 1, qy = s.j >> (up - 1) & 1;
    for (int mother = 0; mother < 3; ++mother)
      coefficient(face, haar::coefficient_index(over, mother),
                  weight * float((1 << level) * haar::sign_of(mother, qx, qy)));
  }
}

Functional Collect::take() const {
  Functional f;
  f.n = n_;
  f.channels = channels_;
  for (int c = 0; c < channels_; ++c) f.level1[c].assign(level1_[c].begin(), level1_[c].end());
  f.slot = slot_;
  f.level2.assign(level2_.begin(), level2_.end());
  return f;
}

}  // namespace penumbra::wavelet
