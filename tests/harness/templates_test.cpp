// The documented formats of scenes and suites: what they say is what the readers take, and they leave nothing out.
#include "harness/commands/templates.h"
#include "harness/catalogue/catalogue.h"

#include <gmock/gmock.h>

#include <regex>
#include <sstream>

#include "harness/measure/suite.h"
#include "harness/report/published_times.h"
#include "scenes/image.h"
#include "tests/support.h"

namespace penumbra {
namespace {

using Lines = std::vector<std::string>;

Lines lines_of(const std::string& text) {
  Lines lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::string joined(const Lines& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

bool is_hidden_key(const std::string& line) {
  return std::regex_search(line, std::regex("^#[a-z_]+ = "));
}
bool is_hidden_header(const std::string& line) {
  return line.starts_with("#[");
}
/// "mesh" of "#mesh = ..." and "mesh = ..."; "" of anything else.
std::string key_of(const std::string& line) {
  std::smatch match;
  return std::regex_search(line, match, std::regex("^#?([a-z_]+) = ")) ? match[1].str() : "";
}

/// Removes the shown line of a key, in the table that holds line `at` or, without one, anywhere.
void hide(Lines& lines, const std::string& key, std::size_t at) {
  const auto is_header = [&](std::size_t k) { return lines[k].starts_with("["); };
  std::size_t first = at, last = at;
  while (first > 0 && !is_header(first)) --first;
  while (last + 1 < lines.size() && !is_header(last + 1)) ++last;
  for (std::size_t k = first; k <= last; ++k)
    if (k != at && lines[k].starts_with(key + " = ")) lines[k].clear();
}

/// The template with one hidden key, or one hidden table, shown in place of what it replaces.
std::vector<Lines> cases_of(const Lines& lines) {
  std::vector<Lines> cases;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    Lines shown = lines;
    if (is_hidden_header(lines[k])) {
      std::size_t end = k;
      while (end < lines.size() && !lines[end].empty()) {
        if (is_hidden_header(lines[end]) || is_hidden_key(lines[end])) shown[end].erase(0, 1);
        ++end;
      }
      if (lines[k].starts_with("#[receivers.camera]")) hide(shown, "plane", k - 1);
      cases.push_back(shown);
      k = end;
    } else if (is_hidden_key(lines[k])) {
      shown[k].erase(0, 1);
      hide(shown, key_of(lines[k]), k);
      if (key_of(lines[k]) == "vertices") hide(shown, "plane", k);
      cases.push_back(shown);
    }
  }
  return cases;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

class Templates : public testing::Test {
 protected:
  Templates() {
    folder_.write("my-mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    save_spheres(folder_.path() + "/spheres.json", SphereSet{{{vec3(0.0f), 0.5f}}}, dvec3(0.0));
    ChannelImage light{8, 4, {"light.R", "light.G", "light.B"}, std::vector<float>(8 * 4 * 3, 1.0f), {}};
    save_channels(folder_.path() + "/my-light.exr", light);
  }
  std::string scene_error(const std::string& text) const {
    SphereChoice choice;
    choice.fitted = false;
    return test::error_of([&] { load_scene(folder_.write("scene.toml", text), choice); });
  }
  std::string suite_error(const std::string& text) const {
    return test::error_of([&] { load_suite(folder_.write("suite.toml", text), registry_, 0); });
  }
  /// Every key that the reader knows where it meets an unknown one is in the template.
  static void expect_documented(const std::string& error, const std::string& text) {
    const auto at = error.find("allowed here: ");
    ASSERT_NE(at, std::string::npos) << error;
    std::istringstream names(error.substr(at + std::string("allowed here: ").size()));
    for (std::string name; names >> name;) {
      if (name.ends_with(",")) name.pop_back();
      if (name == "nonsense") continue;
      EXPECT_TRUE(std::regex_search(text, std::regex("\\b" + name + " = |\\[+([a-z]+\\.)?" + name + "\\]")))
          << "undocumented: " << name << " (" << error << ")";
    }
  }
  const Registry registry_ = make_registry();
  test::TemporaryFolder folder_;
};

TEST_F(Templates, EveryDocumentedKeyOfASceneIsRead) {
  EXPECT_EQ(scene_error(scene_template()), "");
  const std::vector<Lines> cases = cases_of(lines_of(scene_template()));
  EXPECT_GE(cases.size(), 15u);
  for (const Lines& lines : cases) {
    std::string text = joined(lines);
    if (text.find("\nseed = ") != std::string::npos) text = replaced(text, "\"torus-knot\"", "\"primitives\"");
    if (text.find("\nmapping = ") != std::string::npos || text.find("\nlayer = ") != std::string::npos)
      text = replaced(text, "environment = \"softbox\"", "environment = \"my-light.exr\"");
    if (const auto entity = text.find("\n[[entity]]"); entity != std::string::npos)
      text.erase(text.find("[occluder]"), entity - text.find("[occluder]"));
    if (text.find("\n[[mirror]]") != std::string::npos)
      text = replaced(text, "plane = { half_extent",
                      "camera = { eye = [0, 1, 1], target = [0, 0, 0], width = 4, height = 4 } #");
    EXPECT_EQ(scene_error(text), "") << text;
  }
}

TEST_F(Templates, EveryKeyOfASceneIsDocumented) {
  const std::string text = scene_template();
  const std::string bare =
      "[occluder]\nmesh = \"box\"\n[receivers]\nplane = { half_extent = 1.0, resolution = 4 }\n[light]\n"
      "environment = \"constant\"\n";
  const auto with = [&](const std::string& from, const std::string& to) {
    return scene_error(replaced(bare, from, to));
  };
  for (const char* table : {"[occluder]\n", "[receivers]\n", "[light]\n"})
    expect_documented(with(table, std::string(table) + "nonsense = 1\n"), text);
  expect_documented(scene_error("nonsense = 1\n" + bare), text);
  expect_documented(scene_error(bare + "[motion]\nkind = \"bend\"\nnonsense = 1\n"), text);
  expect_documented(with("\"box\"\n", "\"box\"\nfit = { nonsense = 1 }\n"), text);
  expect_documented(with("resolution = 4", "resolution = 4, nonsense = 1"), text);
  expect_documented(with("plane = { half_extent = 1.0, resolution = 4 }",
                         "camera = { eye = [0, 1, 1], target = [0, 0, 0], width = 4, height = 4, nonsense = 1 }"),
                    text);
  for (const char* mirror : {"nonsense = 1\nsphere = { centre = [0, 0, 0], radius = 1 }",
                             "sphere = { nonsense = 1, centre = [0, 0, 0], radius = 1 }",
                             "plane = { nonsense = 1, centre = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0] }"})
    expect_documented(scene_error(bare + "[[mirror]]\n" + mirror + "\n"), text);
  for (const char* lamp : {"normal = [0, -1, 0], radius = 1.0", "edge_u = [1, 0, 0], edge_v = [0, 0, 1]"})
    expect_documented(
        with("environment = \"constant\"", fmt::format("area = {{ centre = [0, 9, 0], {}, nonsense = 1 }}", lamp)),
        text);
}

TEST_F(Templates, EveryDocumentedKeyOfASuiteIsRead) {
  EXPECT_EQ(suite_error(suite_template()), "");
  for (const Lines& lines : cases_of(lines_of(suite_template()))) {
    std::string text = joined(lines);
    if (text.find("\n[[published_time]]") != std::string::npos) {
      text = replaced(text, "#published = ", "published = ");
      const Suite suite = load_suite(folder_.write("suite.toml", text), registry_, 0);
      ASSERT_EQ(suite.published_times.size(), 1u);
      EXPECT_EQ(test::error_of([&] {
                  check_published_times({suite.name, suite.published, suite.published_times});
                }),
                "");
    }
    EXPECT_EQ(suite_error(text), "") << text;
  }
}

TEST_F(Templates, EveryKeyOfASuiteIsDocumented) {
  const std::string text = suite_template(), technique = "[[technique]]\nname = \"ray-traced\"\n";
  const std::string head = "scenes = [\"a\"]\n";
  expect_documented(suite_error("nonsense = 1\n" + head + technique), text);
  expect_documented(suite_error(head + technique + "nonsense = 1\n"), text);
  expect_documented(suite_error(head + "baseline = { name = \"ray-traced\", nonsense = 1 }\n" + technique), text);
  expect_documented(suite_error(head + "published = \"x\"\n" + technique +
                                "[[published_time]]\ntable = \"1\"\nsubject = \"b\"\nvariant = \"c\"\nrow = \"d\"\n"
                                "nonsense = 1\n"),
                    text);
}

TEST_F(Templates, ChangeOnlyTheMeshOfOnesOwn) {
  const std::string mesh = folder_.path() + "/my \"mesh\".obj";
  std::filesystem::copy_file(folder_.path() + "/my-mesh.obj", mesh);
  for (const bool closed : {true, false}) {
    SphereChoice choice;
    choice.fitted = false;
    const std::string file = folder_.write("own.toml", scene_template(mesh, closed));
    EXPECT_EQ(load_scene(file, choice).mesh.triangles.size(), 4u);
    EXPECT_EQ(load_scene(file, choice).objective.empty(), !closed) << "an open mesh has no spheres to fit";
  }
}

std::string file_of_ours(const std::string& path) {
  return test::read_text(std::string(PENUMBRA_TEST_DATA) + "/../../" + path);
}

/// The first block of a page that is written in `language`.
std::string quoted_in(const std::string& page, const std::string& language = "toml") {
  const std::string text = file_of_ours(page), opening = "```" + language + "\n";
  const auto from = text.find(opening) + opening.size();
  return text.substr(from, text.find("```", from) - from);
}

TEST_F(Templates, DocsQuoteThem) {
  EXPECT_EQ(quoted_in("docs/scene-files.md"), scene_template());
  EXPECT_EQ(quoted_in("docs/suites.md"), suite_template());
  EXPECT_EQ(quoted_in("CONTRIBUTING.md", "cpp"), file_of_ours("techniques/constant/constant.cpp"));
}

}  // namespace
}  // namespace penumbra
