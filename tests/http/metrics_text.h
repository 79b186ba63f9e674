// Prometheus' text format, read back.
#pragma once

#include <map>
#include <sstream>
#include <string>

namespace chamfer::test {

/// Values by series as printed: name{label="value",...}.
using Series = std::map<std::string, double>;

inline Series seriesOf(const std::string& text) {
  Series series;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with('#') && line.find("_bucket{") == std::string::npos)
      series[line.substr(0, line.rfind(' '))] = std::stod(line.substr(line.rfind(' ') + 1));
  return series;
}

} // namespace chamfer::test
