// How figures of a row read in tables.
#pragma once

#include <string>
#include <vector>

#include "harness/results/row.h"

namespace penumbra {

/// "name=value ..." of a row's parameters that differ from their defaults or among rows of its technique; the others
/// would only widen a table.
std::string telling_parameters(const Row& row, const std::vector<const Row*>& rows);

/// How many spheres and what they were fitted for; empty if the variant does not look at them.
std::string spheres_text(const RowIdentity& id);

/// "pixel-basis visibility=raster": technique and telling parameters; backend and threads where another of the rows has
/// the same technique with others.
std::string variant_label(const Row& row, const std::vector<const Row*>& rows);
/// variant_label(), and the spheres where they differ: "pixel-basis spheres=64 cover".
std::string short_label(const Row& row, const std::vector<const Row*>& rows);

// The next four are empty where threads, samples, times and bytes are not known: that is not 0.
std::string threads_text(const RowIdentity& id);
std::string median_text(const std::vector<double>& samples);  ///< ms
std::string prepare_text(const Timing& timing);
std::string mebibytes_text(const Row& row);

/// "**12.345** ±0.012": median and half the interquartile range, which one sample does not have; empty without samples.
std::string milliseconds_text(const Timing& timing);

/// A relative error in percent; "undefined" where it is 0 / 0.
std::string percent_text(const std::optional<double>& relative);
/// percent_text() of the error against a rung; "" if the row has not been compared with it.
std::string rung_text(const Row& row, const std::string& rung);
/// rung_text(), but an error that is noise is a tie, and an undefined one still has its size.
std::string rung_or_tie(const Row& row, const std::string& rung);
/// The error against truth for a screen: three digits of percent, "< 0.2" where it is a tie, "undefined".
std::string truth_text(const Row& row);
/// A mean over frames in percent, or a tie below the floor that noise sets.
std::string mean_or_tie(const std::vector<std::optional<double>>& relative, double floor);
/// percent_text() of Score::geometry; "" if the row lacks one of the rungs.
std::string geometry_text(const Row& row);

/// The rows that were measured.
std::vector<const Row*> good_rows(const std::vector<Row>& rows);
/// The rows of one scene that were measured.
std::vector<const Row*> good_rows(const std::vector<Row>& rows, const std::string& scene);
/// Appends the value if it is not there yet.
void add_distinct(const std::string& value, std::vector<std::string>& all);

/// Names of the rows' scenes, in order of first appearance.
std::vector<std::string> scenes_of(const std::vector<Row>& rows);

/// Names and values of the columns that say what a row is: technique, backend, parameters, threads, spheres.
std::vector<std::string> variant_columns();
std::vector<std::string> variant_cells(const Row& row, const std::vector<const Row*>& rows);

}  // namespace penumbra
