#include "scenes/fit/union_surface.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>

#include "scenes/error.h"
#include "scenes/fit/triangle_tree.h"

namespace penumbra {
namespace {

using Polygon = std::vector<dvec3>;  // convex, counter-clockwise about its triangle's normal
struct Segment {
  dvec3 from, to;
};

constexpr std::size_t most_pieces = 500'000;

/// The triangle from its least vertex on: the same for equal triangles that face the same way.
std::array<unsigned, 3> turned(const uvec3& t) {
  std::array<unsigned, 3> key{t.x, t.y, t.z};
  std::rotate(key.begin(), std::min_element(key.begin(), key.end()), key.end());
  return key;
}

/// Shares of a segment where it enters and leaves a polygon, both borders included.
std::pair<double, double> clip(const Polygon& polygon, const dvec3& normal, const Segment& s, double tolerance) {
  double enter = 0.0, leave = 1.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const dvec3 edge = polygon[(i + 1) % polygon.size()] - polygon[i];
    const double length = glm::length(edge);
    if (length <= tolerance) continue;
    const dvec3 inward = glm::cross(normal, edge) / length;
    const double from = glm::dot(inward, s.from - polygon[i]) + tolerance;
    const double to = glm::dot(inward, s.to - polygon[i]) + tolerance;
    if (from < 0.0 && to < 0.0) return {1.0, 0.0};
    if (from < 0.0) enter = std::max(enter, from / (from - to));
    else if (to < 0.0) leave = std::min(leave, from / (from - to));
  }
  return {enter, leave};
}

bool passes(const Polygon& polygon, const dvec3& normal, const Segment& s, double tolerance) {
  const auto [enter, leave] = clip(polygon, normal, s, tolerance);
  return (leave - enter) * glm::distance(s.from, s.to) > 4.0 * tolerance;  // more than touching a corner
}

/// Cuts a polygon along the segment's line; the second part is empty where the line only touches.
std::pair<Polygon, Polygon> cut(const Polygon& polygon, const dvec3& normal, const Segment& s, double tolerance) {
  const dvec3 across = glm::normalize(glm::cross(normal, s.to - s.from));
  std::vector<double> side;
  for (const dvec3& p : polygon) {
    const double d = glm::dot(across, p - s.from);
    side.push_back(std::abs(d) <= tolerance ? 0.0 : d);
  }
  const auto [low, high] = std::minmax_element(side.begin(), side.end());
  if (!(*low < 0.0 && *high > 0.0)) return {polygon, {}};
  std::pair<Polygon, Polygon> parts;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const std::size_t next = (i + 1) % polygon.size();
    if (side[i] >= 0.0) parts.first.push_back(polygon[i]);
    if (side[i] <= 0.0) parts.second.push_back(polygon[i]);
    if (side[i] * side[next] >= 0.0) continue;
    const dvec3 at = polygon[i] + side[i] / (side[i] - side[next]) * (polygon[next] - polygon[i]);
    parts.first.push_back(at), parts.second.push_back(at);
  }
  return parts;
}

class UnionSurface {
 public:
  UnionSurface(const Mesh& mesh, const std::string& what) : mesh_(mesh), what_(what), tree_(merged(mesh)) {}

  Mesh make(int& dropped) {
    find_pieces();
    find_sheets();
    kept_.resize(pieces_.size());
    std::vector<char> gone(pieces_.size());
    tbb::parallel_for(std::size_t(0), pieces_.size(), [&](std::size_t t) {
      if (alone_[t]) return;
      for (const Polygon& p : pieces_[t]) {
        const Part part = part_of(unsigned(t), p);
        gone[t] |= part == Part::none;
        if (part == Part::surface) kept_[t].push_back(p);
        if (part == Part::wall) kept_[t].insert(kept_[t].end(), {p, Polygon(p.rbegin(), p.rend())});
      }
    });
    for (const std::vector<unsigned>& sheet : sheets_) {
      const bool stays = sheet_stays(sheet);
      for (const unsigned t : sheet) (stays ? alone_[t] : gone[t]) = stays ? 2 : 1;
    }
    dropped = int(mesh_.triangles.size() - single_.triangles.size());
    for (const char g : gone) dropped += g;
    return dropped == 0 || is_crease(gone) ? dropped = 0, mesh_ : assemble();
  }

