#include "scenes/fit/cover.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlopt.hpp>
#include <numeric>
#include <random>

#include "scenes/fit/growth.h"

namespace penumbra {
namespace {

struct Ball {
  dvec3 centre{0.0};
  double radius = 0.0, outside = 0.0;
  std::vector<int> members;
  Growth growth;
  bool settled = false;  ///< centre and growth fit the members
};

constexpr double slack = 1.0 + 1e-6;  // distances are compared in float and in double: the farthest member stays inside

class VariationalCover {
 public:
  VariationalCover(const SolidRows& rows, FitPoints points, const FitRequest& request)
      : rows_(rows), points_(std::move(points)), assignment_(request.assignment), balls_(request.spheres) {
    typical_ = std::cbrt(std::max(rows.volume(), std::pow(rows.step(), 3)) / request.spheres);
    seed_centres(request.seed);
    relax(100, 2e-3);
    polish();
  }

  /// Moves the ball that is needed least to where most is wasted; returns whether that helped, and undoes it if not.
  bool teleport(int attempt) {
    const auto rank = [&](int i, auto value) { return ranked(value)[i % int(balls_.size())]; };
    const int split = rank(attempt / 2, [](const Ball& b) { return b.outside; });
    const int gone = rank(attempt % 2, [&](const Ball& b) { return redundancy(b); });
    if (split == gone || balls_[split].members.size() < 2) return false;
    const std::vector<Ball> before = balls_;
    const double cost = total();
    divide(balls_[split], balls_[gone]);
    relax(8, 1e-2);
    polish();
    if (total() < cost) return true;
    balls_ = before;
    return false;
  }
  static constexpr int attempts = 40;

  /// Balls without members take over half of the members of the ball that has most outside.
  void fill_empty() {
    for (Ball& empty : balls_) {
      if (!empty.members.empty()) continue;
      Ball& widest = balls_[ranked([](const Ball& b) { return b.outside; })[0]];
      if (widest.members.size() < 2) return;
      divide(widest, empty);
      refit();
    }
  }

  /// More points, which no cell knows.
  void add(const std::vector<vec3>& points) {
    for (const vec3& p : points) {
      points_.position.push_back(p);
      join(points_.size() - 1);
    }
    refit();
    polish();
  }

  double total() const {
    double sum = 0.0;
    for (const Ball& b : balls_) sum += b.outside;
    return sum;
  }

  SphereSet spheres() const {
    SphereSet set;
    for (const Ball& b : balls_)
      if (!b.members.empty()) set.spheres.push_back({vec3(b.centre), float(b.radius)});
    return set;
  }

 private:
  double distance(const Ball& ball, int point) const {
    return glm::distance(ball.centre, dvec3(points_.position[point]));
  }

  double reach(const Ball& ball, const dvec3& centre) const {
    float farthest = 0.0f;
    const vec3 c(centre);
    for (const int p : ball.members) {
      const vec3 d = points_.position[p] - c;
      farthest = std::max(farthest, glm::dot(d, d));
    }
    return std::sqrt(double(farthest)) * slack;
  }

  void measure_growth(Ball& ball) const {
    ball.growth = Growth(rows_, ball.centre, 2.0 * std::max(typical_, ball.radius));
  }

  /// Random points, each with a chance that grows with its squared distance from those before (Arthur & Vassilvitskii
  /// 2007).
  void seed_centres(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<double> distance2(points_.size(), std::numeric_limits<double>::max());
    int chosen = int(random() % std::uint64_t(points_.size()));
    for (std::size_t k = 0; k < balls_.size(); ++k) {
      balls_[k].centre = points_.position[chosen];
      double sum = 0.0;
      for (int i = 0; i < points_.size(); ++i) {
        const dvec3 d = dvec3(points_.position[i]) - balls_[k].centre;
        distance2[i] = std::min(distance2[i], glm::dot(d, d));
        sum += distance2[i];
      }
      double left = sum * std::ldexp(double(random() >> 11), -53);
      for (chosen = 0; chosen + 1 < points_.size() && (left -= distance2[chosen]) > 0.0;) ++chosen;
    }
    tbb::parallel_for(std::size_t(0), balls_.size(), [&](std::size_t k) { measure_growth(balls_[k]); });
  }

  /// The ball whose outside volume grows least, from its given radius, by reaching a point; ties go to the nearest
  /// centre.
  struct Choice {
    int ball = -1;
    double cost = std::numeric_limits<double>::max(), distance = cost;
  };
  template <class Radius>
  Choice cheapest(int point, const Ball* except, Radius radius) const {
    Choice best;
    for (std::size_t k = 0; k < balls_.size(); ++k) {
      const Ball& b = balls_[k];
      if (&b == except) continue;
      const double d = distance(b, point), r = radius(k);
      const double cost = d <= r ? 0.0 : b.growth(d) - b.growth(r);
      if (cost < best.cost || (cost == best.cost && d < best.distance)) best = {int(k), cost, d};
    }
    return best;
  }

