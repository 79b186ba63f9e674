// The server on a real socket: framing, attacks on it, slow clients, clients that leave.
#include "server/http/schema/limits.h"
#include "tests/http/server_fixture.h"

#include <gmock/gmock.h>

namespace chamfer::http {
namespace {

using std::chrono::milliseconds;
using test::Connection;
using test::Reply;
using test::requestText;
using testing::HasSubstr;

class Server : public test::ServerTest {
protected:
  /// 8 MB, and quickly made: nothing is in sight.
  std::string largeTile() {
    return "/v1/scenes/" + idOf("cube") +
           "/tiles/1024x1024/0,0,1024,1024/0-1.f16?camera=0,0,9,0,0,99,0,1,0,9";
  }
};

TEST_F(Server, FramesAnswers) {
  start();
  const Reply scene = test::get(port_, "/v1/scenes/cube");
  EXPECT_EQ(scene.status, 200);
  EXPECT_EQ(scene.header("content-type"), "application/json");
  EXPECT_EQ(scene.header("content-length"), std::to_string(scene.body.size()));
  EXPECT_EQ(scene.header("x-content-type-options"), "nosniff");
  EXPECT_EQ(nlohmann::json::parse(scene.body)["name"], "cube");

  const Reply head = test::head(port_, "/v1/scenes/cube");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.header("content-length"), scene.header("content-length"));

