// What the formats share.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "harness/report/formats/formats.h"

namespace penumbra {

/// Rows that were measured, timed or not.
std::vector<const Row*> measured_rows(const std::vector<Row>& rows);
/// "3 of 10 rows are failed or skipped"; empty if none is.
std::string unmeasured_text(const std::vector<Row>& rows);

/// A fact of the machine or the program; empty if the context does not have it. What is no word is written as JSON.
std::string context_text(const nlohmann::json& context, const char* field);

/// A cell of a table as RFC 4180 has it: in quotes where it must be.
std::string csv_cell(const std::string& text);
/// The cells of a line, and its end (CR LF).
std::string csv_line(const std::vector<std::string>& cells);

/// Indented, with a line end behind; what is no UTF-8 is replaced.
std::string json_text(const nlohmann::json& document);

}  // namespace penumbra