  /// Gives a point to the ball that reaches it most cheaply from its radius so far.
  void join(int point) {
    const Choice to = cheapest(point, nullptr, [&](std::size_t k) { return balls_[k].radius; });
    give(balls_[to.ball], point, to.distance);
  }

  void give(Ball& ball, int point, double at) const {
    ball.members.push_back(point);
    ball.settled = false;
    if (at <= ball.radius) return;
    ball.radius = at * slack;
    ball.outside = ball.growth(ball.radius);
  }

  /// Every point to a ball, all anew. A ball that gets the members it had stays as it is.
  void assign() {
    const std::vector<Ball> before = balls_;
    for (Ball& b : balls_) b.members.clear(), b.radius = b.outside = 0.0;
    if (assignment_ == Assignment::flood) flood();
    else assign_to_nearest();
    tbb::parallel_for(std::size_t(0), balls_.size(), [&](std::size_t k) {
      std::vector<int> old = before[k].members;
      std::sort(old.begin(), old.end()), std::sort(balls_[k].members.begin(), balls_[k].members.end());
      if (before[k].settled && old == balls_[k].members) balls_[k] = before[k];
    });
  }

  void assign_to_nearest() {
    std::vector<Choice> choice(points_.size());
    tbb::parallel_for(0, points_.size(),
                      [&](int p) { choice[p] = cheapest(p, nullptr, [](std::size_t) { return 0.0; }); });
    for (int p = 0; p < points_.size(); ++p) give(balls_[choice[p].ball], p, choice[p].distance);
  }

  /// As published: a flood fill from the first ball's centre; every point joins the ball that, grown as it is by then,
  /// reaches it most cheaply. Where the fill ends before all is visited (several components), it begins anew.
  void flood() {
    std::vector<char> seen(points_.cells());
    std::vector<int> stack;
    for (int i = 0; i <= points_.cells(); ++i) {
      const int seed = i == 0 ? cell_near(vec3(balls_[0].centre)) : i - 1;
      if (seen[seed]) continue;
      seen[seed] = 1;
      stack.push_back(seed);
      while (!stack.empty()) {
        const int cell = stack.back();
        stack.pop_back();
        for (int p = points_.first[cell]; p < points_.first[cell + 1]; ++p) join(p);
        for (const int next : points_.neighbours[cell])
          if (!seen[next]) seen[next] = 1, stack.push_back(next);
      }
    }
    for (int p = points_.first.back(); p < points_.size(); ++p) join(p);
  }

  int cell_near(vec3 at) const {
    const auto nearest = std::min_element(points_.position.begin(), points_.position.end(), [&](vec3 a, vec3 b) {
      return glm::dot(a - at, a - at) < glm::dot(b - at, b - at);
    });
    const int point = int(nearest - points_.position.begin());
    return int(std::upper_bound(points_.first.begin(), points_.first.end(), point) - points_.first.begin()) - 1;
  }

  /// Each ball moves to where the ball that reaches its members has least outside.
  void refit() {
    tbb::parallel_for(std::size_t(0), balls_.size(), [&](std::size_t k) {
      Ball& ball = balls_[k];
      if (ball.settled || ball.members.empty()) return;
      ball.centre = best_centre(ball);
      ball.radius = reach(ball, ball.centre);
      measure_growth(ball);
      ball.outside = ball.growth(ball.radius);
      ball.settled = true;
    });
  }

  /// Powell's method without derivatives (BOBYQA, Powell 2009), in units of the ball's radius.
  dvec3 best_centre(const Ball& ball) const {
    struct Search {
      const VariationalCover& cover;
      const Ball& ball;
      double scale, least;
      dvec3 best;
      double cost(const dvec3& centre) {
        const double value = cover.rows_.outside_volume(centre, cover.reach(ball, centre));
        if (value < least) least = value, best = centre;
        return value / (scale * scale * scale);
      }
    } search{*this, ball, std::max(reach(ball, ball.centre), rows_.step()), std::numeric_limits<double>::max(),
             ball.centre};
    search.cost(ball.centre);
    nlopt::opt powell(nlopt::LN_BOBYQA, 3);
    const auto trial = [](const std::vector<double>& x, std::vector<double>&, void* data) {
      auto& s = *static_cast<Search*>(data);
      return s.cost(s.ball.centre + s.scale * dvec3(x[0], x[1], x[2]));
    };
    powell.set_min_objective(trial, &search);
    powell.set_lower_bounds(-1.0), powell.set_upper_bounds(1.0);
    powell.set_initial_step(0.1);
    powell.set_xtol_abs(2e-3);
    powell.set_maxeval(60);
    std::vector<double> offset(3, 0.0);
    double value = 0.0;
    try {
      powell.optimize(offset, value);
    } catch (const nlopt::roundoff_limited&) {  // the best trial so far is as good as it gets
    }
    return search.best;
  }

  /// Assigns and refits until a round brings less than a share of the sum of outside volumes.
  void relax(int most, double share) {
    double cost = std::numeric_limits<double>::max();
    for (int i = 0; i < most; ++i) {
      assign(), refit();
      if (total() > cost * (1.0 - share)) return;
      cost = total();
    }
  }

