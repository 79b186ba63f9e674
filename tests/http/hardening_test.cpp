// Attacks, each followed by proof that the server still answers at once and renders the right tile
// (ServerTest::expectServing). What the HTTP library and its like are known to get wrong, and the tests that
// show it closed:
//
// - header shadowing: Hardening.RepeatedFieldsAreNotShadowed, .FieldsDoNotNameTheClient
// - gzip bombs: Server.RefusesHostileFramingAndLives (Content-Encoding is 415)
// - exception text sent to clients: Hardening.NothingOfALibraryReachesAClient
// - percent-decoded CR LF in headers: Server.HeadersCannotBeInjected, RequestHead.ValuesAreNotDecoded
// - smuggling (body of a GET, two lengths, length and chunked): Hardening.SmuggledRequestsAreNotSeen
// - hundreds of ranges: Server.RangesAndCompressionAreIgnored
// - chunked bodies: Server.RefusesHostileFramingAndLives (411)
// - huge, endless and trickled heads: Hardening.EndlessHeadsAndTrickledOnesEnd
// - slow and idle connections: Server.IdleAndSlowClientsAreDroppedInTime, .SlowAndIdleClientsStarveNobody
// - bodies that are promised and not sent, or sent slowly: Bodies
// - descriptors or memory that run out: Faults
// - clients that read nothing: Server.ClientThatReadsNothingIsDropped, .UnreadAnswersHaveABound
// - floods of pipelined requests: Hardening.PipelinedFloodIsAnsweredInOrder
// - other protocols on the port: Hardening.OtherProtocolsAreTurnedAway
// - paths with .., %2e, %5c, NUL; links: Hardening.NoPathLeadsOut, .LinksOfASceneDoNotLeadOut
// - DNS rebinding: Routes.OtherHostsAreNotAnswered, Hardening.HostsAndKeysHold
// - work asked for by pages of other sites: Routes.PagesOfOtherSitesCannotMakeItWork
// - caches that give one client what another's key was asked for:
// Routes.WhatAKeyIsAskedForIsNotForSharedCaches
// - guessed keys: Hardening.HostsAndKeysHold (sameSecret in service.cpp looks at every byte)
// - listening beyond loopback without a key: Chamferd.RefusesToStartWithAReason
// - too much work in one request: TileRequest.LimitsTheWorkOfOneRequest,
// Images.WhatTheDeadlineCannotServeIsRefusedSoonWithWhatFits,
//   tests/browser/openapi.test.mjs
// - too much memory: Hardening.RoundingsBeyondTheLimitAreRefusedBeforeTheyAreBuilt, PreparedCacheTest,
//   Reload.ScenesBeyondTheMemoryAreRefusedWithTheNumbers
// - coordinates that end Embree: Rays.LargestNumbersDoNoHarm, FarRays
// - images of comparisons outside of the served folder, pictures that unpack to gigabytes, jobs without end:
//   Comparisons.FilesOutsideOrHiddenAreNotThere, .LargeFilesAndPicturesAreRefused,
//   .BadBodiesAreRefusedWithTheirPlace
// - jobs that crowd out people at the page: tests/load/jobs_beside_viewers.mjs, RenderQueue.Background*
// - jobs that end the server: JobResume.AJobThatEndsItsServerAgainAndAgainIsGivenUp
// - forged log lines: Log.ValuesCannotForgeALine
#include "tests/http/server_fixture.h"

#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>

