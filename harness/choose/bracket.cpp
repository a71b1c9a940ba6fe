#include "harness/choose/bracket.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

constexpr double stride = 4.0;  // of the first, coarse steps
constexpr double idle = 1.1;    // a knob that moves the time by no more than this over a wide bracket is idle
constexpr double close = 1.08;  // a bracket whose ends are as near to each other is not worth halving

class Bracket {
 public:
  Bracket(const Line& line, const Bound& bound, const LookAt& look_at, const Worth& worth)
      : line_(line), bound_(bound), look_at_(look_at), worth_(worth) {}

  std::optional<Found> find() {
    if (line_.knob.empty()) {
      visit(0);
      return best_ ? best_ : nearest_;
    }
    int at = line_.values[(line_.values.size() - 1) / 2];
    const Verdict first = visit(at);
    if (first == Verdict::within && best_->look.ms > worth_.within_ms) {  // does the cheapest end change that?
      visit(line_.values.front());
      if (best_->look.ms > worth_.within_ms) return best_;
    }
    // Towards the bound: to cheaper values from within an error, to better ones from within a time.
    const bool up = good(first) == (bound_.kind == Bound::Kind::time);
    for (Verdict v = first; v == Verdict::within || v == Verdict::beyond;) {
      const int next = std::clamp(up ? int(at * stride) : int(at / stride), line_.values.front(), line_.values.back());
      if (next == at) break;  // the end of the line
      v = visit(next);
      if (v != Verdict::broken && good(v) != good(first)) {
        halve(std::min(at, next), std::max(at, next));
        break;
      }
      at = next;
    }
    return best_ ? best_ : nearest_;
  }

 private:
  enum class Verdict { within, beyond, hopeless, broken };
  static bool good(Verdict v) { return v == Verdict::within; }

  Verdict visit(int value) {
    const std::optional<Look> look = look_at_(value);
    if (!look) return Verdict::broken;
    const Found found{value, *look};
    const auto error = [](const Found& f) { return f.look.error.value_or(INFINITY); };
    if (look->within(bound_)) {
      const bool better = !best_ || (bound_.kind == Bound::Kind::error ? value < best_->value : value > best_->value);
      if (better) best_ = found;
      return Verdict::within;
    }
    const bool nearer = !nearest_ || (bound_.kind == Bound::Kind::error ? error(found) < error(*nearest_)
                                                                        : look->ms < nearest_->look.ms);
    if (nearer) nearest_ = found;
    return look->ms > worth_.beyond_ms ? Verdict::hopeless : Verdict::beyond;
  }

  /// One end is within the bound, the other is not.
  void halve(int low, int high) {
    while (high - low > 1 && double(high) > close * double(low) && !(double(high) > 1.3 * double(low) && is_idle())) {
      const int middle = std::clamp(int(std::lround(std::sqrt(double(low) * double(high)))), low + 1, high - 1);
      const Verdict v = visit(middle);
      if (v == Verdict::broken) return;
      const bool enough = good(v) == (bound_.kind == Bound::Kind::error);  // the bound lies below
      (enough ? high : low) = middle;
    }
  }

  bool is_idle() const {
    const double a = best_->look.ms, b = nearest_->look.ms;
    return std::max(a, b) <= idle * std::min(a, b);
  }

  const Line& line_;
  const Bound& bound_;
  const LookAt& look_at_;
  const Worth worth_;
  std::optional<Found> best_, nearest_;
};

}  // namespace

bool Look::within(const Bound& bound) const {
  if (bound.kind == Bound::Kind::time) return ms <= bound.value;
  return tie || (error && *error <= bound.value);
}

std::optional<Found> best_on(const Line& line, const Bound& bound, const LookAt& look_at, const Worth& worth) {
  return Bracket(line, bound, look_at, worth).find();
}

}  // namespace penumbra
