// What is asked for: an error that must not be exceeded, or a time.
#pragma once

#include <string>

namespace penumbra {

struct Bound {
  enum class Kind { error, time };
  Kind kind = Kind::error;
  double value = 0.02;  ///< relative RMSE against truth, or ms a frame

  /// "2 %" or "10 ms".
  std::string text() const;
};

/// "2%" or "0.02": relative RMSE, 0.1 % to 100 %. Throws Error saying what is allowed.
Bound parse_error_bound(const std::string& text);

/// "10ms", "0.5 s", "800us": time of a frame, 1 us to 1 hour. Throws Error saying what is allowed.
Bound parse_time_bound(const std::string& text);

}  // namespace penumbra