namespace chamfer::http {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using test::Connection;
using test::Reply;
using test::requestText;
using testing::HasSubstr;
using testing::Not;

class Hardening : public test::ServerTest {
protected:
  std::string rays() const { return "/v1/scenes/cube/rays"; }
};

TEST_F(Hardening, RepeatedFieldsAreNotShadowed) {
  start({.keys = {"0123456789abcdef"}});
  const std::string good = "Authorization: Bearer 0123456789abcdef\r\n", bad = "Authorization: Bearer x\r\n";
  for (const std::string& fields :
       {good + bad, bad + good, good + good, good + "X-Request-Id: a\r\nX-Request-Id: b\r\n",
        good + "Host: evil.example\r\n", std::string("X-Api-Key: 0123456789abcdef\r\nX-API-KEY: x\r\n")})
    EXPECT_EQ(test::get(port_, "/v1/info", fields).status, 400) << fields;
  expectServing();
}

TEST_F(Hardening, FieldsDoNotNameTheClient) {
  // The library puts the peer's address into fields of these names, where a client's own would come first.
  const std::string fields = "REMOTE_ADDR: 192.0.2.9\r\nREMOTE_PORT: 1\r\nLOCAL_ADDR: 192.0.2.9\r\n"
                             "X-Forwarded-For: 192.0.2.9\r\nX-Real-IP: 192.0.2.9\r\n"
                             "Forwarded: for=192.0.2.9\r\n";
  const std::string body = R"({"rays":[]})";
  for (const bool behindProxy : {false, true}) {
    serve({.behindProxy = behindProxy});
    // Whom the service answered, and whom the body was read from.
    std::vector<std::string> clients;
    std::mutex mutex;
    const auto note = [&](const Request& request) {
      const std::lock_guard lock(mutex);
      clients.push_back(request.client);
    };
    HttpServer server(
        {},
        [&](Request& request, const Problem* refusal) {
          Response response = service_->answer(request, refusal);
          note(request);
          return response;
        },
        [&](Request& request) {
          auto problem = service_->screen(request);
          note(request);
          return problem;
        });
    const int port = server.start("127.0.0.1", 0);
    EXPECT_EQ(test::get(port, "/v1/info", fields).status, 200);
    EXPECT_EQ(
        test::raw(port, requestText("POST", rays(), fields + "Content-Type: application/json\r\n", body))
            .status,
        200);
    server.stop(std::chrono::seconds(5));
    // The one field that a trusted proxy fills, where there is one; this shows that the others would be seen.
    const std::string client = behindProxy ? "192.0.2.9" : "127.0.0.1";
    EXPECT_THAT(clients, testing::ElementsAre(client, client, client));
  }
}

TEST_F(Hardening, SmuggledRequestsAreNotSeen) {
  start();
  const std::string smuggled = "GET /v1/scenes HTTP/1.1\r\nHost: smuggled\r\n\r\n",
                    length = "Content-Length: " + std::to_string(smuggled.size()) + "\r\n";
  const struct {
    std::string head;
    int status;
  } attacks[] = {
      {"GET /livez HTTP/1.1\r\nHost: a\r\n" + length, 400},
      {"HEAD /livez HTTP/1.1\r\nHost: a\r\n" + length, 400},
      {"OPTIONS /livez HTTP/1.1\r\nHost: a\r\n" + length, 400},
      {"POST " + rays() + " HTTP/1.1\r\nHost: a\r\n" + length + "Transfer-Encoding: chunked\r\n", 411},
      {"POST " + rays() + " HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n" + length, 411},
      {"POST " + rays() + " HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: \tidentity\r\n" + length, 411},
      {"POST " + rays() + " HTTP/1.1\r\nHost: a\r\nContent-Length: 0\r\n" + length, 400},
      {"POST " + rays() + " HTTP/1.1\r\nHost: a\r\nContent-Length : 0\r\n", 400},
      {"POST " + rays() + " HTTP/1.1\r\nHost: a\r\nX: a\r\n " + length, 400},
      {"POST " + rays() + " HTTP/1.1\r\nHost: a\r\nX: a\rContent-Length: 0\r\n", 400},
      {"GET /livez HTTP/1.1\nHost: a\n", 400},
  };
  for (const auto& [head, status] : attacks) {
    Connection connection(port_);
    connection.send(head + "\r\n" + smuggled);
    const auto reply = connection.receive(head.starts_with("HEAD"), milliseconds(3000));
    ASSERT_TRUE(reply) << head;
    EXPECT_EQ(reply->status, status) << head;
    EXPECT_THAT(reply->body, Not(HasSubstr("cube")));
    EXPECT_FALSE(connection.receive(false, milliseconds(200))) << "answered what was smuggled: " << head;
  }
  expectServing();
}

TEST_F(Hardening, EndlessHeadsAndTrickledOnesEnd) {
  ConnectionLimits limits;
  limits.head = milliseconds(600);
  start({}, limits);
  Connection endless(port_);
  endless.send("GET / HTTP/1.1\r\nHost: a\r\n");
  bool open = true;
  for (int i = 0; i < 100 && open; ++i)
    open = endless.send("X-" + std::to_string(i) + ": " + std::string(1000, 'a') + "\r\n");
  const auto reply = endless.receive(false, milliseconds(2000));
  if (reply) { // its connection may be reset before it is read
    EXPECT_EQ(reply->status, 431);
  }
  EXPECT_TRUE(endless.closedWithin(milliseconds(2000)));

  // A byte now and then does not move the deadline.
  Connection trickled(port_);
  const auto begin = std::chrono::steady_clock::now();
  const std::string head = "GET /livez HTTP/1.1\r\nHost: a\r\nX: ";
  for (std::size_t i = 0; i < 40 && trickled.send(i < head.size() ? head.substr(i, 1) : "a"); ++i)
    std::this_thread::sleep_for(milliseconds(50));
  const auto timeout = trickled.receive(false, milliseconds(500));
  ASSERT_TRUE(timeout);
  EXPECT_EQ(timeout->status, 408);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, milliseconds(3500));
  expectServing();
}

