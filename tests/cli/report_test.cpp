// penumbra report, with a shell script in the place of Python: what it is told, and what becomes of what it says.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/cli/command_line.h"
#include "tests/harness/trade_rows.h"

#include "harness/results/results_file.h"

namespace penumbra {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class ReportCommand : public test::CommandLine {
 protected:
  ReportCommand() {
    for (const char* part : {"/scenes", "/scripts/report", "/.venv/bin"})
      std::filesystem::create_directories(folder_.path() + part);
    folder_.write("scenes/assets.toml", "");
    folder_.write("scripts/report/report.py", "");
    setenv("PENUMBRA_DATA", (folder_.path() + "/scenes").c_str(), 1);
    setenv("PENUMBRA_PYTHON", (folder_.path() + "/python").c_str(), 1);
    setenv("TOLD", folder_.path().c_str(), 1);
  }
  ~ReportCommand() override {
    for (const char* name : {"PENUMBRA_DATA", "PENUMBRA_PYTHON", "TOLD"}) unsetenv(name);
  }
  /// What runs in the place of Python: notes its words, a line each, and keeps a copy of every JSON it is given.
  void python(const std::string& rest) const {
    const std::string file = folder_.write("python",
                                           "#!/bin/sh\nprintf '%s\\n' \"$@\" >\"$TOLD/words.txt\"\nshift\n"
                                           "for word; do case \"$word\" in /*/penumbra-report-*.json) "
                                           "cp \"$word\" \"$TOLD/$(basename \"$word\")\" ;; esac; done\n" +
                                               rest + "\n");
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  }
  std::vector<std::string> words() const {
    std::vector<std::string> all;
    std::ifstream in(folder_.path() + "/words.txt");
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
  }
  std::string after(const std::string& option) const {
    const auto all = words();
    const auto at = std::find(all.begin(), all.end(), option);
    return at == all.end() || at + 1 == all.end() ? "" : at[1];
  }
  json told(const std::string& name) const { return json::parse(test::read_text(folder_.path() + "/" + name)); }
  /// A folder of results with three rows.
  std::string results(const std::string& name, double factor = 1.0) const {
    Results results;
    for (const auto& [ms, error, count] : {std::tuple(1.0, 0.1, 1), {25.0, 0.02, 25}, {100.0, 0.01, 100}}) {
      results.rows.push_back(test::trade_row("ray-traced", factor * ms, error));
      results.rows.back().id.parameters["rays"] = count;
    }
    const std::string folder = folder_.path() + "/" + name;
    std::filesystem::create_directory(folder);
    write_results(folder, results);
    return folder;
  }
};

TEST_F(ReportCommand, TellsTheScriptWhereEverythingIs) {
  python("echo page >\"$6\"");
  const std::string run_folder = results("a run");
  const test::Outcome o = run("report '" + run_folder + "'");
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(o.out, run_folder + "/report.html\n");
  EXPECT_EQ(o.err, "");
  EXPECT_EQ(words().at(0), folder_.path() + "/scripts/report/report.py");
  EXPECT_EQ(words().size(), 7u);
  EXPECT_EQ(after("--results"), run_folder + "/results.json");
  EXPECT_EQ(after("--out"), run_folder + "/report.html");
  EXPECT_EQ(told("figures.json"), json::parse(run("report --figures '" + run_folder + "/results.json'").out));
  EXPECT_EQ(test::read_text(run_folder + "/report.html"), "page\n");
  EXPECT_FALSE(std::filesystem::exists(after("--figures"))) << "what is passed is gone";
}

TEST_F(ReportCommand, PrintsFigures) {
  const json figures = json::parse(run("report --figures " + results("a")).out);
  EXPECT_EQ(figures["scenes"][0]["rows"].size(), 3u);
  EXPECT_TRUE(words().empty()) << "without Python";
}

TEST_F(ReportCommand, ComparesAndLooksBack) {
  python("");
  const std::string a = results("a"), b = results("b", 2.0), c = results("c");
  const test::Outcome o = run("report --compare " + a + " " + b + " --history " + c + " " + a + "/results.json --out " +
                              folder_.path() + "/page.html --paper " + folder_.path() + "/paper");
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(o.out, folder_.path() + "/page.html\n");
  EXPECT_EQ(after("--results"), b + "/results.json");
  EXPECT_EQ(after("--base"), a + "/results.json");
  EXPECT_EQ(after("--history"), c + "/results.json");
  EXPECT_EQ(after(c + "/results.json"), a + "/results.json");
  EXPECT_EQ(after("--paper"), folder_.path() + "/paper");
  EXPECT_EQ(told("comparison.json"), json::parse(run("compare --json " + a + " " + b).out));
}

TEST_F(ReportCommand, PassesOnWhatTheScriptSaysAndHowItEnds) {
  python("echo on its way; echo in trouble >&2; exit 7");
  const test::Outcome o = run("report " + results("a"));
  EXPECT_EQ(o.code, 7);
  EXPECT_EQ(o.out, "") << "there is no page to name";
  EXPECT_EQ(o.err, "on its way\nin trouble\n");
}

TEST_F(ReportCommand, ACrashIsSaid) {
  python("kill -SEGV $$");
  const test::Outcome o = run("report " + results("a"));
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("crashed (signal 11"));
}

