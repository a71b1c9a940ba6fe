// A registry of techniques that misbehave, and a folder to run suites in.
#pragma once

#include <csignal>

#include "harness/commands/run.h"
#include "harness/results/results_folder.h"
#include "scenes/error.h"
#include "tests/support.h"

namespace penumbra::test {

/// Radiance 1 everywhere, or whatever the mode says.
class Fake : public Technique {
 public:
  explicit Fake(std::string mode) : mode_(std::move(mode)) {}
  void prepare(const Scene&, const Light&) override {
    if (mode_ == "spy") seen = read_text(watched);
    if (mode_ == "signals" && --signals_at == 0) raise(SIGTERM);
    if (mode_ == "throws") throw std::runtime_error("out of ideas");
    if (mode_ == "unsupported") throw Unsupported("not this scene");
  }
  void update(const Frame&) override { ++frames_; }
  void shade(View<vec3> radiance) override {
    if (mode_ == "throws-later" && frames_ > 3) throw std::runtime_error("tired");
    for (std::size_t i = 0; i < radiance.size(); ++i)
      radiance[i] = vec3(mode_ == "wrong" ? 0.9f : mode_ == "nan" ? NAN : mode_ == "black" ? 0.0f : 1.0f);
  }
  Footprint footprint() const override { return {1, 2, 3}; }

  static inline int signals_at = 0;         ///< "signals": at which preparation from now on
  static inline std::string watched, seen;  ///< "spy": what the file held when the last scene was prepared

 private:
  std::string mode_;
  int frames_ = 0;
};

inline Entry fake(const std::string& name, Backend backend, const std::string& mode) {
  Entry e;
  e.name = name, e.backend = backend;
  e.lights = {true, mode != "no-area"};
  e.make = [mode](const Parameters&) { return std::make_unique<Fake>(mode); };
  return e;
}

inline std::string scene_named(const std::string& name, const std::string& light, const std::string& spheres = "") {
  return "name = \"" + name + "\"\n[occluder]\nmesh = \"box\"\n" + spheres +
         "[receivers]\nplane = { half_extent = 1.0, resolution = 16, y = -1.0 }\n[light]\n" + light + "\n";
}

inline constexpr const char* constant = "environment = \"constant\"";

/// A suite of several scenes and one technique.
inline std::string suite_of(const std::vector<std::string>& scenes, const std::string& technique = "good",
                            const std::string& more = "") {
  std::string list;
  for (const std::string& scene : scenes) list += (list.empty() ? "\"" : ", \"") + scene + "\"";
  return "name = \"t\"\nscenes = [" + list + "]\ntruth_noise = 0.05\n" + more + "[[technique]]\nname = \"" + technique +
         "\"\nbackend = \"scalar\"\n";
}

class Runs : public testing::Test {
 protected:
  Runs() {
    setenv("PENUMBRA_CACHE", (folder_.path() + "/cache").c_str(), 1);
    scene_ = folder_.write("scene.toml",
                           "name = \"tiny\"\n[occluder]\nmesh = \"box\"\n[receivers]\nplane = { half_extent = 1.0, "
                           "resolution = 16, y = -1.0 }\n"
                           "[light]\nenvironment = \"constant\"\n");
    for (const char* mode : {"good", "throws", "throws-later", "nan", "unsupported", "black", "spy"})
      registry_.add(fake(mode, Backend::scalar, mode));
    registry_.add(fake("good", Backend::simd, "wrong"));
    Entry absent = fake("absent", Backend::simd, "good");
    absent.unavailable = "no device";
    registry_.add(absent);
  }
  ~Runs() override { unsetenv("PENUMBRA_CACHE"); }

  std::string suite_text(const std::vector<std::pair<std::string, std::string>>& techniques) const {
    std::string text = "name = \"t\"\nscenes = [\"" + scene_ + "\"]\ntruth_noise = 0.05\n";
    for (const auto& [name, backend] : techniques)
      text += "[[technique]]\nname = \"" + name + "\"\nbackend = \"" + backend + "\"\n";
    return text;
  }
  int run(const std::string& text, bool resume = false, const std::string& filter = ".*") {
    const Suite suite = load_suite(folder_.write("suite.toml", text), registry_, 1);
    testing::internal::CaptureStdout();
    const int code = run_suite(suite, registry_, {out(), filter, 2, resume});
    screen_ = testing::internal::GetCapturedStdout();
    table_ = std::filesystem::exists(out() + "/table.md") ? read_text(out() + "/table.md") : screen_;
    return code;
  }
  std::string out() const { return folder_.path() + "/out"; }
  Row row(const std::string& technique, const std::string& backend = "scalar") const {
    for (const Row& r : read_results(out()).rows)
      if (r.id.technique == technique && r.id.backend == backend) return r;
    ADD_FAILURE() << "no row for " << technique;
    return {};
  }

  TemporaryFolder folder_;
  std::string scene_, screen_, table_;
  Registry registry_;
};

}  // namespace penumbra::test
