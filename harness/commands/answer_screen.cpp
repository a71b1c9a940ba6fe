#include "harness/commands/answer_screen.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "harness/report/row_text.h"
#include "harness/report/screen.h"
#include "harness/results/row_json.h"
#include "harness/results/text.h"

namespace penumbra {
namespace {

constexpr std::size_t most_options = 14;

std::string milliseconds(const Row& row) {
  return three_digits(row.timing.median_frame_ms());
}

std::string two_digits(double value) {
  return value >= 10.0 ? fmt::format("{:.0f}", value) : fmt::format("{:.2g}", value);
}

/// What makes up most of the error; the spheres' share can be lessened by more of them.
std::string parts_text(const Option& option, int room) {
  std::string text;
  const double whole = option.row.score.truth_error().value_or(0.0);
  for (const ErrorPart& part : option.parts) {
    if (part.rel_rmse < 0.25 * whole) continue;
    const std::string more =
        fmt::format("{}{} {}", text.empty() ? "" : ", ", two_digits(100.0 * part.rel_rmse), part.name);
    if (!text.empty() && columns_of(text + more) > room) break;  // the smaller ones are in the JSON
    text += more;
  }
  return text;
}

std::string title(const Answer& a) {
  return fmt::format("{}: {} receivers, {} thread{}{}{}", a.scene, with_thousands(a.receivers), a.threads,
                     a.threads == 1 ? "" : "s",
                     a.rel_noise ? fmt::format(", truth ±{} %", three_digits(100.0 * *a.rel_noise)) : "",
                     a.moving ? ", the mesh moves" : "");
}

std::string verdict(const Answer& a) {
  if (a.options.empty()) return fmt::format("Within {}: nothing can shade this scene", a.bound.text());
  const Option& o = a.options.front();
  const std::string figures = fmt::format("{}   {} ms ±{:.2g}   {} %", o.label, milliseconds(o.row),
                                          o.row.timing.frame_spread_ms(), truth_text(o.row));
  return o.within ? fmt::format("Within {}: {}", a.bound.text(), figures)
                  : fmt::format("Nothing is within {} here. Nearest: {}", a.bound.text(), figures);
}

/// What the answer does not hold for.
std::string caveat(const Answer& a) {
  const Option* o = a.best();
  if (!o || o->moving_ms < 0.0) return "";
  const double rest = o->row.timing.median_frame_ms();
  if (o->moving_ms < 3.0 * rest) return "";
  return fmt::format("Holds while the mesh rests: a frame in which it moves takes {} ms; --moving counts that",
                     three_digits(o->moving_ms));
}

std::string table(const Answer& a, int width) {
  const bool moves =
      !a.moving && std::any_of(a.options.begin(), a.options.end(), [](const Option& o) { return o.moving_ms >= 0.0; });
  TextTable table({{"technique", std::max(20, width - 33), Align::left},
                   {"ms", 7, Align::right},
                   {moves ? "moving ms" : "", 9, Align::right},
                   {"error %", 7, Align::right},
                   {"from", width, Align::left}},
                  width);
  int widest = 0;
  for (const Option& o : a.options) widest = std::max(widest, columns_of(o.label));
  const int room = width - std::min(widest, width - 33) - (moves ? 35 : 24);
  bool beyond = false;
  for (std::size_t k = 0; k < std::min(a.options.size(), most_options); ++k) {
    const Option& o = a.options[k];
    if (!o.within && !beyond && k > 0) table.line(fmt::format("not within {}:", a.bound.text()));
    beyond = beyond || !o.within;
    table.row({o.label, milliseconds(o.row), o.moving_ms < 0.0 ? "" : three_digits(o.moving_ms), truth_text(o.row),
               parts_text(o, room)});
  }
  return table.text();
}

nlohmann::json option_json(const Option& o) {
  const auto error = o.row.score.truth_error();
  nlohmann::json parts = nlohmann::json::array();
  for (const ErrorPart& part : o.parts) parts.push_back({{"name", part.name}, {"rel_rmse", part.rel_rmse}});
  nlohmann::json out = {{"label", o.label},
                        {"name", o.row.id.name()},
                        {"technique", o.row.id.technique},
                        {"backend", o.row.id.backend},
                        {"parameters", to_json(o.row.id.parameters)},
                        {"within", o.within},
                        {"frame_ms", o.row.timing.median_frame_ms()},
                        {"frame_spread_ms", o.row.timing.frame_spread_ms()},
                        {"prepare_ms", o.row.timing.prepare_ms},
                        {"rel_rmse", error ? nlohmann::json(*error) : nlohmann::json(nullptr)},
                        {"tie", o.row.score.errors.contains("truth") && o.row.score.errors.at("truth").tie()},
                        {"parts", parts}};
  out["spheres"] = o.row.id.reads_spheres ? nlohmann::json(o.row.id.spheres) : nlohmann::json(nullptr);
  out["moving_ms"] = o.moving_ms < 0.0 ? nlohmann::json(nullptr) : nlohmann::json(o.moving_ms);
  return out;
}

}  // namespace

std::string render_line(const Answer& a) {
  if (a.options.empty()) return "";
  const RowIdentity& id = a.options.front().row.id;
  std::string line =
      fmt::format("penumbra render {} --technique\x1f{} --backend\x1f{}", a.scene_file, id.technique, id.backend);
  if (id.reads_spheres && int(id.spheres) != a.scene_spheres.value_or(0))
    line += fmt::format(" --spheres\x1f{}", id.spheres);
  for (const auto& [name, value] : id.parameters)
    if (const auto at = id.defaults.find(name); at == id.defaults.end() || at->second != value)
      line += fmt::format(" -p\x1f{}={}", name, to_string(value));
  return line + " -o\x1fimage.png";
}

std::string screen_of(const Answer& a, int width) {
  std::string text;
  const auto say = [&](const std::string& words) { text += wrapped(words, width, 2) + "\n"; };
  text += cut_to_columns(title(a), width) + "\n" + cut_to_columns(verdict(a), width) + "\n";
  if (const std::string but = caveat(a); !but.empty()) say(but);
  text += "\n" + table(a, width);
  if (a.searched) {
    const Option& s = *a.searched;
    say(fmt::format("The search alone: {}, {} ms ±{:.2g}, {} %", s.label, milliseconds(s.row),
                    s.row.timing.frame_spread_ms(), truth_text(s.row)));
  }
  for (const Impossible& i : a.impossible)
    say(fmt::format("Not possible here: {} ({})", fmt::join(i.techniques, ", "), i.reason));
  if (!a.left_out.empty()) say(fmt::format("Left out: {}", fmt::join(a.left_out, "; ")));
  if (a.busy) say("This machine is busy: the times are those of a machine that had other work.");
  if (!a.options.empty()) text += wrapped_command("To see it: " + render_line(a), width) + "\n";
  say(fmt::format("Scene, and rows of all {} configurations tried ({:.0f} s): {}", a.looks, a.seconds, a.folder));
  return text;
}

nlohmann::json to_json(const Answer& a) {
  nlohmann::json out = {{"scene", a.scene},
                        {"scene_file", a.scene_file},
                        {"bound", {{a.bound.kind == Bound::Kind::error ? "rel_rmse" : "ms", a.bound.value}}},
                        {"within", a.best() != nullptr},
                        {"verdict", verdict(a)},
                        {"moving", a.moving},
                        {"receivers", a.receivers},
                        {"threads", a.threads},
                        {"rel_noise", a.rel_noise ? nlohmann::json(*a.rel_noise) : nlohmann::json(nullptr)},
                        {"options", nlohmann::json::array()},
                        {"impossible", nlohmann::json::array()},
                        {"left_out", a.left_out},
                        {"busy", a.busy},
                        {"truth_noise", a.truth_noise},
                        {"looks", a.looks},
                        {"seconds", a.seconds},
                        {"render", unbroken(render_line(a))}};
  for (const Option& o : a.options) out["options"].push_back(option_json(o));
  if (a.searched) out["searched"] = option_json(*a.searched);
  out["answer"] = a.best() ? out["options"][0] : nlohmann::json(nullptr);
  out["nearest"] = a.options.empty() ? nlohmann::json(nullptr) : out["options"][0];
  for (const Impossible& i : a.impossible)
    out["impossible"].push_back({{"reason", i.reason}, {"techniques", i.techniques}});
  return out;
}

}  // namespace penumbra
