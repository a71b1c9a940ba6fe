#include "harness/commands/page_script.h"

#include <fmt/format.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "harness/measure/child_process.h"
#include "scenes/data_folder.h"
#include "scenes/error.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr double patience_s = 3600.0;

/// The folder above the data: of the sources, or share/penumbra of an installation.
fs::path root() {
  return fs::path(data_folder() + "/..").lexically_normal();
}

std::string requirements() {
  const fs::path own = root() / "scripts/report/requirements.txt";
  return (fs::exists(own) ? own : root() / "scripts/requirements.txt").string();
}

/// Passes lines on, but for a traceback that says that a package is missing.
class Complaints {
 public:
  void add(std::string_view line) {
    if (line.starts_with("Traceback (most recent call last)")) flush(), holding_ = true;
    constexpr std::string_view missing = "ModuleNotFoundError: No module named '";
    if (line.starts_with(missing)) missing_ = line.substr(missing.size(), line.rfind('\'') - missing.size());
    held_.append(line).append("\n");
    if (!holding_) flush();
  }
  void flush() {
    std::fputs(held_.c_str(), stderr);
    held_.clear();
    holding_ = false;
  }
  const std::string& missing() const { return missing_; }

 private:
  bool holding_ = false;
  std::string held_, missing_;
};

}  // namespace

std::string page_python() {
  if (const char* given = std::getenv("PENUMBRA_PYTHON"); given && *given) return given;
  const fs::path own = root() / ".venv/bin/python";
  return fs::exists(own) ? own.string() : "python3";
}

int run_page_script(const std::vector<std::string>& arguments) {
  const fs::path script = root() / "scripts/report/report.py";
  if (!fs::exists(script)) throw Error("what makes pages is missing: no {}", script.string());
  const std::string python = page_python();
  std::string command = "exec " + shell_word(python) + " " + shell_word(script.string());
  for (const std::string& word : arguments) command += " " + shell_word(word);
  Complaints complaints;
  const CommandEnd end =
      run_command(command + " 2>&1", ".", patience_s, [&](std::string_view line) { complaints.add(line); });
  const bool good = end.fault().empty();
  if (!good && !complaints.missing().empty())
    throw Error("{} lacks the package {}; install what {} lists: {} -m pip install -r {}", python, complaints.missing(),
                requirements(), shell_word(python), shell_word(requirements()));
  complaints.flush();
  const int code = !end.timed_out && WIFEXITED(end.status) ? WEXITSTATUS(end.status) : -1;
  if (code == 126 || code == 127)  // of the shell
    throw Error("pages are made by Python, and {} cannot be run; set PENUMBRA_PYTHON to one, or install python3",
                python);
  if (code >= 0) return code;
  throw std::runtime_error(fmt::format("{}: {} {}", python, script.string(), end.fault()));
}

}  // namespace penumbra