 private:
  double area(const Polygon& p) const {
    dvec3 sum(0.0);
    for (std::size_t k = 2; k < p.size(); ++k) sum += glm::cross(p[k - 1] - p[0], p[k] - p[0]);
    return 0.5 * glm::length(sum);
  }

  /// Is all that would go a negligible part of the surface, as where a scanned surface folds over by a triangle or two?
  /// A part a of the surface encloses at most about a^1.5 of the volume.
  bool is_crease(const std::vector<char>& gone) const {
    if (coincides_) return false;
    double all = 0.0, lost = 0.0;
    for (unsigned t = 0; t < gone.size(); ++t) {
      const TriangleTree::Corners& c = tree_.corners(t);
      const double own = area({c[0], c[1], c[2]});
      all += own;
      if (!gone[t]) continue;
      lost += own;
      for (const Polygon& p : kept_[t]) lost -= area(p);
    }
    return lost < 1e-4 * all;
  }

  /// Of equal triangles that are turned the same way one stays, with their number as its weight.
  const Mesh& merged(const Mesh& mesh) {
    std::vector<std::pair<std::array<unsigned, 3>, unsigned>> sorted;
    for (unsigned t = 0; t < mesh.triangles.size(); ++t) sorted.emplace_back(turned(mesh.triangles[t]), t);
    std::sort(sorted.begin(), sorted.end());
    std::vector<int> copies(sorted.size());  // by the first of them
    for (std::size_t i = 0, first = 0; i < sorted.size(); ++i) {
      if (sorted[i].first != sorted[first].first) first = i;
      ++copies[sorted[first].second];
    }
    single_.positions = mesh.positions;
    for (std::size_t t = 0; t < copies.size(); ++t)
      if (copies[t] > 0) single_.triangles.push_back(mesh.triangles[t]), weight_.push_back(copies[t]);
    return single_;
  }

  int shared_corners(unsigned t, unsigned other) const {
    const uvec3 &a = single_.triangles[t], &b = single_.triangles[other];
    int count = 0;
    for (int i = 0; i < 3; ++i) count += a[i] == b.x || a[i] == b.y || a[i] == b.z;
    return count;
  }

