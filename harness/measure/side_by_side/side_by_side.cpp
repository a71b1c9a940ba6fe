#include "harness/measure/side_by_side/side_by_side.h"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>

#include "harness/measure/child_process.h"
#include "harness/measure/interrupt.h"
#include "harness/measure/side_by_side/row_server.h"
#include "harness/measure/timing.h"
#include "scenes/error.h"
#include "scenes/storage/atomic_write.h"
#include "scenes/storage/content_key.h"

namespace penumbra {
namespace {

using nlohmann::json;

constexpr double patience_s = 3600.0;  // for one answer
// Short samples in quick alternation: what the machine does to one, it does to its neighbour.
constexpr double sample_ms = 2.0;
constexpr double launch_ms = 1000.0;  // of timing a row: about what it takes to start and prepare it
constexpr int least_turns = 5, most_turns = 250;
constexpr const char* folders[] = {"base", "new"};

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Options that both ways of running a program take.
std::string command_of(const SideBySide& plan, int side, const std::string& verb) {
  const std::string program = std::filesystem::absolute(plan.programs[side]).string();
  std::string command =
      shell_word(program) + " " + verb + " " + shell_word(plan.suite) + " --filter " + shell_word(plan.filter);
  return plan.threads > 0 ? command + fmt::format(" --threads {}", plan.threads) : command;
}

/// Scores every row of one program.
Results score(const SideBySide& plan, int side) {
  const std::string folder = std::filesystem::absolute(plan.directory + "/" + folders[side]).string();
  std::filesystem::remove(folder + "/results.json");
  const std::string command = command_of(plan, side, "run") + " --repetitions 1 --out " + shell_word(folder);
  const CommandEnd end = run_command("exec " + command, ".", 24.0 * patience_s, [](std::string_view) {});
  Results results = read_results(folder);
  if (results.rows.empty()) throw Error("{}: {} measured nothing: it {}", plan.programs[side], plan.suite, end.fault());
  return results;
}

/// One program, started to time rows.
class RowClient {
 public:
  /// `processor` below 0: any.
  RowClient(const SideBySide& plan, int side, int processor)
      : program_(plan.programs[side]),
        talk_("exec " + command_of(plan, side, "serve-rows") +
                  (processor < 0 ? "" : fmt::format(" --processor {}", processor)),
              ".") {
    const json hello = greeting();
    if (hello.value("protocol", 0) != row_server_protocol)
      throw Error("{}: speaks version {} of side-by-side measuring, and this is {}", program_,
                  hello.value("protocol", 0), row_server_protocol);
  }

  json ask(const json& question) {
    json answer = parsed(talk_.ask(question.dump(), patience_s));
    if (answer.contains("error")) throw std::runtime_error(answer.at("error").get<std::string>());
    return answer;
  }

 private:
  json greeting() {
    try {
      return parsed(talk_.listen(patience_s));
    } catch (const std::runtime_error& e) {
      throw Error("{} cannot be timed row by row ({}); is it older than `compare --ab`?", program_, e.what());
    }
  }
  json parsed(const std::string& line) const {
    json value = json::parse(line, nullptr, false);
    if (!value.is_object()) throw std::runtime_error(fmt::format("{} said '{}'", program_, line.substr(0, 80)));
    return value;
  }
  std::string program_;
  Conversation talk_;
};

/// A row that both programs have.
struct Pair {
  Row* rows[2];  ///< their timings grow
  double spent_s = 0.0;
  bool open = true;
  long frames = 0;  ///< of a repetition
  int turns = 0;    ///< repetitions of a launch; 0: not known yet
  const std::string& scene() const { return rows[0]->id.scene; }
};

void add_repetition(const json& answer, long frames, int launch, Timing& timing) {
  const double update = answer.at("update_ms"), shade = answer.at("shade_ms");
  timing.iterations = frames;
  timing.update_ms.push_back(update), timing.shade_ms.push_back(shade), timing.frame_ms.push_back(update + shade);
  timing.cpu_ms.push_back(answer.at("cpu_ms"));
  timing.launch.push_back(launch);
  for (const json& stage : answer.at("stages")) {
    const std::string name = stage.at(0);
    auto at = std::find_if(timing.stages.begin(), timing.stages.end(), [&](const auto& s) { return s.name == name; });
    if (at == timing.stages.end()) at = timing.stages.insert(at, {name, {}});
    at->ms.push_back(stage.at(1));
  }
}

class Session {
 public:
  Session(const SideBySide& plan, Progress& progress) : plan_(plan), progress_(progress), random_(plan.seed) {}

  TwoResults run() {
    for (int side : {0, 1}) {
      progress_.step(fmt::format("scoring {} rows with {}", plan_.suite, plan_.programs[side]));
      results(side) = score(plan_, side);
    }
    begin();
    try {
      for (const int launches : launches_at_looks) {
        while (launch_ < launches && any_open()) launch();
        look();
      }
    } catch (const Interrupted&) {
      save();
      throw;
    }
    save();
    return std::move(both_);
  }

 private:
  Results& results(int side) { return side == 0 ? both_.base : both_.next; }

  /// Times of the run that scored are those of one process alone.
  void begin() {
    const Comparison common = compare(both_.base, both_.next, plan_.thresholds);
    if (common.rows.empty()) throw Error("{}: the two programs have no row in common", plan_.suite);
    const auto of = [](Results& all, const Row* row) { return &all.rows[std::size_t(row - all.rows.data())]; };
    for (const ComparedRow& row : common.rows)
      if (row.base->ok() && row.next->ok() && row.time.verdict != TimeComparison::Verdict::none &&
          row.base->timing.command_ms < 0.0)
        pairs_.push_back({{of(both_.base, row.base), of(both_.next, row.next)}});
    for (Pair& pair : pairs_)
      for (Row* row : pair.rows) {
        Timing fresh;
        fresh.prepare_ms = row->timing.prepare_ms, fresh.view_ms = row->timing.view_ms;
        row->timing = fresh;
      }
    ContentHash hash;
    hash.add_value(now_s());
    for (const int side : {0, 1})
      results(side).context["session"] = session_context(hash.digest(), int(std::size(launches_at_looks)));
    save();
  }

