#include "server/http/monitoring/log.h"

#include "common/error.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

namespace chamfer::http {
namespace {

using Json = nlohmann::ordered_json;

/// Prints the message as members of a JSON object: an object's own members, or a text as "message".
class JsonMembers : public spdlog::custom_flag_formatter {
public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& out) override {
    std::string text(message.payload.data(), message.payload.size());
    if (message.logger_name == spdlog::string_view_t("request"))
      text = text.substr(1, text.size() - 2); // made by logRequest(): an object
    else
      text = "\"message\":" + Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
    out.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<JsonMembers>(); }
};

std::shared_ptr<spdlog::logger> makeLogger(const std::string& name, spdlog::sink_ptr sink) {
  auto logger = std::make_shared<spdlog::logger>(name, std::move(sink));
  auto formatter = std::make_unique<spdlog::pattern_formatter>(spdlog::pattern_time_type::utc);
  formatter->add_flag<JsonMembers>('*').set_pattern(R"({"time":"%Y-%m-%dT%H:%M:%S.%eZ","level":"%l",%*})");
  logger->set_formatter(std::move(formatter));
  return logger;
}

} // namespace

void startLog(const std::string& level) {
  spdlog::level::level_enum value = spdlog::level::info;
  if (level == "debug")
    value = spdlog::level::debug;
  else if (level == "warning")
    value = spdlog::level::warn;
  else if (level == "error")
    value = spdlog::level::err;
  else if (level == "off")
    value = spdlog::level::off;
  else if (level != "info")
    throw Error(ErrorKind::Usage,
                "log level \"" + level + "\" is not known; use debug, info, warning, error or off");
  const auto sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
  spdlog::set_default_logger(makeLogger("chamferd", sink));
  spdlog::drop("request");
  spdlog::register_logger(makeLogger("request", sink));
  spdlog::set_level(value);
}

void logMessage(LogLevel level, const std::string& message) {
  switch (level) {
  case LogLevel::Debug:
    spdlog::debug("{}", message);
    break;
  case LogLevel::Info:
    spdlog::info("{}", message);
    break;
  case LogLevel::Warning:
    spdlog::warn("{}", message);
    break;
  case LogLevel::Error:
    spdlog::error("{}", message);
    break;
  }
}

void logRequest(const RequestRecord& record) {
  const auto logger = spdlog::get("request");
  if (!logger || !logger->should_log(spdlog::level::info)) return;
  const Json line{{"event", "request"},
                  {"id", record.id},
                  {"client", record.client},
                  {"method", record.method},
                  {"path", record.target},
                  {"status", record.status},
                  {"ms", std::round(record.milliseconds * 1000) / 1000},
                  {"bytes", record.bytes}};
  logger->info("{}", line.dump(-1, ' ', false, Json::error_handler_t::replace));
}

} // namespace chamfer::http
