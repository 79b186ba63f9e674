// The server's log: JSON lines on standard error (spdlog behind this header). Messages of the render library,
// which logs through spdlog's default logger, come out in the same form.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace chamfer::http {

enum class LogLevel : std::uint8_t { Debug, Info, Warning, Error };

/// To be called once, at start. `level`: "debug", "info", "warning", "error" or "off"; throws Error(Usage)
/// for another.
void startLog(const std::string& level);

/// {"time":..,"level":..,"message":..}
void logMessage(LogLevel level, const std::string& message);

struct RequestRecord {
  std::string id, client, method, target;
  int status = 0;
  double milliseconds = 0;
  std::size_t bytes = 0; ///< of the answer's body
};
/// {"time":..,"level":"info","event":"request","id":..,"client":..,"method":..,"path":..,"status":..,"ms":..,"bytes":..}
void logRequest(const RequestRecord& record);

} // namespace chamfer::http