TEST_F(Hardening, PipelinedFloodIsAnsweredInOrder) {
  start({.threads = 1});
  constexpr int kRequests = 2000;
  Connection connection(port_);
  std::jthread sender([&] {
    for (int i = 0; i < kRequests; ++i)
      connection.send(requestText("GET", "/livez", "X-Request-Id: r" + std::to_string(i) + "\r\n"));
  });
  for (int i = 0; i < kRequests; ++i) {
    const auto reply = connection.receive();
    ASSERT_TRUE(reply) << i;
    ASSERT_EQ(reply->header("x-request-id"), "r" + std::to_string(i));
  }
  sender.join();
  // One that renders holds back what is behind it, and nobody else.
  connection.send(requestText("GET", slowTile()));
  waitForRunning(1);
  for (int i = 0; i < 200; ++i)
    connection.send(requestText("GET", "/livez"));
  expectServing();
  connection.abort();
  waitForRunning(0);
}

TEST_F(Hardening, OtherProtocolsAreTurnedAway) {
  start();
  for (const std::string& bytes :
       {std::string("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"), std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc"),
        std::string("SSH-2.0-OpenSSH_9.2\r\n\r\n"),
        std::string("CONNECT evil.example:443 HTTP/1.1\r\nHost: a\r\n\r\n"),
        std::string("GET http://evil.example/ HTTP/1.1\r\nHost: a\r\n\r\n"),
        std::string("\0\0\0\0\r\n\r\n", 8),
        std::string("GET / HTTP/1.1\r\nHost: a\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\r\n")}) {
    Connection connection(port_);
    connection.send(bytes);
    const auto reply = connection.receive(false, milliseconds(3000));
    ASSERT_TRUE(reply) << bytes;
    const bool upgrade = bytes.find("Upgrade") != std::string::npos; // may be ignored (RFC 9110, 7.8)
    EXPECT_EQ(reply->status == 200, upgrade) << bytes;
    EXPECT_NE(reply->status, 101);
  }
  expectServing();
}

TEST_F(Hardening, NoPathLeadsOut) {
  // A file beside the served folder, one in it that is no scene, and a hidden scene.
  const fs::path outside = folder_.path().string() + "-secret.txt";
  std::ofstream(outside) << "the secret";
  folder_.write("secret.txt", "the secret");
  folder_.addCube(".hidden/cube.obj");
  start();
  const std::string name = outside.filename().string();
  std::vector<std::string> paths;
  for (const char* up : {"..", "%2e%2e", ".%2E", "..%2f..", "..%5c..", "..\\..", "..%00", "....//..",
                         "%252e%252e", "%c0%ae%c0%ae", "..;", "."})
    for (const std::string& prefix :
         {std::string("/"), std::string("/v1/scenes/"), std::string("/v1/scenes/cube/"), std::string("//"),
          std::string("/v1/scenes/cube%2f")})
      for (const std::string& target :
           {name, std::string("secret.txt"), std::string("etc/passwd"), folder_.path().string()}) {
        paths.push_back(prefix + up + "/" + target);
        paths.push_back(prefix + up + "/" + up + "/" + up + "/" + up + "/" + target);
        paths.push_back(prefix + up + "/" + target + "/tiles/8x8/0,0,8,8/0-1.png");
      }
  for (const char* path :
       {"/secret.txt", "/%00", "/index.html%00.txt", "/.hidden/cube.obj", "/v1/scenes/.hidden/cube",
        "/v1/scenes/.hidden%2Fcube", "/v1/scenes/cube.obj", "/v1/scenes/cube.obj.chamfer",
        "/v1/scenes/%2Fetc%2Fpasswd", "/v1/scenes//etc/passwd", "/cube.obj", "/etc/passwd"})
    paths.emplace_back(path);
  Connection connection(port_);
  for (const std::string& path : paths) {
    connection.send(requestText("GET", path));
    const auto reply = connection.receive();
    ASSERT_TRUE(reply) << path;
    EXPECT_TRUE(reply->status == 400 || reply->status == 404) << path << ' ' << reply->status;
    EXPECT_THAT(reply->body, Not(HasSubstr("the secret"))) << path;
    EXPECT_THAT(reply->body, Not(HasSubstr("root:"))) << path;
  }
  expectServing();
  fs::remove(outside);
}

