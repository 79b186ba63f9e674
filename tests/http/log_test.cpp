#include "server/http/monitoring/log.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>

namespace chamfer::http {
namespace {

/// What `log` writes, line by line, as JSON.
template <class Action>
std::vector<nlohmann::json> linesOf(Action&& log) {
  testing::internal::CaptureStderr();
  startLog("info");
  log();
  startLog("off");
  std::istringstream text(testing::internal::GetCapturedStderr());
  std::vector<nlohmann::json> lines;
  for (std::string line; std::getline(text, line);)
    lines.push_back(nlohmann::json::parse(line));
  return lines;
}

TEST(Log, RequestIsOneLineWithEveryField) {
  const auto lines = linesOf([] {
    logRequest({"id-1", "127.0.0.1", "GET", "/v1/info?a=b", 200, 12.34567, 1234});
  });
  ASSERT_EQ(lines.size(), 1u);
  const auto& line = lines[0];
  EXPECT_EQ(line["level"], "info");
  EXPECT_EQ(line["event"], "request");
  EXPECT_EQ(line["id"], "id-1");
  EXPECT_EQ(line["client"], "127.0.0.1");
  EXPECT_EQ(line["method"], "GET");
  EXPECT_EQ(line["path"], "/v1/info?a=b");
  EXPECT_EQ(line["status"], 200);
  EXPECT_EQ(line["ms"], 12.346);
  EXPECT_EQ(line["bytes"], 1234);
  EXPECT_TRUE(line["time"].get<std::string>().ends_with("Z"));
}

TEST(Log, ValuesCannotForgeALine) {
  const std::string evil = "\"}\n{\"level\":\"error\",\"message\":\"forged\r\n\x1b[31m\xff%n{}\\";
  const auto lines = linesOf([&] {
    logRequest({evil, evil, evil, evil, 200, 1, 1});
    logMessage(LogLevel::Warning, evil);
  });
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0]["level"], "info");
  EXPECT_EQ(lines[0]["path"], lines[0]["id"]);
  EXPECT_EQ(lines[0]["path"].get<std::string>().substr(0, 3), evil.substr(0, 3));
  EXPECT_EQ(lines[1]["level"], "warning");
}

TEST(Log, LevelsAreObeyed) {
  EXPECT_EQ(linesOf([] { logMessage(LogLevel::Debug, "x"); }).size(), 0u);
  EXPECT_EQ(linesOf([] { logMessage(LogLevel::Error, "x"); }).size(), 1u);
}

} // namespace
} // namespace chamfer::http
