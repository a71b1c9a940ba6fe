// Published tables beside our rows.
#pragma once

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
  std::string path, title;  ///< title: the first comment
  std::vector<std::string> columns;
  std::vector<Line> lines;
  /// Throws Error naming file and line if the cell is no number.
  double number(const Line& line, std::size_t column) const;
};
/// Reads results/published/NAME.csv. Throws Error if it is missing, or a line has more or fewer cells than columns.
CsvFile load_published_csv(const std::string& name);

/// A table of results/published: lines of "# comment", one of column names, then values. The last column is the
/// published frames per second, the one before it names the device; all others are matched against a row's parameters
/// (and "spheres") of the same name; an empty cell is matched by any row.
class PublishedTable {
 public:
  /// Name as in results/published/NAME.csv. Throws Error if it is missing or malformed.
  static PublishedTable load(const std::string& name);

  /// Published frames per second by device for a row; empty if nothing matches.
  std::map<std::string, double> lookup(const Row& row) const;
  const std::vector<std::string>& devices() const { return devices_; }
  const std::vector<std::string>& keys() const { return keys_; }
  const std::string& title() const { return title_; }

 private:
  struct Line {
    std::map<std::string, std::string> keys;
    std::string device;
    double fps;
  };
  std::string title_;
  std::vector<Line> lines_;
  std::vector<std::string> keys_, devices_;
};

/// Markdown: our frames per second beside the published ones, with ratios and errors, of rows that have a match.
std::string make_published_table(const PublishedTable& table, const std::vector<Row>& rows);

}  // namespace penumbra
