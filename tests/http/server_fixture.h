// A service on a real socket, with one scene "cube".
#pragma once

#include "server/http/connection/http_server.h"
#include "server/render/image/image_io.h"
#include "tests/http/http_client.h"
#include "tests/http/service_fixture.h"

namespace chamfer::test {

class ServerTest : public ServiceTest {
protected:
  ServerTest() { folder_.addCube("cube.obj"); }
  ~ServerTest() override {
    if (server_) server_->stop(std::chrono::milliseconds(0));
  }

  void start(http::ServiceOptions options = {}, http::ConnectionLimits limits = {}) {
    server_.reset();
    key_ = options.keys.empty() ? "" : options.keys[0];
    serve(std::move(options));
    limits.workers = service_->blockingRequests() + 4;
    server_ = std::make_unique<http::HttpServer>(
        limits,
        [this](http::Request& request, const http::Problem* refusal) {
          return service_->answer(request, refusal);
        },
        [this](http::Request& request) { return service_->screen(request); });
    service_->observeConnections([this] { return server_->counts(); });
    port_ = server_->start("127.0.0.1", 0);
  }
  std::string slowTile() {
    return "/v1/scenes/" + idOf("cube") + "/tiles/4096x4096/0,0,1024,1024/0-1024.f16";
  }
  std::string quickTile() { return "/v1/scenes/" + idOf("cube") + "/tiles/64x64/0,0,32,32/0-1.f16"; }
  int running() { return static_cast<int>(json(service_->answer(info_))["queue"]["running"]); }
  void waitForRunning(int count) {
    for (int i = 0; i < 1000 && running() != count; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    ASSERT_EQ(running(), count);
  }
  /// The server answers at once that it lives.
  void expectAlive() {
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(test::get(port_, "/livez").status, 200);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(500));
  }
  /// The same, and that it renders a tile as it always did.
  void expectServing() {
    expectAlive();
    const std::string authorization = key_.empty() ? "" : "Authorization: Bearer " + key_ + "\r\n";
    const Reply tile = test::get(port_, quickTile(), authorization);
    EXPECT_EQ(tile.status, 200) << tile.body;
    if (tile_.empty()) {
      // Rendered without a server, before it is believed.
      const auto scene = catalogue_->find("cube")->scene;
      RenderSettings settings;
      settings.width = settings.height = 64;
      const auto image = renderTile(*prepare(scene, {}), settings, {0, 0, 32, 32}).image;
      const auto bytes = encodeF16(image, 1);
      tile_.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    }
    EXPECT_TRUE(tile.body == tile_) << "not the right tile";
  }

  http::Request info_ = request("GET", "/v1/info");
  std::unique_ptr<http::HttpServer> server_;
  int port_ = 0;

private:
  std::string key_;
  std::string tile_;
};

} // namespace chamfer::test
