// A service over a temporary folder of scenes, asked without sockets.
#pragma once

#include "server/http/monitoring/log.h"
#include "server/http/service.h"
#include "tests/http/scene_folder.h"

#include <gtest/gtest.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

namespace chamfer::test {

class ServiceTest : public testing::Test {
protected:
  ServiceTest() { http::startLog("off"); }

  /// Loads what is in the folder by now.
  void serve(http::ServiceOptions options = {}) {
    service_.reset();
    catalogue_ = std::make_unique<http::Catalogue>(folder_.path(), std::chrono::milliseconds(0));
    catalogue_->start();
    for (int i = 0; i < 1000 && !catalogue_->loaded(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_TRUE(catalogue_->loaded());
    service_ = std::make_unique<http::Service>(std::move(options), *catalogue_, http::StaticFiles());
  }

  static http::Request request(const std::string& method, const std::string& target,
                               http::Headers headers = {}, const std::string& body = "") {
    http::Request request;
    request.method = method;
    request.path = target.substr(0, target.find('?'));
    if (target.find('?') != std::string::npos) request.query = target.substr(target.find('?') + 1);
    request.headers = std::move(headers);
    request.body = body;
    request.client = "test";
    return request;
  }

  http::Response ask(const std::string& method, const std::string& target, http::Headers headers = {},
                     const std::string& body = "") {
    http::Request asked = request(method, target, std::move(headers), body);
    http::Response response = service_->answer(asked);
    EXPECT_NE(response.header("X-Request-Id"), nullptr);
    EXPECT_NE(response.header("X-Content-Type-Options"), nullptr);
    if (response.status >= 400) {
      EXPECT_EQ(response.contentType, "application/problem+json");
      EXPECT_EQ(response.body.find(folder_.path().string()), std::string::npos) << "a path of the server";
    }
    return response;
  }
  http::Response get(const std::string& target, http::Headers headers = {}) {
    return ask("GET", target, std::move(headers));
  }
  http::Response rays(const std::string& scene, const std::string& body) {
    return ask("POST", "/v1/scenes/" + scene + "/rays", {{"content-type", "application/json"}}, body);
  }
  std::string idOf(const std::string& name) { return catalogue_->find(name)->scene->id.hex(); }
  static nlohmann::json json(const http::Response& response) { return nlohmann::json::parse(response.body); }

  SceneFolder folder_;
  std::unique_ptr<http::Catalogue> catalogue_;
  std::unique_ptr<http::Service> service_;
};

} // namespace chamfer::test