  bool any_open() const {
    return std::any_of(pairs_.begin(), pairs_.end(), [](const Pair& pair) { return pair.open; });
  }

  void launch() {
    std::map<std::string, std::vector<Pair*>> scenes;
    for (Pair& pair : pairs_) {
      pair.open &= launch_ < launches_at_looks[0] || pair.spent_s < plan_.budget_s;
      if (pair.open) scenes[pair.scene()].push_back(&pair);
    }
    ++launch_;
    for (auto& [scene, open] : scenes) {
      stop_if_interrupted();
      progress_.step(fmt::format("{}: launch {}, {} rows are not certain", scene, launch_, open.size()));
      launch_scene(open);
    }
  }

  /// One process of each program, which load a scene and time its open rows a few times. A row that fails may have
  /// taken its process along, which ends the launch.
  void launch_scene(std::vector<Pair*>& open) {
    const double start = now_s();
    const int processor = processor_for(open);
    RowClient clients[2] = {{plan_, 0, processor}, {plan_, 1, processor}};
    for (Pair* pair : open) pair->spent_s += (now_s() - start) / double(open.size());
    for (Pair* pair : open)
      if (!prepare(*pair, clients)) return;
    for (int turn = 0; turn < most_turns; ++turn) {
      std::shuffle(open.begin(), open.end(), random_);
      for (Pair* pair : open)
        if (turn < pair->turns && !time(*pair, clients)) return;
    }
  }

  /// Rows of one thread are timed on one processor, another one in every launch: two would have neighbours of their
  /// own.
  int processor_for(const std::vector<Pair*>& open) const {
    const auto alone = [](const Pair* pair) {
      return pair->rows[0]->id.threads == 1 && pair->rows[1]->id.threads == 1;
    };
    cpu_set_t allowed;
    if (!std::all_of(open.begin(), open.end(), alone) || sched_getaffinity(0, sizeof allowed, &allowed) != 0) return -1;
    std::vector<int> processors;
    for (int k = 0; k < CPU_SETSIZE; ++k)
      if (CPU_ISSET(k, &allowed)) processors.push_back(k);
    return processors[std::size_t(launch_) % processors.size()];
  }

  bool prepare(Pair& pair, RowClient (&clients)[2]) {
    const double start = now_s();
    const bool done = attempt(pair, [&](int side) {
      const std::string& key = pair.rows[side]->facts.key;
      clients[side].ask({{"scene", pair.scene()}, {"row", key}});
      const double frame_ms = clients[side].ask({{"prepare", key}}).at("frame_ms");
      if (pair.turns > 0) return;  // as many frames for both, always
      pair.frames = frames_per_repetition(frame_ms, sample_ms);
      const double turn_ms = 2.0 * frame_ms * double(pair.frames);
      pair.turns = std::clamp(int(launch_ms / turn_ms), least_turns, most_turns);
    });
    pair.spent_s += now_s() - start;
    return done;
  }

  bool time(Pair& pair, RowClient (&clients)[2]) {
    const double start = now_s();
    const int first = int(random_() & 1);
    Timing before[2] = {pair.rows[0]->timing, pair.rows[1]->timing};
    const bool done = attempt(
        pair,
        [&](int side) {
          const json question = {{"time", pair.rows[side]->facts.key}, {"frames", pair.frames}};
          add_repetition(clients[side].ask(question), pair.frames, launch_, pair.rows[side]->timing);
        },
        first);
    if (!done)
      for (const int side : {0, 1}) pair.rows[side]->timing = before[side];
    pair.spent_s += now_s() - start;
    return done;
  }

  /// Does something on both sides. What is thrown is the failure of that side's row, and its end.
  bool attempt(Pair& pair, const std::function<void(int)>& work, int first = 0) {
    for (const int side : {first, 1 - first}) try {
        stop_if_interrupted();
        work(side);
      } catch (const std::exception& e) {
        pair.rows[side]->status = std::string("failed: while it was timed: ") + e.what();
        pair.open = false;
        return false;
      }
    return true;
  }

  /// Closes rows that are certain.
  void look() {
    const double level = 1.0 - false_alarms / double(pairs_.size() * std::size(launches_at_looks));
    for (Pair& pair : pairs_) {
      if (!pair.open) continue;
      const Interval interval =
          student_interval(changes_of_launches(pair.rows[0]->timing, pair.rows[1]->timing), level);
      pair.open = !certain(interval);
    }
    save();
  }

  bool certain(const Interval& change) const {
    const double most = std::log1p(plan_.thresholds.slower);
    return change.low > most || change.high < -most || change.within(-most, most);
  }

  void save() {
    for (const int side : {0, 1}) write_results(plan_.directory + "/" + folders[side], results(side));
  }

  const SideBySide& plan_;
  Progress& progress_;
  std::mt19937 random_;
  TwoResults both_;
  std::vector<Pair> pairs_;
  int launch_ = 0;
};

}  // namespace

TwoResults measure_side_by_side(const SideBySide& plan, Progress& progress) {
  for (const std::string& program : plan.programs)
    if (!std::filesystem::is_regular_file(program)) throw Error("{}: no program; allowed is a built penumbra", program);
  make_folder(plan.directory);
  return Session(plan, progress).run();
}

}  // namespace penumbra