TEST_F(ReportCommand, AMissingPackageIsOneLine) {
  python(
      "echo 'Traceback (most recent call last):' >&2; echo '  File \"x\", line 1' >&2; "
      "echo \"ModuleNotFoundError: No module named 'plotly'\" >&2; exit 1");
  results("a");
  expect_error("report " + folder_.path() + "/a", "lacks the package plotly");
  EXPECT_THAT(run("report " + folder_.path() + "/a").err, HasSubstr("requirements.txt"));
}

TEST_F(ReportCommand, AnotherTracebackIsPassedOnWhole) {
  python("echo before; echo 'Traceback (most recent call last):' >&2; echo 'KeyError: 3' >&2; exit 1");
  const test::Outcome o = run("report " + results("a"));
  EXPECT_EQ(o.code, 1);
  EXPECT_EQ(o.err, "before\nTraceback (most recent call last):\nKeyError: 3\n");
}

TEST_F(ReportCommand, PythonThatIsNotThereIsSaid) {
  results("a");
  expect_error("report " + folder_.path() + "/a", "PENUMBRA_PYTHON");
}

TEST_F(ReportCommand, TheVirtualEnvironmentBesideTheDataComesBeforePath) {
  python("echo in the environment");
  unsetenv("PENUMBRA_PYTHON");
  std::filesystem::rename(folder_.path() + "/python", folder_.path() + "/.venv/bin/python");
  EXPECT_EQ(run("report " + results("a")).err, "in the environment\n");
  python("echo of the path");
  std::filesystem::rename(folder_.path() + "/python", folder_.path() + "/python3");
  EXPECT_EQ(run("report " + results("b"), "PATH=" + folder_.path() + ":$PATH").err, "in the environment\n");
  std::filesystem::remove(folder_.path() + "/.venv/bin/python");
  EXPECT_EQ(run("report " + results("b"), "PATH=" + folder_.path() + ":$PATH").err, "of the path\n");
}

TEST_F(ReportCommand, AMissingScriptIsSaid) {
  python("");
  std::filesystem::remove(folder_.path() + "/scripts/report/report.py");
  expect_error("report " + results("a"), "scripts/report/report.py");
}

TEST_F(ReportCommand, WrongInputIsSaidAsCompareSaysIt) {
  python("");
  const std::string a = results("a"), text = test::read_text(a + "/results.json");
  expect_error("report " + folder_.path() + "/nowhere", "nowhere");
  expect_error("report " + folder_.write("empty.json", ""), "empty.json");
  expect_error("report --figures " + folder_.write("cut.json", text.substr(0, text.size() / 2)), "cut.json");
  expect_error("report --compare " + folder_.path() + "/cut.json " + a, "cut.json");
  expect_error("report " + a + " --history " + folder_.path() + "/nowhere", "nowhere");
  expect_error("report", "results");
  expect_error("report --figures --open " + a, "--figures");
  std::string other = text;
  for (std::size_t at = 0; (at = other.find("ray-traced", at)) != std::string::npos; ++at) other[at] = 'R';
  expect_error("report --compare " + folder_.write("other.json", other) + " " + a, "no row in common");
  EXPECT_TRUE(words().empty()) << "the script is not run";
}

TEST_F(ReportCommand, OpensThePage) {
  python("");
  const std::string opener = folder_.write("xdg-open", "#!/bin/sh\necho \"$1\" >\"$TOLD/opened.txt\"\n");
  std::filesystem::permissions(opener, std::filesystem::perms::owner_all);
  const std::string a = results("a");
  const test::Outcome o = run("report --open " + a, "PATH=" + folder_.path() + ":$PATH");
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(o.out, a + "/report.html\n");
  const std::string opened = folder_.path() + "/opened.txt";
  for (int tries = 0; tries < 500 && test::read_text(opened).empty(); ++tries) usleep(10000);
  EXPECT_EQ(test::read_text(opened), a + "/report.html\n");
}

}  // namespace
}  // namespace penumbra
