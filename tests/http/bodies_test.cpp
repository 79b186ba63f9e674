// Bodies: read from those only who may send them, at a pace, and never so that some clients shut out others.
#include "server/http/schema/limits.h"
#include "tests/http/server_fixture.h"

#include <gmock/gmock.h>

namespace chamfer::http {
namespace {

using std::chrono::milliseconds;
using test::Connection;
using test::requestText;

class Bodies : public test::ServerTest {
protected:
  static std::string headOf(std::size_t length, const std::string& fields = "",
                            const std::string& target = "/v1/scenes/cube/rays") {
    return "POST " + target + " HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n" + fields +
           "Content-Length: " + std::to_string(length) + "\r\n\r\n";
  }
  /// A batch without rays that has so many bytes.
  static std::string batchOf(std::size_t bytes) {
    const std::string batch = R"({"rays":[]})";
    return batch + std::string(bytes - batch.size(), ' ');
  }
  int status(Connection& connection, milliseconds patience = milliseconds(3000)) {
    const auto reply = connection.receive(false, patience);
    return reply ? reply->status : 0;
  }
};

TEST_F(Bodies, AreNotWaitedForWhereTheHeadSaysEnough) {
  start({.keys = {"0123456789abcdef"}, .hosts = {"localhost"}});
  const std::string key = "Authorization: Bearer 0123456789abcdef\r\n";
  const struct {
    std::string head;
    int status;
  } refused[] = {
      {headOf(kMaxBodyBytes), 401},
      {headOf(kMaxBodyBytes, "Authorization: Bearer another-key-of-some-length\r\n"), 403},
      {headOf(kMaxBodyBytes + 1), 401},
      {headOf(kMaxBodyBytes + 1, key), 413},
      {headOf(kMaxBodyBytes, key + "Sec-Fetch-Site: cross-site\r\n"), 403},
      {headOf(kMaxBodyBytes, key, "/v1/nothing"), 404},
      {headOf(kMaxBodyBytes, key, "/v1/scenes/cube%zz/rays"), 400},
      {headOf(kMaxBodyBytes, key, "/v1/info"), 405},
      {headOf(kMaxBodyBytes, key, "/"), 405},
      {"POST /v1/scenes/cube/rays HTTP/1.1\r\nHost: evil.example\r\n" + key + "Content-Length: 9\r\n\r\n",
       421},
  };
  for (const auto& [head, expected] : refused) {
    Connection connection(port_);
    connection.send(head);
    EXPECT_EQ(status(connection), expected) << head;
    EXPECT_TRUE(connection.closedWithin(milliseconds(1500))) << head;
  }
  // Nor is the body asked for.
  Connection expecting(port_);
  expecting.send(headOf(100, "Expect: 100-continue\r\n"));
  EXPECT_EQ(status(expecting), 401);
  expectServing();
}

TEST_F(Bodies, HeadsThatSendNoneTakeNothingFromOthers) {
  ConnectionLimits limits;
  limits.transfer = milliseconds(700);
  start({.keys = {"0123456789abcdef"}}, limits);
  const std::string key = "Authorization: Bearer 0123456789abcdef\r\n";
  std::vector<std::unique_ptr<Connection>> idle;
  for (int i = 0; i < 40; ++i) { // of 32 MiB each: far more than all bodies may have
    idle.push_back(std::make_unique<Connection>(port_));
    idle.back()->send(headOf(kMaxBodyBytes, key));
  }
  Connection other(port_);
  other.send(headOf(4'000'000, key) + batchOf(4'000'000));
  EXPECT_EQ(status(other), 200);
  for (auto& connection : idle)
    EXPECT_EQ(status(*connection, milliseconds(2500)), 408);
  expectServing();
}

TEST_F(Bodies, OneThatStopsIsLetGoHoweverMuchOfItHasCome) {
  ConnectionLimits limits;
  limits.transfer = milliseconds(500);
  start({}, limits);
  Connection quick(port_), trickling(port_);
  quick.send(headOf(kMaxBodyBytes) + std::string(16u << 20, ' '));
  trickling.send(headOf(kMaxBodyBytes));
  const auto begin = std::chrono::steady_clock::now();
  while (trickling.send(" ") && std::chrono::steady_clock::now() - begin < std::chrono::seconds(2))
    std::this_thread::sleep_for(milliseconds(50));
  EXPECT_EQ(status(quick), 408);
  EXPECT_EQ(status(trickling), 408);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(3));
}

TEST_F(Bodies, SlowButSteadyOnesArrive) {
  ConnectionLimits limits;
  limits.transfer = milliseconds(400);
  limits.bytesPerSecond = 100'000;
  start({}, limits);
  const std::string batch = batchOf(300'000);
  Connection steady(port_);
  steady.send(headOf(batch.size()));
  for (std::size_t at = 0; at < batch.size(); at += 10'000) { // 200,000 bytes a second: beyond `transfer`
    ASSERT_TRUE(steady.send(std::string_view(batch).substr(at, 10'000)));
    std::this_thread::sleep_for(milliseconds(50));
  }
  EXPECT_EQ(status(steady), 200);
}

TEST_F(Bodies, WhoHoldsTheMostGivesWay) {
  ConnectionLimits limits;
  limits.bodyBytes = 4u << 20;
  start({.behindProxy = true}, limits);
  const std::string greedy = "X-Forwarded-For: 192.0.2.1\r\n", modest = "X-Forwarded-For: 192.0.2.2\r\n";
  std::vector<std::unique_ptr<Connection>> many;
  for (int i = 0; i < 3; ++i) {
    many.push_back(std::make_unique<Connection>(port_));
    many.back()->send(headOf(8'000'000, greedy) + std::string(1'200'000 + 1000 * i, ' '));
  }
  std::this_thread::sleep_for(milliseconds(300));
  Connection other(port_);
  other.send(headOf(2'000'000, modest) + batchOf(2'000'000));
  EXPECT_EQ(status(other), 200);
  const auto refused = many.back()->receive(false, milliseconds(3000)); // the largest of them
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->status, 503);
  EXPECT_NE(refused->header("retry-after"), "");
  EXPECT_FALSE(many.front()->closedWithin(milliseconds(100))) << "one was enough";
  // Alone, too, nobody gets more than all may have.
  Connection alone(port_);
  alone.send(headOf(8'000'000, modest) + std::string(7'000'000, ' '));
  EXPECT_EQ(status(alone), 503);
  expectServing();
}

TEST_F(Bodies, RequestsThatArriveSlowlyDoNotTakeEveryConnection) {
  ConnectionLimits limits;
  limits.connections = 8;
  start({}, limits);
  std::vector<std::unique_ptr<Connection>> slow;
  for (int i = 0; i < 8; ++i) {
    slow.push_back(std::make_unique<Connection>(port_));
    slow.back()->send(i % 2 ? std::string("GET /livez HT") : headOf(1000) + "{");
  }
  std::this_thread::sleep_for(milliseconds(100));
  // All come from one address here, which may not push out its own: it is told to come again.
  EXPECT_EQ(test::get(port_, "/livez").status, 503);
  // Another address gets a place at once.
  Connection other(port_, "127.0.0.2");
  other.send(requestText("GET", "/livez"));
  EXPECT_EQ(status(other), 200);
  EXPECT_TRUE(slow[0]->closedWithin(milliseconds(1000)));
}

} // namespace
} // namespace chamfer::http
