#include "server/http/connection/request_head.h"

#include "server/http/schema/limits.h"

#include <gtest/gtest.h>

namespace chamfer::http {
namespace {

RequestHead accepted(const std::string& text) {
  const auto result = parseRequestHead(text);
  if (const Problem* problem = std::get_if<Problem>(&result)) {
    ADD_FAILURE() << problem->detail;
    return {};
  }
  return std::get<RequestHead>(result);
}

int refused(const std::string& text) {
  const auto result = parseRequestHead(text);
  const Problem* problem = std::get_if<Problem>(&result);
  if (!problem) return 0;
  EXPECT_TRUE(problem->close) << "what follows cannot be trusted";
  EXPECT_FALSE(problem->detail.empty());
  return problem->status;
}

TEST(RequestHead, ReadsLineAndFields) {
  const RequestHead head = accepted("POST /v1/x?a=b HTTP/1.1\r\nHost: a:1\r\nX-Two:  b c \t\r\nEmpty:\r\n"
                                    "Content-Length: 12\r\nExpect: 100-Continue\r\n\r\n");
  EXPECT_EQ(head.method, "POST");
  EXPECT_EQ(head.target, "/v1/x?a=b");
  EXPECT_TRUE(head.http11);
  EXPECT_TRUE(head.keepAlive);
  EXPECT_TRUE(head.expectContinue);
  EXPECT_EQ(head.contentLength, 12u);
  EXPECT_EQ(head.headers[1], (std::pair<std::string, std::string>{"x-two", "b c"}));
  EXPECT_EQ(head.headers[2].second, "");
}

TEST(RequestHead, KnowsWhetherTheConnectionStays) {
  EXPECT_FALSE(accepted("GET / HTTP/1.1\r\nHost: a\r\nConnection: x, Close\r\n\r\n").keepAlive);
  EXPECT_FALSE(accepted("GET / HTTP/1.0\r\n\r\n").keepAlive);
  EXPECT_TRUE(accepted("GET / HTTP/1.0\r\nConnection: keep-alive\r\n\r\n").keepAlive);
}

TEST(RequestHead, ValuesAreNotDecoded) {
  EXPECT_EQ(accepted("GET / HTTP/1.1\r\nHost: a\r\nX: a%0d%0ab\r\n\r\n").headers[1].second, "a%0d%0ab");
}

TEST(RequestHead, RefusesWhatTwoParsersCouldReadDifferently) {
  const std::string host = "Host: a\r\n";
  for (const std::string& text : {
           std::string("GET / HTTP/1.1\r\n\r\n"),           // no Host
           "GET / HTTP/1.1\r\n" + host + host + "\r\n",     // two
           "GET / HTTP/1.1\r\n" + host + "A : b\r\n\r\n",   // blank before the colon
           "GET / HTTP/1.1\r\n" + host + " folded\r\n\r\n", // folding
           "GET / HTTP/1.1\r\n" + host + "nocolon\r\n\r\n",
           "GET / HTTP/1.1\r\n" + host + "A: b\nC: d\r\n\r\n",               // bare line feed
           "GET / HTTP/1.1\r\n" + host + std::string("A: b\0c\r\n\r\n", 10), // NUL
           "GET / HTTP/1.1\r\n" + host + "Content-Length: 3\r\n\r\n",        // body of a GET
           "DELETE / HTTP/1.1\r\n" + host + "Content-Length: 3\r\n\r\n",
           "POST / HTTP/1.1\r\n" + host + "Content-Length: 3\r\nContent-Length: 3\r\n\r\n", // repeated length
           "POST / HTTP/1.1\r\n" + host + "Content-Length: 3, 3\r\n\r\n",
           "POST / HTTP/1.1\r\n" + host + "Content-Length: -3\r\n\r\n",
           "POST / HTTP/1.1\r\n" + host + "Content-Length: +3\r\n\r\n",
           "POST / HTTP/1.1\r\n" + host + "Content-Length: 0x3\r\n\r\n",
           "POST / HTTP/1.1\r\n" + host + "Content-Length: 99999999999999999999\r\n\r\n",
           "GET  / HTTP/1.1\r\n" + host + "\r\n",
           "GET /a b HTTP/1.1\r\n" + host + "\r\n",
           "GET http://a/ HTTP/1.1\r\n" + host + "\r\n",
           "GET /# HTTP/1.1\r\n" + host + "\r\n",
           "GET /\xff HTTP/1.1\r\n" + host + "\r\n",
           "G\x01T / HTTP/1.1\r\n" + host + "\r\n",
           "GET /\r\n" + host + "\r\n",
       })
    EXPECT_EQ(refused(text), 400) << text;
}

TEST(RequestHead, RefusesWhatIsNotReadHere) {
  EXPECT_EQ(refused("POST / HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n"), 411);
  EXPECT_EQ(refused("GET / HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n"), 411);
  EXPECT_EQ(refused("POST / HTTP/1.1\r\nHost: a\r\n\r\n"), 411);
  EXPECT_EQ(refused("POST / HTTP/1.1\r\nHost: a\r\nContent-Encoding: gzip\r\nContent-Length: 3\r\n\r\n"),
            415);
  EXPECT_EQ(refused("POST / HTTP/1.1\r\nHost: a\r\nExpect: tea\r\nContent-Length: 3\r\n\r\n"), 417);
  EXPECT_EQ(refused("GET / HTTP/2.0\r\nHost: a\r\n\r\n"), 505);
  EXPECT_EQ(refused("GET /" + std::string(kMaxTargetBytes, 'a') + " HTTP/1.1\r\nHost: a\r\n\r\n"), 414);
  std::string many = "GET / HTTP/1.1\r\nHost: a\r\n";
  for (int i = 0; i < 200; ++i)
    many += "A: b\r\n";
  EXPECT_EQ(refused(many + "\r\n"), 431);
}

TEST(RequestHead, FindsItsEnd) {
  EXPECT_EQ(findHeadEnd("GET / HTTP/1.1\r\nHost: a\r\n"), std::nullopt);
  EXPECT_EQ(findHeadEnd("a\r\n\r\nbody"), 5u);
}

} // namespace
} // namespace chamfer::http
