// Rows for other tools: spreadsheets, papers, and services that watch benchmarks over time (docs/results.md). Every
// format has a real reader in scripts/check_formats.py.
#pragma once

#include <string>
#include <vector>

#include "harness/results/results_file.h"

namespace penumbra {

struct Exported {
  std::string text;
  std::string left_out;  ///< what of the rows could not be written, in words; empty if all is there
};

struct ExportFormat {
  const char* name;
  const char* summary;
  bool several;  ///< does it take more than one run?
  Exported (*write)(const std::vector<Results>& runs);
};

/// All of them, in the order of help.
const std::vector<ExportFormat>& export_formats();

Exported export_csv(const std::vector<Results>& runs);
Exported export_latex(const std::vector<Results>& runs);
Exported export_bmf(const std::vector<Results>& runs);
Exported export_github(const std::vector<Results>& runs);
Exported export_benchstat(const std::vector<Results>& runs);
Exported export_lnt(const std::vector<Results>& runs);
Exported export_otava(const std::vector<Results>& runs);

}  // namespace penumbra
