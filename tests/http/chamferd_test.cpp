// The real program: started, asked, stopped.
#include "tests/http/http_client.h"
#include "tests/http/program.h"
#include "tests/http/scene_folder.h"

#include <fstream>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace chamfer::test {
namespace {

using testing::HasSubstr;

TEST(Chamferd, ServesAFolderOfMeshesAndStopsOnSigterm) {
  const SceneFolder folder;
  folder.addCube("cube.obj");
  folder.addCube("sub/small.obj", 0.02, 0.1);
  Program program({"serve", folder.path().string(), "--port", "0"});
  const int port = program.port();
  EXPECT_EQ(get(port, "/readyz").status, 200);
  const auto list = nlohmann::json::parse(get(port, "/v1/scenes").body);
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0]["name"], "cube");
  EXPECT_EQ(list[1]["name"], "sub/small");
  EXPECT_THAT(get(port, "/").body, HasSubstr("<title>Chamfer"));
  EXPECT_EQ(post(port, "/v1/scenes/cube/rays", R"({"rays":[[0,0,5,0,0,-1]]})").status, 200);
  program.signal(SIGTERM);
  EXPECT_EQ(program.finish(), 0);

  // Every line of the log is JSON; the requests are in it.
  std::istringstream log(program.errorText());
  std::vector<std::string> paths;
  for (std::string line; std::getline(log, line);) {
    const auto json = nlohmann::json::parse(line);
    EXPECT_TRUE(json.contains("time") && json.contains("level")) << line;
    if (json.value("event", "") == "request") {
      paths.push_back(json["path"]);
      for (const char* key : {"id", "client", "method", "status", "ms", "bytes"})
        EXPECT_TRUE(json.contains(key)) << line;
    }
  }
  EXPECT_THAT(paths, testing::ElementsAre("/readyz", "/v1/scenes", "/", "/v1/scenes/cube/rays"));
}

TEST(Chamferd, SameBytesWithAnyThreadsAndAfterARestart) {
  const SceneFolder folder;
  folder.addCube("cube.obj");
  std::vector<std::string> bodies;
  for (const char* threads : {"1", "2", "2"}) {
    Program program({"serve", folder.path().string(), "--port", "0", "--threads", threads});
    const int port = program.port();
    const std::string id = nlohmann::json::parse(get(port, "/v1/scenes/cube").body)["id"];
    const std::string tile = "/v1/scenes/" + id + "/tiles/96x64/16,8,64,48/0-4.f16?radius=0.2";
    for (int i = 0; i < 2; ++i) {
      const Reply reply = get(port, tile);
      ASSERT_EQ(reply.status, 200) << reply.body;
      bodies.push_back(reply.body);
    }
    program.signal(SIGTERM);
    EXPECT_EQ(program.finish(), 0);
  }
  for (const std::string& body : bodies)
    EXPECT_EQ(body, bodies.front());
}

