#include "scenes/fit/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace penumbra {
namespace {

constexpr unsigned leaf_size = 4;

/// Direction `attempt` of a sequence that has no simple ratios (Roberts 2018, R2), so that modelled edges are missed.
dvec3 direction_of(int attempt) {
  const double u = std::fmod(0.5 + 0.7548776662466927 * (attempt + 1), 1.0);
  const double z = 2.0 * std::fmod(0.5 + 0.5698402909980532 * (attempt + 1), 1.0) - 1.0;
  const double across = std::sqrt(1.0 - z * z);
  return {across * std::cos(2.0 * pi * u), across * std::sin(2.0 * pi * u), z};
}

/// The least of the point's three barycentric weights; the point lies in the triangle's plane.
double least_weight(const TriangleTree::Corners& c, const dvec3& normal, double twice_area, const dvec3& point) {
  double least = 1.0;
  for (int k = 0; k < 3; ++k) {
    const dvec3 a = c[k] - point, b = c[(k + 1) % 3] - point;
    least = std::min(least, glm::dot(normal, glm::cross(a, b)) / twice_area);
  }
  return least;
}

}  // namespace

TriangleTree::TriangleTree(const Mesh& mesh) : order_(mesh.triangles.size()) {
  const Bounds box = bounds(mesh);
  origin_ = 0.5 * (dvec3(box.low) + dvec3(box.high));
  tolerance_ = 1e-11 * glm::length(dvec3(box.high) - dvec3(box.low));
  for (const uvec3& t : mesh.triangles) {
    Corners& c = corners_.emplace_back();
    for (int k = 0; k < 3; ++k) c[k] = dvec3(mesh.positions[t[k]]) - origin_;
    const dvec3 n = glm::cross(c[1] - c[0], c[2] - c[0]);
    const double longest2 = std::max(
        {glm::dot(c[1] - c[0], c[1] - c[0]), glm::dot(c[2] - c[1], c[2] - c[1]), glm::dot(c[0] - c[2], c[0] - c[2])});
    const double length = glm::length(n);
    normal_.push_back(length > 1e-12 * longest2 ? n / length : dvec3(0.0));
  }
  std::iota(order_.begin(), order_.end(), 0u);
  if (!order_.empty()) split(0, unsigned(order_.size()));
}

TriangleTree::Box TriangleTree::box_of(unsigned triangle) const {
  const Corners& c = corners_[triangle];
  return {glm::min(c[0], glm::min(c[1], c[2])) - tolerance_, glm::max(c[0], glm::max(c[1], c[2])) + tolerance_};
}

void TriangleTree::split(unsigned first, unsigned count) {
  const unsigned own = unsigned(nodes_.size());
  Box box = box_of(order_[first]);
  for (unsigned i = first; i < first + count; ++i) {
    const Box b = box_of(order_[i]);
    box = {glm::min(box.low, b.low), glm::max(box.high, b.high)};
  }
  nodes_.push_back({box, first, count, 0});
  if (count <= leaf_size) return;
  const dvec3 extent = box.high - box.low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const auto centre = [&](unsigned t) { return corners_[t][0][axis] + corners_[t][1][axis] + corners_[t][2][axis]; };
  const unsigned half = count / 2;
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + half, begin + count, [&](unsigned a, unsigned b) { return centre(a) < centre(b); });
  split(first, half);
  nodes_[own].right = unsigned(nodes_.size());
  split(first + half, count - half);
}

template <class Enters, class Visit>
void TriangleTree::visit(Enters enters, Visit visit) const {
  if (nodes_.empty()) return;
  std::vector<unsigned> stack{0};
  while (!stack.empty()) {
    const unsigned at = stack.back();
    stack.pop_back();
    const Node& node = nodes_[at];
    if (!enters(node.box)) continue;
    if (node.right == 0)
      for (unsigned i = node.first; i < node.first + node.count; ++i) visit(order_[i]);
    else stack.push_back(node.right), stack.push_back(at + 1);
  }
}

std::vector<unsigned> TriangleTree::near(unsigned triangle) const {
  const Box own = box_of(triangle);
  const auto meets = [&](const Box& b) {
    return glm::all(glm::lessThanEqual(b.low, own.high)) && glm::all(glm::lessThanEqual(own.low, b.high));
  };
  std::vector<unsigned> found;
  visit(meets, [&](unsigned t) {
    if (meets(box_of(t))) found.push_back(t);
  });
  return found;
}

bool TriangleTree::shoot(const dvec3& point, const dvec3& direction, bool last, std::vector<Meeting>& found) const {
  constexpr double edge = 1e-10;  // in barycentric weights
  found.clear();
  bool grazes = false;
  const dvec3 inverse = 1.0 / direction;  // no component is zero
  const auto enters = [&](const Box& b) {
    const dvec3 p = (b.low - point) * inverse, q = (b.high - point) * inverse;
    const dvec3 first = glm::min(p, q), second = glm::max(p, q);
    return std::max({first.x, first.y, first.z, 0.0}) <= std::min({second.x, second.y, second.z});
  };
  visit(enters, [&](unsigned t) {
    const dvec3& n = normal_[t];
    const double along = glm::dot(direction, n);
    if (along == 0.0) return;  // also where there is no area
    const Corners& c = corners_[t];
    const double twice_area = glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
    const double height = glm::dot(n, c[0] - point);
    const int sign = along > 0.0 ? 1 : -1;
    if (std::abs(height) <= tolerance_) {
      if (least_weight(c, n, twice_area, point + height * n) >= -edge) found.push_back({t, sign, true});
      return;
    }
    if (height / along < 0.0) return;
    const double weight = least_weight(c, n, twice_area, point + height / along * direction);
    grazes |= std::abs(weight) < edge;
    if (weight >= 0.0) found.push_back({t, sign, false});
  });
  return last || !grazes;
}

std::vector<TriangleTree::Meeting> TriangleTree::meetings(const dvec3& point, const dvec3& towards) const {
  constexpr int attempts = 32;
  std::vector<Meeting> found;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    const dvec3 d = direction_of(attempt);
    const double along = glm::dot(d, towards);
    const bool last = attempt + 1 == attempts;
    if (std::abs(along) < 0.1 * glm::length(towards) && !last) continue;
    if (shoot(point, along < 0.0 ? -d : d, last, found)) break;
  }
  return found;
}

}  // namespace penumbra