  /// Exchange and refit until the sum of outside volumes stops falling.
  void polish() {
    for (int i = 0; i < 5; ++i) {
      const double cost = total();
      for (const int k : ranked([](const Ball& b) { return b.outside; })) exchange(balls_[k]);
      refit();
      if (total() > cost * 0.999) return;
    }
  }

  /// Peels members off a ball, outermost first, as long as what it saves can exceed what others pay; then goes back to
  /// where the gain was largest.
  void exchange(Ball& ball) {
    std::sort(ball.members.begin(), ball.members.end(),
              [&](int a, int b) { return distance(ball, a) < distance(ball, b); });
    std::map<int, double> grown;  // tentative radii of the others
    const auto radius = [&](std::size_t k) {
      const auto at = grown.find(int(k));
      return at == grown.end() ? balls_[k].radius : at->second;
    };
    std::vector<Choice> moves;
    double paid = 0.0, most = 0.0;
    std::size_t keep = 0;
    for (std::size_t left = ball.members.size(); left > 0; --left) {
      const Choice to = cheapest(ball.members[left - 1], &ball, radius);
      if (to.ball < 0 || (paid += to.cost) >= ball.outside) break;
      if (to.distance > radius(std::size_t(to.ball))) grown[to.ball] = to.distance * slack;
      moves.push_back(to);
      const double now = left > 1 ? ball.growth(distance(ball, ball.members[left - 2])) : 0.0;
      if (const double gain = ball.outside - now - paid; gain > most * slack) most = gain, keep = moves.size();
    }
    if (keep == 0) return;
    for (std::size_t i = 0; i < keep; ++i) {
      give(balls_[moves[i].ball], ball.members.back(), moves[i].distance);
      ball.members.pop_back();
    }
    ball.radius = reach(ball, ball.centre);
    ball.outside = ball.growth(ball.radius);
    ball.settled = false;
  }

  /// Two balls in place of one: about the two halves of its members that are nearest to its two farthest members.
  void divide(Ball& ball, Ball& other) {
    const auto farthest_from = [&](vec3 from) {
      return points_.position[*std::max_element(ball.members.begin(), ball.members.end(), [&](int a, int b) {
        return glm::distance(points_.position[a], from) < glm::distance(points_.position[b], from);
      })];
    };
    const vec3 end = farthest_from(vec3(ball.centre)), other_end = farthest_from(end);
    std::vector<int> all;
    all.swap(ball.members);
    other.members.clear();
    for (const int p : all) {
      const vec3 at = points_.position[p];
      (glm::distance(at, end) <= glm::distance(at, other_end) ? ball : other).members.push_back(p);
    }
    for (Ball* half : {&ball, &other}) {
      dvec3 sum(0.0);
      for (const int p : half->members) sum += dvec3(points_.position[p]);
      if (!half->members.empty()) half->centre = sum / double(half->members.size());
      half->radius = reach(*half, half->centre);
      measure_growth(*half);
      half->outside = half->growth(half->radius);
      half->settled = false;
    }
  }

  /// Share of a ball's members that other balls hold too: 1 if it is not needed.
  double redundancy(const Ball& ball) const {
    if (ball.members.empty()) return 1.0;
    const auto shared = std::count_if(ball.members.begin(), ball.members.end(), [&](int p) {
      return std::any_of(balls_.begin(), balls_.end(),
                         [&](const Ball& b) { return &b != &ball && distance(b, p) <= b.radius; });
    });
    return double(shared) / double(ball.members.size());
  }

  /// Indices by falling value, ties by index.
  template <class Value>
  std::vector<int> ranked(Value value) const {
    std::vector<double> values(balls_.size());
    tbb::parallel_for(std::size_t(0), balls_.size(), [&](std::size_t k) { values[k] = value(balls_[k]); });
    std::vector<int> order(balls_.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return values[a] > values[b]; });
    return order;
  }

  const SolidRows& rows_;
  FitPoints points_;
  Assignment assignment_;
  std::vector<Ball> balls_;
  double typical_;
};

}  // namespace

SphereSet cover_solid(const Mesh& solid, const SolidRows& rows, FitPoints points, const FitRequest& request,
                      const FitProgress& progress) {
  if (progress) progress("assigning points", 0.0);
  VariationalCover cover(rows, std::move(points), request);
  const int rounds = 2 * request.spheres + VariationalCover::attempts;
  int failed = 0;
  for (int round = 0; round < rounds && failed < VariationalCover::attempts; ++round) {
    if (progress) progress("moving spheres", double(round) / rounds);
    failed = cover.teleport(failed) ? 0 : failed + 1;
  }
  cover.fill_empty();
  for (int round = 0; round < 2; ++round) {
    if (progress) progress("closing gaps", round / 3.0);
    cover.add(loose_points(solid, cover.spheres()));
  }
  cover.fill_empty();
  SphereSet set = cover.spheres();
  make_covering(solid, set);
  return set;
}

}  // namespace penumbra