TEST(Chamferd, BadInputIsAnsweredAndTheServerStays) {
  const SceneFolder folder;
  folder.addCube("cube.obj");
  folder.addCube("stale.obj");
  folder.write("stale.obj", cubeObj(0.75));
  folder.addCube("cut.obj");
  std::filesystem::resize_file(folder.path() / "cut.obj.chamfer", 100);
  folder.addCube("flipped.obj");
  {
    std::fstream file(folder.path() / "flipped.obj.chamfer", std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(200);
    const int byte = file.peek();
    file.put(static_cast<char>(byte ^ 1));
  }
  Program program({"serve", folder.path().string(), "--port", "0"});
  const int port = program.port();
  const auto expect = [&](const Reply& reply, int status, const std::string& words) {
    EXPECT_EQ(reply.status, status) << reply.body;
    EXPECT_THAT(reply.body, HasSubstr(words));
    EXPECT_EQ(reply.body.find(folder.path().string()), std::string::npos) << reply.body;
    EXPECT_EQ(get(port, "/livez").status, 200);
  };
  expect(get(port, "/v1/scenes/none"), 404, "none");
  expect(get(port, "/v1/scenes/stale"), 409, "stale-sidecar");
  expect(get(port, "/v1/scenes/cut/tiles/8x8/0,0,8,8/0-1.png"), 409, "damaged-sidecar");
  expect(post(port, "/v1/scenes/flipped/rays", R"({"rays":[]})"), 409, "damaged-sidecar");
  expect(post(port, "/v1/scenes/cube/rays", R"({"rays":[[0,0,0,0,0,1],[1,2,"x",0,0,1]]})"), 400,
         "rays[1][2]");
  expect(post(port, "/v1/scenes/cube/rays", R"({"rays":[[0,0,0,0,0,1e999]]})"), 422, "rays[0][5]");
  expect(post(port, "/v1/scenes/cube/rays", R"({"rays":[]})", "text/plain"), 415, "application/json");
  expect(get(port, "/v1/scenes/cube/tiles/8x8/0,0,8,8/0-1.png?radius=0.6"), 307, "");
  program.signal(SIGINT);
  EXPECT_EQ(program.finish(), 0);
}

TEST(Chamferd, RequestsUnderWayAreFinishedWhileNotReady) {
  const SceneFolder folder;
  folder.addCube("cube.obj");
  Program program({"serve", folder.path().string(), "--port", "0", "--threads", "1"});
  const int port = program.port();
  const std::string id = nlohmann::json::parse(get(port, "/v1/scenes/cube").body)["id"];
  Connection client(port);
  client.send(requestText("GET", "/v1/scenes/" + id + "/tiles/512x512/0,0,256,256/0-16.f16"));
  const auto running = [&] {
    return nlohmann::json::parse(get(port, "/v1/info").body)["queue"]["running"] == 1;
  };
  for (int i = 0; i < 500 && !running(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  program.signal(SIGTERM);
  Reply ready;
  for (int i = 0; i < 100 && (ready = get(port, "/readyz")).status == 200; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(ready.status, 503);
  EXPECT_EQ(get(port, "/livez").status, 200);
  const auto reply = client.receive(false, std::chrono::seconds(120));
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 200);
  EXPECT_EQ(reply->body.size(), 16u + 256 * 256 * 8);
  EXPECT_EQ(program.finish(), 0);
}

TEST(Chamferd, EnvironmentMirrorsFlagsAndFlagsWin) {
  const SceneFolder folder;
  folder.addCube("cube.obj");
  Program program({"serve", "--waiting", "7"}, {"CHAMFER_ROOT=" + folder.path().string(), "CHAMFER_PORT=0",
                                                "CHAMFER_SLOTS=3", "CHAMFER_WAITING=5"});
  const auto info = nlohmann::json::parse(get(program.port(), "/v1/info").body);
  EXPECT_EQ(info["queue"]["slots"], 3);
  EXPECT_EQ(info["queue"]["places"], 7);
}

TEST(Chamferd, KeyFileLetsInWhoHasAKey) {
  const SceneFolder folder;
  const auto keys = folder.write("keys.txt", "# comment\n0123456789abcdef\r\n\n");
  Program program({"serve", folder.path().string(), "--port", "0", "--key-file", keys.string()});
  const int port = program.port();
  EXPECT_EQ(get(port, "/v1/scenes").status, 401);
  EXPECT_EQ(get(port, "/v1/scenes", "Authorization: Bearer 0123456789abcdef\r\n").status, 200);
}

TEST(Chamferd, RefusesToStartWithAReason) {
  const SceneFolder folder;
  const auto shortKey = folder.write("short.txt", "abc\n"), noKey = folder.write("none.txt", "#\n");
  const struct {
    std::vector<std::string> arguments;
    int status;
    const char* words;
  } cases[] = {
      {{}, 2, "subcommand"},
      {{"serve"}, 2, "root"},
      {{"serve", folder.path().string(), "--port", "99999"}, 2, "port"},
      {{"serve", folder.path().string(), "--frobnicate"}, 2, "frobnicate"},
      {{"serve", (folder.path() / "none").string(), "--port", "0"}, 3, "not a folder"},
      {{"serve", folder.path().string(), "--host", "0.0.0.0", "--port", "0"}, 2, "--no-auth"},
      {{"serve", folder.path().string(), "--port", "0", "--key-file", shortKey.string()}, 2, "at least 16"},
      {{"serve", folder.path().string(), "--port", "0", "--key-file", noKey.string()}, 2, "no key"},
      {{"serve", folder.path().string(), "--port", "0", "--web", folder.path().string()}, 3, "index.html"},
      {{"serve", folder.path().string(), "--port", "0", "--log-level", "loud"}, 2, "loud"},
      {{"render", (folder.path() / "none.obj").string(), "-o", (folder.path() / "x.png").string()},
       3,
       "none.obj"},
  };
  for (const auto& [arguments, status, words] : cases) {
    Program program(arguments);
    EXPECT_EQ(program.finish(), status) << words;
    EXPECT_THAT(program.errorText(), HasSubstr(words));
  }
}

TEST(Chamferd, RendersWithoutHttp) {
  const SceneFolder folder;
  folder.addCube("cube.obj");
  const auto image = folder.path() / "cube.png";
  Program program({"render", (folder.path() / "cube.obj").string(), "-o", image.string(), "--width", "32",
                   "--height", "32", "--samples", "1", "--eye", "0,-4,1", "--target", "0,0,0", "--up",
                   "0,0,1"});
  EXPECT_EQ(program.finish(), 0) << program.errorText();
  std::ifstream file(image, std::ios::binary);
  std::string magic(4, '\0');
  file.read(magic.data(), 4);
  EXPECT_EQ(magic, "\x89PNG");
}

} // namespace
} // namespace chamfer::test
