// Words and numbers for messages, and the few text helpers that readers and writers need. ASCII rules; what
// is not ASCII passes unchanged.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace chamfer {

/// Lower-case copy: A to Z only, whatever the locale.
std::string lowerCase(std::string_view text);

/// Without blanks and tabs at its ends.
std::string_view trimmed(std::string_view text);

/// What a file or a request holds, for a message: at most `most` characters and then "...". Printable UTF-8
/// stays; control characters (those that turn the writing direction, too) and bytes that are no UTF-8 become
/// \xNN, so that no message can hold binary bytes or command a terminal.
std::string printable(std::string_view text, std::size_t most = 40);

/// The same in quotes.
inline std::string inQuotes(std::string_view text, std::size_t most = 40) {
  return '"' + printable(text, most) + '"';
}

/// The same for names of files, which are of use only whole.
inline std::string fileInQuotes(std::string_view name) { return inQuotes(name, 200); }

/// A number for a message: so many digits at most, no zeros behind.
std::string numberText(double value, int digits = 9);

/// A number for what is read back: the shortest decimal text that gives the same double.
std::string exactNumberText(double value);

/// A place for a message: "(1, 2.5, -3)".
std::string pointText(double x, double y, double z, int digits = 9);

/// Keeps the first `most` of a list of messages and says how many went: "and 12 more".
void keepFirst(std::vector<std::string>& messages, std::size_t most);

} // namespace chamfer
