// The system's own faults: no descriptors, no memory. None of them ends the server or the listener.
#include "tests/http/failing_calls.h"
#include "tests/http/server_fixture.h"

#include <cerrno>
#include <gmock/gmock.h>

namespace chamfer::http {
namespace {

using std::chrono::milliseconds;
using test::Connection;
using test::FailingAccept;
using test::Reply;
using test::requestText;
using testing::HasSubstr;

class Faults : public test::ServerTest {
protected:
  /// A server whose answers are `body`, made by `handler`.
  void serveWith(RequestHandler handler, ConnectionLimits limits = {}) {
    server_ = std::make_unique<HttpServer>(limits, std::move(handler));
    port_ = server_->start("127.0.0.1", 0);
  }
};

TEST_F(Faults, NoErrorOfAcceptEndsTheListener) {
  start();
  for (const int error : {ENFILE, EMFILE, ENOBUFS, ENOMEM, ECONNABORTED, EPROTO, EINTR, EPERM, ENETDOWN,
                          EHOSTUNREACH, EINVAL, EIO}) {
    const FailingAccept failing(error, 3);
    EXPECT_EQ(test::get(port_, "/livez").status, 200) << error;
    EXPECT_EQ(FailingAccept::pending(), 0) << "the fault was never met: " << error;
  }
  expectServing();
}

TEST_F(Faults, WhoIsIdleMakesRoomWhereDescriptorsAreShort) {
  start();
  Connection idle(port_);
  idle.send(requestText("GET", "/livez"));
  ASSERT_TRUE(idle.receive());
  {
    const FailingAccept failing(EMFILE, 3);
    EXPECT_EQ(test::get(port_, "/livez").status, 200);
  }
  EXPECT_TRUE(idle.closedWithin(milliseconds(2000)));
  EXPECT_GE(server_->counts().dropped, 1u);
}

TEST_F(Faults, MemoryThatFailsWhileAnAnswerIsFramedCostsThatAnswerOnly) {
  constexpr std::size_t kBody = 4u << 20;
  std::atomic<bool> fail = true;
  serveWith([&](Request&, const Problem*) {
    Response response;
    response.contentType = "application/octet-stream";
    response.body.assign(kBody, 'x');
    if (fail.exchange(false)) test::failNextAllocationOf(kBody);
    return response;
  });
  const Reply reply = test::get(port_, "/");
  EXPECT_TRUE(test::allocationFailed());
  EXPECT_EQ(reply.status, 503);
  EXPECT_EQ(reply.header("retry-after"), "10");
  EXPECT_EQ(nlohmann::json::parse(reply.body)["detail"], "the server is short of memory");
  EXPECT_EQ(test::get(port_, "/").body.size(), kBody);
}

TEST_F(Faults, WhateverAHandlerThrowsEndsNothing) {
  std::atomic<int> asked = 0;
  serveWith([&](Request&, const Problem*) -> Response {
    if (asked++ == 0) throw std::runtime_error("a library's text");
    return {};
  });
  const Reply reply = test::get(port_, "/");
  EXPECT_EQ(reply.status, 503);
  EXPECT_THAT(reply.body, testing::Not(HasSubstr("library")));
  EXPECT_EQ(test::get(port_, "/").status, 200);
}

TEST_F(Faults, MemoryThatFailsWhileABodyArrivesCostsThatConnectionOnly) {
  start();
  const std::string body(4'000'000, ' ');
  Connection client(port_);
  test::failNextAllocationOf(1u << 20);
  client.send("POST /v1/scenes/cube/rays HTTP/1.1\r\nHost: a\r\nContent-Length: 8000000\r\n\r\n");
  client.send(body);
  EXPECT_FALSE(client.receive(false, milliseconds(5000)));
  EXPECT_TRUE(test::allocationFailed());
  EXPECT_EQ(server_->counts().dropped, 1u);
  expectServing();
}

} // namespace
} // namespace chamfer::http
