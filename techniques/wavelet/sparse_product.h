// Products of light, BRDF and visibility in the Haar basis, over truncated lists (Zhao & Che 2011, section 3.5).
//
// The loops are written once, against a sink: evaluating a receiver, the sink multiplies each weight with the
// receiver's coefficient of V; building a functional, it collects the weights, since the result is linear in V.
#pragma once

#include <span>
#include <vector>

#include "scenes/math.h"
#include "techniques/bases/haar.h"

namespace penumbra::wavelet {

/// A function on the six faces: coefficients (6 N) and mean pyramids (6 of pyramid_size) by face.
struct Function {
  int n = 0;
  std::vector<float> coefficients, means;

  Function() = default;
  /// From 6 n n texels; computed in double.
  Function(int edge, const std::vector<double>& texels);

  int per_face() const { return n * n; }
  float at(int face, int index) const { return coefficients[std::size_t(face) * per_face() + index]; }
  float mean(int face, haar::Square s) const {
    const int size = haar::pyramid_size(haar::levels_of(n));
    return means[std::size_t(face) * size + haar::pyramid_index(s)];
  }
};

/// A wavelet of a face; never the scale.
struct Term {
  int face, index;
};

/// The `count` wavelets with the largest |c| 2^(-gamma l), largest first; ties by position. Scales are not among them:
/// they are always used. gamma = 0 is L2-optimal, 1 weighs by area (Ng et al. 2003).
std::vector<Term> keep_largest(const Function& f, int count, double gamma);

/// The `count` terms of p that matter most under a light, by the size of what the p loop does with them: p L psum(V)
/// and, with wavelets of V taken as 2^-level, p V psum(L) and case 2. A dim lobe over a bright lamp is then kept.
std::vector<Term> keep_largest_effect(const Function& p, std::span<const Function> light, int count);

/// What the scales and the kept wavelets of f are at each texel, times a value for each.
Function times_kept(const Function& f, std::span<const Term> kept, std::vector<double> values);

/// Which coefficients of V a product may look at: only level 1 of the two-level store (GPU-I), or both (GPU-II).
PENUMBRA_HD inline bool in_level1(int n, int index) {
  return index < n * n / 16;
}

/// Which levels of V the two loops see. The paper's p loop sees level 1 alone.
struct Levels {
  int light = 2, p = 1;
};

/// psum(V) of level 1 exists down to the 4 x 4 blocks; finer squares use the block they lie in.
PENUMBRA_HD inline haar::Square within_level1(int n, haar::Square s) {
  const int block_level = haar::levels_of(n) - 2, deeper = s.level - block_level, up = deeper > 0 ? deeper : 0;
  return {s.level - up, s.i >> up, s.j >> up};
}

/// What one kept term of p adds, and (add_light_term) one of L: case 2 and case 3 of the theorem. `P` and `L` have
/// at(), mean() and n, as Function. Calls sink.coefficient(face, index, weight) for weight * V_index and
/// sink.mean(face, square, weight) for weight * psum(V, square).
template <class P, class L, class Sink>
PENUMBRA_HD void add_p_term(const P& p, const L& light, Term t, Levels levels, Sink& sink) {
  const auto visible = [&](int level) { return level == 2 || in_level1(p.n, t.index); };
  const auto [s, a] = haar::place_of(t.index);
  const int b = haar::coefficient_index(s, (a + 1) % 3), c = haar::coefficient_index(s, (a + 2) % 3);
  const float pa = p.at(t.face, t.index);
  if (visible(levels.light)) {  // case 2: same square, three types
    sink.coefficient(t.face, c, float(1 << s.level) * pa * light.at(t.face, b));
    sink.coefficient(t.face, b, float(1 << s.level) * pa * light.at(t.face, c));
  }
  const haar::Square seen = levels.p == 2 ? s : within_level1(p.n, s);
  sink.mean(t.face, seen, pa * light.at(t.face, t.index));                               // case 3: p L psum(V)
  if (visible(levels.p)) sink.coefficient(t.face, t.index, pa * light.mean(t.face, s));  // p V psum(L)
}
template <class P, class L, class Sink>
PENUMBRA_HD void add_light_term(const P& p, const L& light, Term t, Levels levels, Sink& sink) {
  if (levels.light == 2 || in_level1(p.n, t.index))  // case 3: L V psum(p)
    sink.coefficient(t.face, t.index, light.at(t.face, t.index) * p.mean(t.face, haar::place_of(t.index).square));
}

/// Sparse, asymmetric triple product: loops over the kept terms of p and L, everything else from the complete stores.
template <class Sink>
void triple_product(const Function& p, const Function& light, std::span<const Term> kept_p,
                    std::span<const Term> kept_light, Levels levels, Sink& sink) {
  for (int face = 0; face < 6; ++face) sink.coefficient(face, 0, p.at(face, 0) * light.at(face, 0));  // case 1
  for (const Term& t : kept_p) add_p_term(p, light, t, levels, sink);
  for (const Term& t : kept_light) add_light_term(p, light, t, levels, sink);
}

/// A function and the wavelets of it that are kept.
struct Sparse {
  Function function;
  std::vector<Term> kept;
};

/// Inner product of the kept terms of f with V.
template <class Sink>
void inner_product(const Function& f, std::span<const Term> kept, Sink& sink) {
  for (int face = 0; face < 6; ++face) sink.coefficient(face, 0, f.at(face, 0));
  for (const Term& t : kept) sink.coefficient(t.face, t.index, f.at(t.face, t.index));
}

/// Visibility of one receiver as the loops need it: the two-level store and psum(V) down to blocks.
struct Visibility {
  haar::TwoLevel store;
  std::vector<float> means;
  void assign(const BitCube& blocked);
  int n() const { return store.n; }
  float coefficient(int face, int index) const { return haar::coefficient(store, face, index); }
  float mean(int face, haar::Square s) const {
    return means[std::size_t(face) * (means.size() / 6) + haar::pyramid_index(s)];
  }
};

/// Inner product of what is kept of f with V.
double inner_product(const Sparse& f, const Visibility& v);

/// Sink that evaluates, on a visibility with n(), coefficient() and mean(), as above.
template <class V, class Sum = double>
class Evaluate {
 public:
  PENUMBRA_HD explicit Evaluate(const V& v) : v_(v) {}
  PENUMBRA_HD void coefficient(int face, int index, float weight) {
    sum_ += Sum(weight) * Sum(v_.coefficient(face, index));
  }
  PENUMBRA_HD void mean(int face, haar::Square s, float weight) {
    const haar::Square block = within_level1(v_.n(), s);
    Sum value = Sum(v_.mean(face, block));
    for (int level = block.level; level < s.level; ++level) {  // below the blocks: down through level 2
      const int up = s.level - level;
      const haar::Square over{level, s.i >> up, s.j >> up};
      for (int m = 0; m < 3; ++m)
        value += Sum((1 << level) * haar::sign_of(m, s.i >> (up - 1) & 1, s.j >> (up - 1) & 1)) *
                 Sum(v_.coefficient(face, haar::coefficient_index(over, m)));
    }
    sum_ += Sum(weight) * value;
  }
  PENUMBRA_HD Sum sum() const { return sum_; }

 private:
  const V& v_;
  Sum sum_ = 0;
};

/// A linear functional of V with some channels: weights of all level-1 coefficients, and of the 15 level-2 coefficients
/// of the blocks that have any, in the units of the binary table (so that the sum over a table row is what is taken
/// away from 1 - blocked).
struct Functional {
  int n = 0;
  int channels = 0;                ///< at most 9
  std::vector<float> level1[9];    ///< 6 (n/4)^2 per channel
  std::vector<std::int32_t> slot;  ///< per block: position in level2, or -1
  std::vector<float> level2;       ///< per slot: channels x 16 table entries, the first 0
  std::size_t bytes() const;
};

/// Sink that collects one channel of a functional; take() gives what it collected.
class Collect {
 public:
  explicit Collect(int n, int channels = 3);
  void set_channel(int c) { channel_ = c; }
  void coefficient(int face, int index, float weight);
  void mean(int face, haar::Square s, float weight);
  Functional take() const;

 private:
  int n_, channels_, channel_ = 0;
  std::vector<double> level1_[9];
  std::vector<std::int32_t> slot_;
  std::vector<double> level2_;  ///< per slot: channels x 16
};

}  // namespace penumbra::wavelet
