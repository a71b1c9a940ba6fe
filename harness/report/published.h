// Published tables beside our rows.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <vector>

#include "harness/results/row.h"

namespace penumbra {

/// A file of results/published: lines of "# comment", one of column names, then values.
struct CsvFile {
  struct Line {
    int number;
    std::vector<std::string> cells;
  };
  std::string path, title;         ///< title: the first comment
  std::vector<std::string> notes;  ///< the other comments
  std::vector<std::string> columns;
  std::vector<Line> lines;
  /// Throws Error naming file and line if the cell is no number.
  double number(const Line& line, std::size_t column) const;
};
/// Reads results/published/NAME.csv. Throws Error if it is missing, or a line has more or fewer cells than columns.
CsvFile load_published_csv(const std::string& name);

/// One published figure, beside a row of ours or alone.
struct PublishedFigure {
  std::map<std::string, std::string> keys = {};  ///< by column, as the file has them
  std::string device, unit;                      ///< unit: "fps", "ms", ...
  double published = 0.0;
  const Row* row = nullptr;              ///< null: no row is like it
  double here = nan;                     ///< the row's, in the same unit; NaN without a row
  std::vector<std::string> stages = {};  ///< that `here` is the sum of; empty: the whole frame
  /// Both over those of the first figure of the same table and subject that has a row like this one; NaN: not compared.
  double published_relative = nan, here_relative = nan;

  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();
};

/// A table of results/published: lines of "# comment", one of column names, then values. The last column is the
/// published frames per second, the one before it names the device; all others are matched against a row's parameters
/// (and "spheres") of the same name; an empty cell is matched by any row.
class PublishedTable {
 public:
  /// Name as in results/published/NAME.csv. Throws Error if it is missing or malformed.
  static PublishedTable load(const std::string& name);

  /// Published frames per second by device for a row; empty if nothing matches.
  std::map<std::string, double> lookup(const Row& row) const;
  /// Every figure of the table, in its order, once for each row that is like it, or alone.
  std::vector<PublishedFigure> beside(const std::vector<Row>& rows) const;
  const std::vector<std::string>& devices() const { return devices_; }
  const std::vector<std::string>& keys() const { return keys_; }
  const std::string& title() const { return title_; }

 private:
  struct Line {
    std::map<std::string, std::string> keys;
    std::string device;
    double fps;
    bool is_like(const Row& row) const;
  };
  std::string title_;
  std::vector<Line> lines_;
  std::vector<std::string> keys_, devices_;
};

/// Markdown: our frames per second beside the published ones, with ratios and errors, of rows that have a match.
std::string make_published_table(const PublishedTable& table, const std::vector<Row>& rows);

}  // namespace penumbra
