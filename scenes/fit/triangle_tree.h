// Triangles in a tree of boxes, in double: which of them come near a box or a ray, and how deep a point lies in them.
#pragma once

#include <array>
#include <vector>

#include "scenes/mesh.h"

namespace penumbra {

class TriangleTree {
 public:
  using Corners = std::array<dvec3, 3>;

  explicit TriangleTree(const Mesh& mesh);

  /// A triangle's corners relative to origin(), metres.
  const Corners& corners(unsigned triangle) const { return corners_[triangle]; }
  /// A triangle's unit normal; zero for one without area.
  const dvec3& normal(unsigned triangle) const { return normal_[triangle]; }
  const dvec3& origin() const { return origin_; }
  /// What is nearer than this coincides, metres: far more than double rounds, far less than float does.
  double tolerance() const { return tolerance_; }

  /// A triangle that a ray meets: +1 where the ray leaves by the triangle's front. `on`: it holds the ray's origin.
  struct Meeting {
    unsigned triangle;
    int sign;
    bool on;
  };
  /// What a ray from the point meets; its direction is tilted until it grazes no edge, and has a positive share along
  /// `towards`.
  std::vector<Meeting> meetings(const dvec3& point, const dvec3& towards) const;

  /// Triangles whose boxes come within the tolerance of a triangle's box, itself among them.
  std::vector<unsigned> near(unsigned triangle) const;

 private:
  struct Box {
    dvec3 low, high;
  };
  struct Node {
    Box box;
    unsigned first, count;  ///< of order_; the left child follows its parent
    unsigned right;         ///< 0 for a leaf
  };
  Box box_of(unsigned triangle) const;
  void split(unsigned first, unsigned count);
  template <class Enters, class Visit>
  void visit(Enters enters, Visit visit) const;
  bool shoot(const dvec3& point, const dvec3& direction, bool last, std::vector<Meeting>& found) const;

  dvec3 origin_;
  double tolerance_;
  std::vector<Corners> corners_;
  std::vector<dvec3> normal_;
  std::vector<unsigned> order_;
  std::vector<Node> nodes_;
};

}  // namespace penumbra