TEST_F(Hardening, LinksOfASceneDoNotLeadOut) {
  const test::SceneFolder outside;
  outside.addCube("cube.obj", 0.2);
  outside.write("red.mtl", "newmtl a\nKd 1 0 0\n");
  writeImage(outside.path() / "t.exr", {1, 1, {1, 0, 0, 1}});
  const auto link = [&](const char* target, const char* name) {
    fs::create_symlink(outside.path() / target, folder_.path() / name);
  };
  link("t.exr", "t.exr");
  link("cube.obj", "out.obj");
  link("red.mtl", "red.mtl");
  folder_.write("sharp.obj", "mtllib red.mtl\nusemtl a\n" + test::cubeObj());
  folder_.write("bare.obj", test::cubeObj());
  link("cube.obj.chamfer", "bare.obj.chamfer");
  const auto scene = [](const std::string& mesh, const std::string& more) {
    return R"({"meshes":[{"name":"m","file":")" + mesh + R"("}],"instances":[{"mesh":"m"}])" + more + "}";
  };
  folder_.write("texture.scene.json",
                scene("cube.obj", R"(,"materials":[{"name":"t","base_color_texture":"t.exr"}])"));
  folder_.write("sky.scene.json", scene("cube.obj", R"(,"lights":[{"type":"environment","image":"t.exr"}])"));
  folder_.write("mesh.scene.json", scene("out.obj", ""));
  folder_.write("up.scene.json", scene("../" + outside.path().filename().string() + "/cube.obj", ""));
  folder_.write("absolute.scene.json", scene((outside.path() / "cube.obj").string(), ""));
  folder_.write("sidecar.scene.json", scene("bare.obj", ""));
  folder_.write("library.scene.json", scene("sharp.obj", ""));
  start();
  for (const char* name : {"texture", "sky", "mesh", "up", "absolute", "sidecar"}) {
    const Response response = get(std::string("/v1/scenes/") + name);
    EXPECT_EQ(response.status, 409) << name;
    EXPECT_THAT(response.body,
                testing::AnyOf(HasSubstr("outside of the served folder"), HasSubstr("not allowed"),
                               HasSubstr("relative to the scene file")))
        << name;
  }
  // Materials are never an error; what is outside is not read.
  const auto library = json(get("/v1/scenes/library"));
  EXPECT_THAT(library["warnings"].dump(), HasSubstr("red.mtl"));
  EXPECT_EQ(library["materials"].size(), 1u) << "only the neutral one";
  expectServing();
}

TEST_F(Hardening, HostsAndKeysHold) {
  start({.keys = {"0123456789abcdef"}, .hosts = {"localhost"}});
  EXPECT_EQ(test::raw(port_, "GET /v1/info HTTP/1.1\r\nHost: evil.example\r\n\r\n").status, 421);
  EXPECT_EQ(test::raw(port_, "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n").status, 421);
  for (const std::string& key :
       {std::string("0123456789abcde"), std::string("0123456789abcdeF"), std::string("0123456789abcdef0"),
        std::string(8000, '0'), std::string("%30123456789abcdef"),
        std::string("0123456789abcdef, 0123456789abcdef")})
    EXPECT_EQ(test::get(port_, "/v1/info", "Authorization: Bearer " + key + "\r\n").status, 403) << key;
  EXPECT_EQ(test::get(port_, "/v1/info", "Authorization: Basic 0123456789abcdef\r\n").status, 403);
  EXPECT_EQ(test::get(port_, "/v1/info?key=0123456789abcdef").status, 401)
      << "keys do not belong into addresses";
  EXPECT_EQ(test::get(port_, "/metrics").status, 401);
  EXPECT_EQ(test::post(port_, rays(), R"({"rays":[]})").status, 401);
  expectServing();
}

