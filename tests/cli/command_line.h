// The program in a process of its own, with a cache and files of its own.
#pragma once

#include <sys/wait.h>

#include <cstdlib>

#include "tests/support.h"

namespace penumbra::test {

struct Outcome {
  int code;
  std::string out, err;
};

class CommandLine : public ::testing::Test {
 protected:
  /// `environment`: "NAME=value" before the program.
  Outcome run(const std::string& arguments, const std::string& environment = "") const {
    const std::string command = "PENUMBRA_CACHE=" + folder_.path() + "/cache " + environment +
                                " " PENUMBRA_PROGRAM " " + arguments + " >" + folder_.path() + "/out.txt 2>" +
                                folder_.path() + "/err.txt";
    const int status = std::system(command.c_str());
    return {WEXITSTATUS(status), read_text(folder_.path() + "/out.txt"), read_text(folder_.path() + "/err.txt")};
  }
  void expect_error(const std::string& arguments, const std::string& part) const {
    const Outcome o = run(arguments);
    EXPECT_EQ(o.code, 2) << arguments;
    EXPECT_NE(o.err.find(part), std::string::npos) << arguments << ": " << o.err;
    int lines = 0;  // progress may stand above
    for (std::size_t at = 0; (at = o.err.find("penumbra: ", at)) != std::string::npos; ++at) ++lines;
    EXPECT_EQ(lines, 1) << o.err;
    EXPECT_EQ(o.err.find('\n', o.err.find("penumbra: ")), o.err.size() - 1) << o.err;
  }
  std::string tiny_scene() const {
    return folder_.write(
        "tiny.toml",
        "name = \"tiny\"\n[occluder]\nmesh = \"box\"\nspheres = 4\n[receivers]\n"
        "plane = { half_extent = 1.0, resolution = 16, y = -1.0 }\n[light]\nenvironment = \"constant\"\n");
  }
  TemporaryFolder folder_;
};

}  // namespace penumbra::test