  /// Where another triangle meets this one's plane: a segment, or, where it lies in it, its three edges.
  std::vector<Segment> contact(unsigned t, unsigned other) const {
    const TriangleTree::Corners& c = tree_.corners(other);
    double side[3];
    int zeros = 0;
    for (int k = 0; k < 3; ++k) {
      side[k] = glm::dot(tree_.normal(t), c[k] - tree_.corners(t)[0]);
      if (std::abs(side[k]) <= tree_.tolerance()) side[k] = 0.0, ++zeros;
    }
    if (zeros == 3) return {{c[0], c[1]}, {c[1], c[2]}, {c[2], c[0]}};
    if (shared_corners(t, other) >= 2) return {};  // neighbours that do not lie on each other
    std::vector<dvec3> ends;
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      if (side[k] == 0.0) ends.push_back(c[k]);
      else if (side[k] * side[next] < 0.0) ends.push_back(c[k] + side[k] / (side[k] - side[next]) * (c[next] - c[k]));
    }
    if (ends.size() != 2) return {};
    return {{ends[0], ends[1]}};
  }

  /// Cuts every triangle along what crosses it; alone are those that touch nothing but neighbours.
  void find_pieces() {
    const std::size_t count = single_.triangles.size();
    pieces_.resize(count);
    alone_.assign(count, 1);
    std::atomic<std::size_t> total{0};
    tbb::parallel_for(std::size_t(0), count, [&](std::size_t i) {
      const auto t = unsigned(i);
      const dvec3& normal = tree_.normal(t);
      if (normal == dvec3(0.0)) return;
      const TriangleTree::Corners& c = tree_.corners(t);
      const Polygon own{c[0], c[1], c[2]};
      Parts parts(own);
      for (const unsigned other : tree_.near(t)) {
        if (other == t || tree_.normal(other) == dvec3(0.0)) continue;
        const int shared = shared_corners(t, other);
        if (shared == 3) alone_[t] = 0;
        for (const Segment& s : contact(t, other)) {
          if (shared == 2 && !covers_more_than_an_edge(t, other)) break;
          if (!passes(own, normal, s, tree_.tolerance())) continue;
          alone_[t] = 0;
          parts.cut_along(normal, s, tree_.tolerance());
        }
        if (total + parts.polygons.size() > most_pieces) break;
      }
      if (alone_[t]) return;
      pieces_[t] = std::move(parts.polygons);
      total += pieces_[t].size();
      if (total > most_pieces)
        throw Error("{}: its parts cross each other too often (more than {} pieces); unite them in a modeller", what_,
                    most_pieces);
    });
  }

  /// Convex parts of a triangle, with their boxes beside: most cuts miss most of them.
  class Parts {
   public:
    explicit Parts(Polygon whole) { add(std::move(whole)); }

    void cut_along(const dvec3& normal, const Segment& s, double tolerance) {
      const Extent at = extent({s.from, s.to});
      for (std::size_t i = polygons.size(); i-- > 0;) {
        const bool apart = glm::any(glm::lessThan(at.high + tolerance, extents_[i].low)) ||
                           glm::any(glm::lessThan(extents_[i].high + tolerance, at.low));
        if (apart || !passes(polygons[i], normal, s, tolerance)) continue;
        auto [first, second] = cut(polygons[i], normal, s, tolerance);
        if (second.empty()) continue;
        extents_[i] = extent(first);
        polygons[i] = std::move(first);
        add(std::move(second));
      }
    }

    std::vector<Polygon> polygons;

   private:
    struct Extent {
      dvec3 low, high;
    };
    static Extent extent(const Polygon& p) {
      Extent e{p[0], p[0]};
      for (const dvec3& at : p) e = {glm::min(e.low, at), glm::max(e.high, at)};
      return e;
    }
    void add(Polygon p) {
      extents_.push_back(extent(p));
      polygons.push_back(std::move(p));
    }
    std::vector<Extent> extents_;
  };

  /// Of two triangles in one plane with a common edge: do they lie on the same side of it?
  bool covers_more_than_an_edge(unsigned t, unsigned other) const {
    const uvec3 &a = single_.triangles[t], &b = single_.triangles[other];
    const auto apex = [](const uvec3& of, const uvec3& than) {
      for (int k = 0; k < 3; ++k)
        if (of[k] != than.x && of[k] != than.y && of[k] != than.z) return k;
      return 0;
    };
    const int k = apex(a, b);
    const dvec3 from = tree_.corners(t)[(k + 1) % 3], edge = tree_.corners(t)[(k + 2) % 3] - from;
    const dvec3 across = glm::cross(tree_.normal(t), edge);
    return glm::dot(across, tree_.corners(other)[apex(b, a)] - from) > 0.0;
  }

  /// Triangles that are alone, connected through edges that they share with one other alone: all of a sheet stays or
  /// goes.
  void find_sheets() {
    std::vector<std::pair<std::uint64_t, unsigned>> edges;
    for (unsigned t = 0; t < single_.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const auto [low, high] = std::minmax(single_.triangles[t][k], single_.triangles[t][(k + 1) % 3]);
        edges.emplace_back((std::uint64_t(low) << 32) | high, t);
      }
    std::sort(edges.begin(), edges.end());
    std::vector<std::vector<unsigned>> neighbours(single_.triangles.size());
    for (std::size_t i = 0, next = 0; i < edges.size(); i = next) {
      while (next < edges.size() && edges[next].first == edges[i].first) ++next;
      if (next - i != 2) continue;
      neighbours[edges[i].second].push_back(edges[i + 1].second);
      neighbours[edges[i + 1].second].push_back(edges[i].second);
    }
    std::vector<char> seen(single_.triangles.size());
    for (unsigned seed = 0; seed < seen.size(); ++seed) {
      if (seen[seed] || !alone_[seed]) continue;
      seen[seed] = 1;
      std::vector<unsigned> sheet{seed};
      for (std::size_t i = 0; i < sheet.size(); ++i)
        for (const unsigned other : neighbours[sheet[i]])
          if (!seen[other] && alone_[other]) seen[other] = 1, sheet.push_back(other);
      sheets_.push_back(std::move(sheet));
    }
  }

  bool sheet_stays(const std::vector<unsigned>& sheet) {
    const auto area = [&](unsigned t) {
      const TriangleTree::Corners& c = tree_.corners(t);
      return tree_.normal(t) == dvec3(0.0) ? 0.0 : glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
    };
    const unsigned widest =
        *std::max_element(sheet.begin(), sheet.end(), [&](unsigned a, unsigned b) { return area(a) < area(b); });
    if (area(widest) == 0.0) return false;
    const TriangleTree::Corners& c = tree_.corners(widest);
    return part_of(widest, {c[0], c[1], c[2]}) == Part::surface;
  }

  enum class Part { none, surface, wall, other_side };
  /// What a piece of triangle t is of the union. Of those that coincide there, the first one turned the right way
  /// stands for the surface, and the first one at all for both sides of a wall without thickness.
  Part part_of(unsigned t, const Polygon& piece) {
    int front = 0, step = 0;
    unsigned first = t, first_alike = t;
    for (const TriangleTree::Meeting& m : tree_.meetings(middle(piece), tree_.normal(t))) {
      (m.on ? step : front) += m.sign * weight_[m.triangle];
      if (!m.on) continue;
      if (m.triangle != t) coincides_ = true;
      first = std::min(first, m.triangle);
      if (m.sign > 0) first_alike = std::min(first_alike, m.triangle);
    }
    if (front <= 0 && step == 0) return first == t ? Part::wall : Part::other_side;
    return front <= 0 && front + step > 0 && first_alike == t ? Part::surface : Part::none;
  }

  static dvec3 middle(const Polygon& piece) {
    dvec3 sum(0.0);
    for (const dvec3& p : piece) sum += p;
    return sum / double(piece.size());
  }

  Mesh assemble() const {
    Mesh out;
    std::map<std::array<float, 3>, unsigned> index;
    const auto vertex = [&](vec3 p) {
      p += 0.0f;  // -0 is 0
      const auto [at, is_new] = index.try_emplace({p.x, p.y, p.z}, unsigned(out.positions.size()));
      if (is_new) out.positions.push_back(p);
      return at->second;
    };
    const auto add = [&](const std::vector<unsigned>& corner) {
      for (std::size_t k = 2; k < corner.size(); ++k) {
        const uvec3 t(corner[0], corner[k - 1], corner[k]);
        if (t.x != t.y && t.y != t.z && t.z != t.x) out.triangles.push_back(t);
      }
    };
    for (std::size_t t = 0; t < kept_.size(); ++t) {
      const uvec3& v = single_.triangles[t];
      if (alone_[t] == 2)
        add({vertex(mesh_.positions[v.x]), vertex(mesh_.positions[v.y]), vertex(mesh_.positions[v.z])});
      for (const Polygon& p : kept_[t]) {
        std::vector<unsigned> corner;
        for (const dvec3& at : p) corner.push_back(vertex(vec3(at + tree_.origin())));
        add(corner);
      }
    }
    if (out.empty()) throw Error("{}: the mesh encloses nothing: its parts cancel each other", what_);
    return out;
  }

  const Mesh& mesh_;
  const std::string& what_;
  Mesh single_;
  std::vector<int> weight_;
  TriangleTree tree_;
  std::vector<std::vector<Polygon>> pieces_, kept_;
  std::vector<char> alone_;  ///< touches nothing but neighbours; 2: and stays
  std::vector<std::vector<unsigned>> sheets_;
  std::atomic<bool> coincides_{false};  ///< some triangles lie on others
};

}  // namespace

Mesh union_surface(const Mesh& mesh, const std::string& what, int* dropped) {
  int count = 0;
  Mesh out = UnionSurface(mesh, what).make(count);
  if (dropped) *dropped = count;
  return out;
}

Mesh without_walls(const Mesh& mesh) {
  std::vector<std::array<unsigned, 3>> present;
  present.reserve(mesh.triangles.size());
  for (const uvec3& t : mesh.triangles) present.push_back(turned(t));
  std::sort(present.begin(), present.end());
  Mesh out = mesh;
  std::erase_if(out.triangles, [&](const uvec3& t) {
    return std::binary_search(present.begin(), present.end(), turned({t.x, t.z, t.y}));
  });
  return out;
}

}  // namespace penumbra
