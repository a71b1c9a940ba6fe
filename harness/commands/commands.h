// The commands of the command line, one file each. `add_NAME` puts the command with its options into the program; its
// callback does the work and sets `exit_code` where that is not 0. All throw Error for wrong input.
#pragma once

namespace CLI {
class App;
}

namespace penumbra {

void add_choose(CLI::App& app, int& exit_code);
void add_run(CLI::App& app, int& exit_code);
void add_compare(CLI::App& app, int& exit_code);
void add_report(CLI::App& app, int& exit_code);
void add_serve_rows(CLI::App& app, int& exit_code);
void add_render(CLI::App& app, int& exit_code);
void add_reference(CLI::App& app, int& exit_code);
void add_fit(CLI::App& app, int& exit_code);
void add_sheet(CLI::App& app, int& exit_code);
void add_list(CLI::App& app, int& exit_code);
void add_init(CLI::App& app, int& exit_code);
void add_help(CLI::App& app, int& exit_code);
void add_export(CLI::App& app, int& exit_code);
void add_export_rows(CLI::App& app, int& exit_code);
void add_score(CLI::App& app, int& exit_code);

}  // namespace penumbra