  const Reply fresh = test::get(port_, quickTile());
  const Reply same = test::get(port_, quickTile(), "If-None-Match: " + fresh.header("etag") + "\r\n");
  EXPECT_EQ(same.status, 304);
  EXPECT_EQ(same.header("etag"), fresh.header("etag"));
  EXPECT_EQ(same.header("content-length"), "");
  EXPECT_EQ(test::head(port_, quickTile()).header("content-length"), "") << "not known before rendering";
}

TEST_F(Server, ConnectionServesManyRequestsEvenSentAtOnce) {
  start();
  Connection connection(port_);
  const std::string rays = R"({"rays":[[0,0,5,0,0,-1]]})";
  connection.send(requestText("GET", "/livez") + "\r\n" +
                  requestText("POST", "/v1/scenes/cube/rays", "Content-Type: application/json\r\n", rays) +
                  requestText("GET", "/v1/scenes") + requestText("GET", "/readyz", "Connection: close\r\n"));
  EXPECT_EQ(connection.receive()->body, "ok\n");
  EXPECT_THAT(connection.receive()->body, HasSubstr("\"t\":4.5"));
  EXPECT_THAT(connection.receive()->body, HasSubstr("cube"));
  const auto last = connection.receive();
  EXPECT_EQ(last->body, "ready\n");
  EXPECT_EQ(last->header("connection"), "close");
  EXPECT_TRUE(connection.closedWithin(milliseconds(1000)));
}

TEST_F(Server, BytesMayArriveOneByOne) {
  start();
  Connection connection(port_);
  for (const char c :
       requestText("POST", "/v1/scenes/cube/rays", "Content-Type: application/json\r\n", R"({"rays":[]})"))
    connection.send({&c, 1});
  EXPECT_EQ(connection.receive()->body, "{\"hits\":[]}\n");
}

TEST_F(Server, BodyIsSentAfterContinue) {
  start();
  Connection connection(port_);
  connection.send("POST /v1/scenes/cube/rays HTTP/1.1\r\nHost: a\r\nContent-Type: application/json\r\n"
                  "Content-Length: 11\r\nExpect: 100-continue\r\n\r\n");
  EXPECT_EQ(connection.receive()->status, 100);
  connection.send("{\"rays\":[]}");
  EXPECT_EQ(connection.receive()->status, 200);
}

TEST_F(Server, RefusesHostileFramingAndLives) {
  start();
  const std::string host = "Host: a\r\n";
  const struct {
    std::string bytes;
    int status;
  } attacks[] = {
      {"POST /v1/scenes/cube/rays HTTP/1.1\r\n" + host +
           "Transfer-Encoding: chunked\r\n\r\n3\r\nabc\r\n0\r\n\r\n",
       411},
      {"POST /v1/scenes/cube/rays HTTP/1.1\r\n" + host +
           "Content-Encoding: gzip\r\nContent-Length: 3\r\n\r\nabc",
       415},
      {"POST /v1/scenes/cube/rays HTTP/1.1\r\n" + host + "\r\n", 411},
      {"POST /v1/scenes/cube/rays HTTP/1.1\r\n" + host +
           "Content-Length: " + std::to_string(kMaxBodyBytes + 1) + "\r\n\r\n" + std::string(100'000, 'x'),
       413},
      {"GET /livez HTTP/1.1\r\n" + host +
           "Content-Length: 46\r\n\r\nGET /v1/scenes HTTP/1.1\r\nHost: smuggled\r\n\r\n",
       400},
      {"GET /" + std::string(5000, 'a') + " HTTP/1.1\r\n" + host + "\r\n", 414},
      {"GET / HTTP/1.1\r\n" + host + "A: " + std::string(20'000, 'a') + "\r\n\r\n", 431},
      {"GET / HTTP/1.1\r\n" + host + host + "\r\n", 400},
      {"\x16\x03\x01\x02\x01\x01\xfc\x03\x03", 400}, // a TLS client
      {"hello\r\n\r\n", 400},
      {"FROB / HTTP/1.1\r\n" + host + "\r\n", 405},
      {"GET / HTTP/3.0\r\n" + host + "\r\n", 505},
  };
  for (const auto& [bytes, status] : attacks) {
    Connection connection(port_);
    connection.send(bytes);
    const auto reply = connection.receive();
    ASSERT_TRUE(reply) << bytes.substr(0, 80);
    EXPECT_EQ(reply->status, status) << bytes.substr(0, 80);
    EXPECT_EQ(reply->header("content-type"), "application/problem+json");
    if (status != 405) {
      EXPECT_EQ(reply->header("connection"), "close");
      EXPECT_FALSE(connection.receive(false, milliseconds(300))) << "what followed was taken for a request";
    }
    expectServing();
  }
}

TEST_F(Server, RangesAndCompressionAreIgnored) {
  start();
  std::string ranges = "Range: bytes=0-";
  for (int i = 0; i < 500; ++i)
    ranges += ",0-";
  const Reply plain = test::get(port_, "/v1/info");
  const Reply ranged = test::get(port_, "/v1/info", ranges + "\r\nAccept-Encoding: gzip, br\r\n");
  EXPECT_EQ(ranged.status, 200);
  EXPECT_EQ(ranged.header("content-encoding"), "");
  EXPECT_NEAR(static_cast<double>(ranged.body.size()), static_cast<double>(plain.body.size()), 16);
  EXPECT_EQ(test::get(port_, "/livez", "Range: bytes=5-1\r\n").status, 200);
}

TEST_F(Server, HeadersCannotBeInjected) {
  start();
  const Reply reply = test::get(port_, "/livez", "X-Request-Id: a%0d%0aEvil: yes\r\n");
  EXPECT_EQ(reply.header("evil"), "");
  const Reply redirect =
      test::get(port_, "/v1/scenes/cube/tiles/8x8/0,0,8,8/0-1.f16?aov=normal%0d%0aEvil:%20yes");
  EXPECT_EQ(redirect.status, 400);
  EXPECT_EQ(redirect.header("evil"), "");
}

TEST_F(Server, IdleAndSlowClientsAreDroppedInTime) {
  ConnectionLimits limits;
  limits.idle = milliseconds(300);
  limits.head = milliseconds(300);
  limits.transfer = milliseconds(300);
  start({}, limits);
  Connection idle(port_), slowHead(port_), slowBody(port_);
  slowHead.send("GET /livez HT");
  slowBody.send("POST /v1/scenes/cube/rays HTTP/1.1\r\nHost: a\r\nContent-Length: 100\r\n\r\n{");
  EXPECT_EQ(slowHead.receive(false, milliseconds(2000))->status, 408);
  EXPECT_EQ(slowBody.receive(false, milliseconds(2000))->status, 408);
  EXPECT_TRUE(idle.closedWithin(milliseconds(2000)));
}

TEST_F(Server, SlowAndIdleClientsStarveNobody) {
  start();
  std::vector<std::unique_ptr<Connection>> others;
  for (int i = 0; i < 200; ++i) {
    others.push_back(std::make_unique<Connection>(port_));
    if (i % 3 == 1) others.back()->send("GET /livez HTTP/1.1\r\nHo");
    if (i % 3 == 2)
      others.back()->send("POST /v1/scenes/cube/rays HTTP/1.1\r\nHost: a\r\nContent-Length: 100000\r\n\r\n{");
  }
  expectServing();
  EXPECT_EQ(test::get(port_, quickTile()).status, 200);
}

TEST_F(Server, LongestIdleConnectionMakesRoom) {
  ConnectionLimits limits;
  limits.connections = 8;
  start({}, limits);
  std::vector<std::unique_ptr<Connection>> idle;
  for (int i = 0; i < 8; ++i)
    idle.push_back(std::make_unique<Connection>(port_));
  std::this_thread::sleep_for(milliseconds(50));
  expectServing();
  EXPECT_TRUE(idle[0]->closedWithin(milliseconds(1000)));
}

TEST_F(Server, ClientThatReadsNothingIsDropped) {
  ConnectionLimits limits;
  limits.transfer = milliseconds(300);
  limits.bytesPerSecond = 64u << 20;
  start({}, limits);
  // 8 MB: more than the sockets' buffers hold.
  const std::string large = largeTile();
  Connection deaf(port_);
  deaf.send(requestText("GET", large));
  ASSERT_TRUE(deaf.readable(std::chrono::seconds(20)));
  EXPECT_EQ(server_->counts().dropped, 0u) << "it has its time";
  EXPECT_EQ(server_->counts().busy, 1u) << "all of it was taken: the answer is too small for this test";
  const auto begin = std::chrono::steady_clock::now();
  while (server_->counts().dropped == 0 && std::chrono::steady_clock::now() - begin < std::chrono::seconds(5))
    std::this_thread::sleep_for(milliseconds(2));
  EXPECT_EQ(server_->counts().dropped, 1u);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, milliseconds(1500));
  EXPECT_EQ(server_->counts().busy, 0u);
  const auto rest = deaf.receive(false, milliseconds(1000));
  EXPECT_FALSE(rest) << "a whole answer";
  // Who reads the same answer, slowly but steadily, gets all of it.
  limits.transfer = milliseconds(700);
  limits.bytesPerSecond = 1u << 20;
  start({}, limits);
  Connection steady(port_);
  steady.send(requestText("GET", large));
  const auto whole = steady.receiveSlowly(4u << 20);
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->body.size(), 16u + 1024 * 1024 * 8);
  EXPECT_EQ(server_->counts().dropped, 0u);
  expectServing();
}

TEST_F(Server, ManyDeadlinesAtOnceCloseEachConnectionOnce) {
  // A slow screen holds the loop up until every deadline has passed; to refuse a head that is late then
  // makes room for the refusal by closing an answer that is late as well.
  ConnectionLimits limits;
  limits.head = limits.transfer = milliseconds(1000);
  limits.bytesPerSecond = std::size_t{1} << 40; // what the sockets take earns no time
  constexpr std::size_t kBody = 8u << 20;
  limits.answerBytes = 3 * (kBody + 300);
  HttpServer server(
      limits,
      [](Request&, const Problem* refusal) {
        Response response;
        response.contentType = "text/plain";
        response.body.assign(refusal ? 2000 : kBody, 'x');
        return response;
      },
      [](Request&) {
        std::this_thread::sleep_for(milliseconds(1800));
        return std::nullopt;
      });
  const int port = server.start("127.0.0.1", 0);
  std::vector<std::unique_ptr<Connection>> deaf, late;
  const auto add = [&](auto& list, const std::string& bytes) {
    list.push_back(std::make_unique<Connection>(port));
    list.back()->send(bytes);
  };
  for (int i = 0; i < 3; ++i)
    add(deaf, requestText("GET", "/"));
  for (int i = 0; i < 1000 && server.counts().busy != 3; ++i)
    std::this_thread::sleep_for(milliseconds(1));
  std::this_thread::sleep_for(milliseconds(100)); // all that the sockets take is in them
  ASSERT_EQ(server.counts().busy, 3u);
  ASSERT_EQ(server.counts().dropped, 0u);
  for (int i = 0; i < 8; ++i)
    add(late, "GET / HT");
  std::this_thread::sleep_for(milliseconds(20));
  Connection blocking(port);
  blocking.send("POST / HTTP/1.1\r\nHost: a\r\nContent-Length: 10\r\n\r\n");
  for (auto& connection : late) {
    const auto reply = connection->receive(false, milliseconds(8000));
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->body.size(), 2000u);
  }
  for (int i = 0; i < 4000 && server.counts().open > 0; ++i)
    std::this_thread::sleep_for(milliseconds(1));
  EXPECT_EQ(server.counts().open, 0u);
  EXPECT_EQ(server.counts().dropped, 3u) << "each of the deaf, once";
  EXPECT_EQ(server.counts().busy, 0u);
}

TEST_F(Server, UnreadAnswersHaveABound) {
  ConnectionLimits limits;
  limits.answerBytes = 1u << 20;
  start({}, limits);
  // 8 MB an answer: more than sockets hold, so that each waits for its client.
  const std::string large = largeTile();
  std::vector<std::unique_ptr<Connection>> deaf;
  for (int i = 0; i < 3; ++i) {
    deaf.push_back(std::make_unique<Connection>(port_));
    deaf.back()->send(requestText("GET", large));
  }
  for (int i = 0; i < 3000 && server_->counts().busy != 1; ++i)
    std::this_thread::sleep_for(milliseconds(10));
  EXPECT_EQ(server_->counts().busy, 1u) << "the last to come is still served";
  expectServing();
}

TEST_F(Server, ClientThatLeavesFreesItsSlotWithinASecond) {
  start({.threads = 1, .slots = 1});
  for (const bool reset : {false, true}) {
    auto client = std::make_unique<Connection>(port_);
    client->send(requestText("GET", slowTile()));
    waitForRunning(1);
    if (reset) client->abort();
    const auto begin = std::chrono::steady_clock::now();
    client.reset();
    waitForRunning(0);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
  }
  EXPECT_EQ(test::get(port_, quickTile()).status, 200);
}

TEST_F(Server, HealthAnswersWhileEverySlotAndPlaceIsTaken) {
  start({.threads = 1, .slots = 2, .waiting = 4});
  std::vector<std::unique_ptr<Connection>> clients;
  for (int i = 0; i < 6; ++i) {
    clients.push_back(std::make_unique<Connection>(port_));
    clients.back()->send(requestText("GET", slowTile()));
  }
  waitForRunning(2);
  for (int i = 0; i < 500 && json(service_->answer(info_))["queue"]["waiting"] != 4; ++i)
    std::this_thread::sleep_for(milliseconds(2));
  const Reply refused = test::get(port_, quickTile());
  EXPECT_EQ(refused.status, 503);
  EXPECT_NE(refused.header("retry-after"), "");
  expectAlive();
  EXPECT_EQ(test::get(port_, "/v1/scenes").status, 200);
  clients.clear();
  waitForRunning(0);
  EXPECT_EQ(test::get(port_, quickTile()).status, 200);
}

TEST_F(Server, StopLetsAnswersFinish) {
  start({.threads = 1});
  Connection client(port_);
  client.send(requestText("GET", "/v1/scenes/" + idOf("cube") + "/tiles/256x256/0,0,128,128/0-8.f16"));
  waitForRunning(1);
  server_->stop(std::chrono::seconds(30));
  const auto reply = client.receive();
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 200);
  EXPECT_EQ(reply->body.size(), 16u + 128 * 128 * 8);
  EXPECT_THROW(Connection{port_}, std::runtime_error);
}

TEST_F(Server, PortInUseIsAnErrorNotShared) {
  start();
  HttpServer second({}, [](Request&, const Problem*) { return Response{}; });
  EXPECT_THROW(second.start("127.0.0.1", port_), Error);
}

TEST_F(Server, ManyClientsAtOnceAllGetTheRightBytes) {
  start({.threads = 1});
  const std::string expected = test::get(port_, quickTile()).body;
  std::atomic<int> right = 0;
  {
    std::vector<std::jthread> clients;
    for (int c = 0; c < 16; ++c)
      clients.emplace_back([&] {
        for (int i = 0; i < 4; ++i) {
          const Reply reply = test::get(port_, quickTile());
          right += reply.status == 200 && reply.body == expected;
        }
      });
  }
  EXPECT_EQ(right, 64);
}

} // namespace
} // namespace chamfer::http
