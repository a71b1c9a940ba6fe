// Statistics of a handful of samples.
#pragma once

#include <optional>
#include <vector>

namespace penumbra {

/// The middle value, or the mean of the two in the middle; 0 of no samples.
double median(std::vector<double> values);

/// Half the distance between the first and the third quartile (interpolated linearly): the middle half of the samples
/// lies about this far from their median. 0 of fewer than two samples.
double spread(std::vector<double> values);

/// Half the width of the central interval of Student's distribution that holds a share `level` of it, for so many
/// degrees of freedom: 12.7 for 0.95 and 1, near 1.96 for 0.95 and many.
double student_quantile(double level, double degrees);

/// Mean over the values that are there; absent if none is.
std::optional<double> mean_defined(const std::vector<std::optional<double>>& values);

}  // namespace penumbra
