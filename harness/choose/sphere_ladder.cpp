#include "harness/choose/sphere_ladder.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

constexpr int first = 64, second = 16;

double wanted(const SphereLook& look, const Bound& bound) {
  return bound.kind == Bound::Kind::error ? look.ms : look.error;
}

bool within(const SphereLook& look, const Bound& bound) {
  return (bound.kind == Bound::Kind::error ? look.error : look.ms) <= bound.value;
}

}  // namespace

const std::vector<int>& SphereLadder::counts() {
  static const std::vector<int> all = {8, 16, 32, 64, 128, 256, 512};
  return all;
}

void SphereLadder::add(const SphereLook& look) {
  looks_.push_back(look);
  geometry_[look.spheres] = look.geometry;
}

double SphereLadder::geometry_exponent() const {
  if (geometry_.size() < 2) return 0.5;
  const auto [few, coarse] = *geometry_.begin();
  const auto [many, fine] = *geometry_.rbegin();
  if (!(coarse > 0.0 && fine > 0.0)) return 0.5;
  return std::clamp(std::log(coarse / fine) / std::log(double(many) / double(few)), 0.1, 2.0);
}

SphereLook SphereLadder::foretell(const SphereLook& known, int spheres) const {
  const double more = double(spheres) / double(known.spheres);
  SphereLook look = known;
  look.spheres = spheres;
  look.ms = known.ms * std::pow(more, 0.8);
  look.geometry = known.geometry * std::pow(more, -geometry_exponent());
  const double rest = std::max(0.0, known.error * known.error - known.geometry * known.geometry);
  look.error = std::sqrt(rest + look.geometry * look.geometry);
  return look;
}

std::optional<double> SphereLadder::own_best(const std::string& technique, const Bound& bound) const {
  std::optional<double> best;
  for (const SphereLook& look : looks_)
    if (look.technique == technique && within(look, bound) && (!best || wanted(look, bound) < *best))
      best = wanted(look, bound);
  return best;
}

bool SphereLadder::promises(const SphereLook& known, int spheres, const Bound& bound,
                            std::optional<double> best) const {
  SphereLook look = foretell(known, spheres);
  look.error /= 1.15, look.ms /= 1.15;  // what is foretold may be wrong by so much
  if (!within(look, bound)) return false;
  const std::optional<double> rival = spheres < first ? own_best(known.technique, bound) : best;
  return !rival || wanted(look, bound) < *rival;
}

std::optional<int> SphereLadder::next(const Bound& bound, std::optional<double> best) const {
  for (const int begin : {first, second})
    if (!closed_.contains(begin)) return begin;
  std::optional<int> choice;  // the nearest to what is known promises most surely, and its fit is the cheapest
  const auto distance = [&](int n) {
    double least = INFINITY;
    for (const auto& [known, error] : geometry_) least = std::min(least, std::abs(std::log(double(n) / double(known))));
    return least;
  };
  for (const int n : counts()) {
    if (closed_.contains(n)) continue;
    const bool worth = std::any_of(looks_.begin(), looks_.end(),
                                   [&](const SphereLook& known) { return promises(known, n, bound, best); });
    if (worth && (!choice || distance(n) < distance(*choice))) choice = n;
  }
  return choice;
}

}  // namespace penumbra