TEST_F(Hardening, NothingOfALibraryReachesAClient) {
  folder_.write("broken.scene.json", "{\"meshes\": [\xff]}");
  folder_.write("bad.obj", "v nan 0 0\nf 1 1 1\n");
  folder_.write("bad.obj.chamfer", "CHAMFER");
  start();
  const std::string tile = "/v1/scenes/" + idOf("cube") + "/tiles/";
  std::vector<Reply> replies = {
      test::get(port_, "/v1/scenes/broken"),
      test::get(port_, "/v1/scenes/bad"),
      test::get(port_, "/v1/scenes/%ff%fe"),
      test::get(port_, "/v1/scenes/cube%"),
      test::get(port_, "/v1/info?%ff=%fe"),
      test::get(port_, tile + "8x8/0,0,8,8/0-1.f16?camera=1e999,0,0,0,0,0,0,0,1,40"),
      test::get(port_, tile + "8x8/0,0,8,8/0-1.f16?radius=%ff"),
      test::get(port_, tile + "8x8/0,0,8,8/0-1.f16?rounding=mesh:0"),
      test::get(port_, tile + "99999999999999999999x8/0,0,8,8/0-1.f16"),
      test::get(port_, tile + "8x8/0,0,8,8/0-1." + std::string(3000, 'x')),
  };
  for (const char* body :
       {"", "{", "[", "nul", "{\"rays\":\"\xff\"}", "{\"rays\":[[1e999]]}", "{\"rays\":[[1,2,3]]}",
        "\xef\xbb\xbf{}", "{\"rays\":[],\"rays\":[]}", "{\"\\ud800\":1}", "{\"rays\":{}}"})
    replies.push_back(test::post(port_, rays(), body));
  replies.push_back(test::post(port_, rays(), std::string(100'000, '[')));
  for (const Reply& reply : replies) {
    EXPECT_GE(reply.status, 400) << reply.body;
    EXPECT_LT(reply.status, 500) << reply.body;
    const auto problem = nlohmann::json::parse(reply.body); // and valid UTF-8
    EXPECT_EQ(problem["status"], reply.status);
    for (const char* word : {"json.exception", "parse_error", "nlohmann", "std::", "what()", "basic_string",
                             "Embree", "OpenImageIO", "CGAL", ".cpp", "/usr/", "stack"})
      EXPECT_THAT(reply.body, Not(HasSubstr(word)));
    EXPECT_THAT(reply.body, Not(HasSubstr(folder_.path().string())));
  }
  expectServing();
}

TEST_F(Hardening, RoundingsBeyondTheLimitAreRefusedBeforeTheyAreBuilt) {
  folder_.write("row.obj", test::rowObj(60)); // of 256 segments: half a million triangles each
  folder_.round("row.obj", 0.1);
  start();
  const auto begin = std::chrono::steady_clock::now();
  const Reply reply =
      test::get(port_, "/v1/scenes/" + idOf("row") + "/tiles/8x8/0,0,8,8/0-1.f16?rounding=mesh:256");
  EXPECT_EQ(reply.status, 422);
  EXPECT_THAT(reply.body, HasSubstr("triangles"));
  const auto problem = nlohmann::json::parse(reply.body);
  EXPECT_EQ(problem["parameter"], "rounding");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
  const unsigned most = problem["limits"]["maximum"];
  EXPECT_THAT(problem["detail"].get<std::string>(), HasSubstr("mesh:" + std::to_string(most)));
  const auto meshOf = [&](unsigned segments) {
    return test::get(port_, "/v1/scenes/" + idOf("row") +
                                "/tiles/8x8/0,0,8,8/0-1.f16?rounding=mesh:" + std::to_string(segments))
        .status;
  };
  EXPECT_EQ(meshOf(4), 200);
  EXPECT_EQ(meshOf(most + 1), 422);
  expectServing();
}

} // namespace
} // namespace chamfer::http
