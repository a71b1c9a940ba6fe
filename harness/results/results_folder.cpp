#include "harness/results/results_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "scenes/error.h"
#include "scenes/storage/atomic_write.h"

namespace penumbra {
namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::vector<Row> rows_not_in(const std::map<std::string, Row>& finished, const std::vector<Row>& rows) {
  std::vector<Row> others;
  for (const Row& row : rows)
    if (!finished.contains(row.id.name())) others.push_back(row);
  return others;
}

/// Held until it is closed, be it by the end of the process.
int locked_file(const std::string& path, const std::string& directory) {
  const int file = open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644);
  if (file < 0) throw Error("{}: cannot be written", path);
  if (flock(file, LOCK_EX | LOCK_NB) == 0) return file;
  close(file);
  throw Error("{}: another run is writing to this folder; wait for it, or choose another with --out", directory);
}

}  // namespace

ResultsFolder::ResultsFolder(std::string directory) : directory_(std::move(directory)) {
  if (directory_.empty()) throw Error("--out is empty; allowed is a folder");
  make_folder(directory_ + "/images");
  lock_ = locked_file(directory_ + "/.lock", directory_);
}

ResultsFolder::~ResultsFolder() {
  close(lock_);
}

void ResultsFolder::begin(nlohmann::json context, const std::vector<Row>& waiting) {
  const std::lock_guard guard(mutex_);
  context_ = std::move(context);
  waiting_ = waiting;
  order_.clear(), finished_.clear();
}

void ResultsFolder::expect(const std::vector<std::string>& names) {
  const std::lock_guard guard(mutex_);
  order_.insert(order_.end(), names.begin(), names.end());
}

void ResultsFolder::add(const Row& row) {
  {
    const std::lock_guard guard(mutex_);
    finished_.insert_or_assign(row.id.name(), row);
    unsaved_ = true;
  }
  save_if_due();
}

void ResultsFolder::save_if_due() {
  const std::lock_guard guard(mutex_);
  if (unsaved_ && now() - saved_ > 1.0) save_locked();
}

std::vector<Row> ResultsFolder::ordered() const {
  std::vector<Row> rows;
  for (const std::string& name : order_)
    if (const auto at = finished_.find(name); at != finished_.end()) rows.push_back(at->second);
  return rows;
}

nlohmann::json ResultsFolder::context() const {
  const std::lock_guard guard(mutex_);
  return context_;
}

std::vector<Row> ResultsFolder::rows() const {
  const std::lock_guard guard(mutex_);
  return ordered();
}

std::vector<Row> ResultsFolder::all_rows() const {
  const std::lock_guard guard(mutex_);
  return merged(ordered(), rows_not_in(finished_, waiting_));
}

std::string ResultsFolder::save() {
  const std::lock_guard guard(mutex_);
  return save_locked();
}

std::string ResultsFolder::save_locked() {
  saved_ = now();
  unsaved_ = false;
  try {
    write_results(directory_, {context_, merged(ordered(), rows_not_in(finished_, waiting_))});
    return "";
  } catch (const std::exception& e) {
    return e.what();
  }
}

}  // namespace penumbra
