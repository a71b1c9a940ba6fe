// The folder that a run writes: results.json grows row by row, and nothing that was finished is lost.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "harness/results/results_file.h"

namespace penumbra {

/// Holds a folder for one run. All functions may be called from any thread.
class ResultsFolder {
 public:
  /// Makes the folder. Throws Error if another run is writing to it, or it cannot be made.
  explicit ResultsFolder(std::string directory);
  ~ResultsFolder();
  ResultsFolder(const ResultsFolder&) = delete;
  ResultsFolder& operator=(const ResultsFolder&) = delete;

  /// Throws away what was added; `waiting`: rows of an earlier run, which stay on disk until they are measured anew.
  void begin(nlohmann::json context, const std::vector<Row>& waiting);
  /// The order that rows have in the file, whatever order they finish in. Names come behind those that are known.
  void expect(const std::vector<std::string>& names);
  /// A finished row. Saves all if that was not done for a second.
  void add(const Row& row);
  /// Saves if rows have been added, and not for a second.
  void save_if_due();
  /// Rows of this run so far.
  std::vector<Row> rows() const;
  /// Rows of this run so far, and those that wait: what the file holds.
  std::vector<Row> all_rows() const;
  /// Writes results.json. Returns "", or why it cannot be written: a full disk must not end a run.
  std::string save();

  const std::string& directory() const { return directory_; }
  /// The context that begin() was given.
  nlohmann::json context() const;

 private:
  std::vector<Row> ordered() const;
  std::string save_locked();

  std::string directory_;
  int lock_ = -1;
  mutable std::mutex mutex_;
  nlohmann::json context_;
  std::vector<std::string> order_;
  std::map<std::string, Row> finished_;
  std::vector<Row> waiting_;
  bool unsaved_ = false;
  double saved_ = 0.0;  ///< seconds of the steady clock
};

}  // namespace penumbra
