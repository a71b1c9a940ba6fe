// How text fits a screen. UTF-8; letters that may be two columns wide count as two, and what is no UTF-8 by bytes.
#pragma once

#include <string>

namespace penumbra {

/// How many columns a text takes on a screen.
int columns_of(const std::string& text);

/// The text if it takes at most so many columns, else as much of it as they hold with an ellipsis behind it.
std::string cut_to_columns(const std::string& text, int columns);

/// The same with its begin and its end: names differ at the end.
std::string cut_in_middle(const std::string& text, int columns);

/// Control characters, line breaks and what turns the direction of writing as spaces: what comes from files must not
/// steer a terminal.
std::string printable(const std::string& text);

/// The text's first letter, all bytes of it; "" of an empty text.
std::string first_letter(const std::string& text);

/// The text without its last letter.
std::string without_last_letter(const std::string& text);

/// Three significant digits without an exponent: "1234", "123", "12.3", "0.0123".
std::string three_digits(double value);

/// A time in seconds as "12 s", "3 min 20 s", "2 h 05 min", rounded up.
std::string duration_text(double seconds);

}  // namespace penumbra
