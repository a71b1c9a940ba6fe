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

  /// Throws away what was added; `waiting`: rows of an earlier run, which stay on disk until they are measured anew or
  /// the run is over.
  void begin(nlohmann::json context, const std::vector<Row>& waiting);
  /// The order that rows have in the file, whatever order they finish in. Names come behind those that are known.
  void expect(const std::vector<std::string>& names);
  /// A finished row. Saves all if that was not done for a second.
  void add(const Row& row);
  /// Rows of this run so far.
  std::vector<Row> rows() const;
  /// Writes results.json; `over`: without rows that still wait. Empty, or why it cannot be written: a full disk must
  /// not end a run.
  std::string save(bool over = false);

  const std::string& directory() const { return directory_; }

 private:
  std::vector<Row> ordered() const;
  std::string save_locked(bool over);

  std::string directory_;
  int lock_ = -1;
  mutable std::mutex mutex_;
  nlohmann::json context_;
  std::vector<std::string> order_;
  std::map<std::string, Row> finished_;
  std::vector<Row> waiting_;
  double saved_ = 0.0;  ///< seconds of the steady clock
};

}  // namespace penumbra
