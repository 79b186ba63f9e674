// What balancers and proxies rely on: who the client is, and an end that is announced before it comes.
#include "tests/http/service_fixture.h"

#include <gmock/gmock.h>

namespace chamfer::http {
namespace {

class BehindProxy : public test::ServiceTest {
protected:
  /// Whom the service takes the sender of these headers for.
  std::string clientOf(Headers headers) {
    Request asked = request("GET", "/livez", std::move(headers));
    asked.client = "192.0.2.1";
    service_->answer(asked);
    return asked.client;
  }
};

TEST_F(BehindProxy, ClientIsTheLastForwardedAddressWhenTheProxyIsTrusted) {
  serve({.behindProxy = true});
  EXPECT_EQ(clientOf({{"x-forwarded-for", "198.51.100.7"}}), "198.51.100.7");
  EXPECT_EQ(clientOf({{"x-forwarded-for", "10.0.0.1, 198.51.100.7"}}), "198.51.100.7")
      << "the first is the client's";
  EXPECT_EQ(clientOf({{"x-forwarded-for", "10.0.0.1"}, {"x-forwarded-for", "2001:db8::7"}}), "2001:db8::7");
  EXPECT_EQ(clientOf({}), "192.0.2.1");
  EXPECT_EQ(clientOf({{"x-forwarded-for", ""}}), "192.0.2.1");
}

TEST_F(BehindProxy, ForwardedAddressIsNotBelievedUnasked) {
  serve();
  EXPECT_EQ(clientOf({{"x-forwarded-for", "198.51.100.7"}}), "192.0.2.1");
}

TEST_F(BehindProxy, AnnouncedEndIsSeenBeforeWorkIsRefused) {
  folder_.addCube("cube.obj");
  serve();
  const std::string tile = "/v1/scenes/" + idOf("cube") + "/tiles/8x8/0,0,8,8/0-1.png";
  EXPECT_EQ(get("/readyz").status, 200);
  EXPECT_FALSE(get(tile).close);

  service_->announceEnd();
  EXPECT_EQ(get("/readyz").status, 503);
  const Response during = get(tile);
  EXPECT_EQ(during.status, 200);
  EXPECT_TRUE(during.close);

  service_->drain();
  EXPECT_EQ(get(tile).status, 503);
  EXPECT_EQ(get("/livez").status, 200);
}

} // namespace
} // namespace chamfer::http
