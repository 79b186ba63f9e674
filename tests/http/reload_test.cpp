// Scenes follow their files: every kind of file that a scene is made of, files that are half written,
// requests under way meanwhile, and memory that does not suffice.
#include "server/render/image/image_io.h"
#include "tests/http/metrics_text.h"
#include "tests/http/service_fixture.h"

#include <filesystem>
#include <fstream>
#include <functional>
#include <gmock/gmock.h>
#include <sys/stat.h>

namespace chamfer::http {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;

constexpr std::chrono::milliseconds kRescan{20};

class Reload : public test::ServiceTest {
protected:
  /// A scene with everything a scene can be made of.
  void addEverything() {
    folder_.write("part.mtl", "newmtl a\nKd 1 0 0\nmap_Kd image.exr\n");
    folder_.write("part.obj", "mtllib part.mtl\nusemtl a\n" + test::cubeObj());
    folder_.round("part.obj", 0.1);
    for (const char* name : {"image.exr", "wood.exr", "sky.exr"})
      paint(name, 0.5f);
    folder_.write("all.scene.json", kScene);
  }
  void paint(const std::string& name, float red) const {
    writeImage(folder_.path() / name, {2, 1, {red, 0, 0, 1, 0, 0, 1, 1}});
  }
  void watch(std::size_t memory = SIZE_MAX) {
    service_.reset();
    catalogue_ = std::make_unique<Catalogue>(folder_.path(), kRescan, memory);
    catalogue_->start();
    ASSERT_TRUE(within([&] { return catalogue_->loaded(); }));
    service_ = std::make_unique<Service>(ServiceOptions{.threads = 1}, *catalogue_, StaticFiles());
  }
  static bool within(const std::function<bool()>& condition) {
    for (int i = 0; i < 1000 && !condition(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return condition();
  }
  std::string id(const std::string& name) {
    const auto entry = catalogue_->find(name);
    return entry && entry->scene ? entry->scene->id.hex() : "";
  }
  /// Does the scene get another id after `change`?
  bool follows(const std::string& name, const std::function<void()>& change) {
    const std::string before = id(name);
    EXPECT_NE(before, "") << (catalogue_->find(name) ? catalogue_->find(name)->error : "none");
    change();
    return within([&] { return id(name) != before && id(name) != ""; });
  }
  std::vector<std::string> warnings(const std::string& name) {
    return json(get("/v1/scenes/" + name))["warnings"];
  }

  static constexpr const char* kScene = R"({
    "meshes": [{"name": "m", "file": "part.obj"}],
    "materials": [{"name": "w", "base_color_texture": "wood.exr"}],
    "instances": [{"mesh": "m"}, {"mesh": "m", "material": "w", "translate": [2, 0, 0]}],
    "lights": [{"type": "environment", "image": "sky.exr"}]})";
};

TEST_F(Reload, EveryFileOfASceneIsWatched) {
  addEverything();
  watch();
  EXPECT_THAT(json(get("/v1/scenes/all"))["load"]["files"].get<std::vector<std::string>>(),
              testing::UnorderedElementsAre("all.scene.json", "part.obj", "part.obj.chamfer", "part.mtl",
                                            "image.exr", "wood.exr", "sky.exr"));
  EXPECT_TRUE(follows("all", [&] { folder_.round("part.obj", 0.2); })) << "sidecar";
  EXPECT_TRUE(follows("all", [&] { folder_.write("part.mtl", "newmtl a\nKd 0 1 0\n"); })) << "materials";
  EXPECT_TRUE(follows("all", [&] { folder_.write("part.mtl", "newmtl a\nmap_Kd image.exr\n"); }));
  EXPECT_TRUE(follows("all", [&] { paint("image.exr", 0.25f); })) << "texture of the mesh's materials";
  EXPECT_TRUE(follows("all", [&] { paint("wood.exr", 0.75f); })) << "texture of the scene's materials";
  EXPECT_TRUE(follows("all", [&] { paint("sky.exr", 2); })) << "environment";
  EXPECT_TRUE(follows("all", [&] {
    folder_.write("part.obj", "mtllib part.mtl\nusemtl a\n" + test::cubeObj(0.75));
    folder_.round("part.obj", 0.1);
  })) << "mesh";
  EXPECT_TRUE(follows("all", [&] {
    std::string text = kScene;
    text.replace(text.find("[2, 0, 0]"), 9, "[3, 0, 0]");
    folder_.write("all.scene.json", text);
  })) << "scene file, of equal length";
}

TEST_F(Reload, FileThatWasMissingIsTakenUpWhenItComes) {
  addEverything();
  fs::remove(folder_.path() / "image.exr");
  fs::remove(folder_.path() / "part.mtl");
  watch();
  EXPECT_THAT(warnings("all"), Contains(HasSubstr("part.mtl")));
  EXPECT_TRUE(follows("all", [&] { folder_.write("part.mtl", "newmtl a\nmap_Kd image.exr\n"); }));
  EXPECT_THAT(warnings("all"), Contains(HasSubstr("image.exr")));
  EXPECT_TRUE(follows("all", [&] { paint("image.exr", 0.5f); }));
  EXPECT_THAT(warnings("all"), testing::IsEmpty());
}

TEST_F(Reload, EqualSizeAndDateDoNotHideAChange) {
  folder_.addCube("cube.obj");
  folder_.write("both.scene.json",
                R"({"meshes":[{"name":"m","file":"cube.obj","radius":0.1}],"instances":[{"mesh":"m"}]})");
  watch();
  EXPECT_TRUE(follows("both", [&] {
    const fs::path file = folder_.path() / "both.scene.json", other = folder_.path() / "other";
    const auto date = fs::last_write_time(file);
    folder_.write("other",
                  R"({"meshes":[{"name":"m","file":"cube.obj","radius":0.2}],"instances":[{"mesh":"m"}]})");
    fs::last_write_time(other, date);
    fs::rename(other, file);
    ASSERT_EQ(fs::last_write_time(file), date);
  }));
}

TEST_F(Reload, HalfWrittenFileKeepsTheOldScene) {
  addEverything();
  watch();
  const std::string before = id("all"), tile = "/v1/scenes/" + before + "/tiles/16x16/0,0,16,16/0-1.f16";
  const std::string bytes = get(tile).body;
  const std::string mesh = "mtllib part.mtl\nusemtl a\n" + test::cubeObj(0.75), scene = kScene;
  const struct {
    std::string file, half, whole;
  } writes[] = {{"all.scene.json", scene.substr(0, scene.size() / 2), scene + "\n"},
                {"part.obj", mesh.substr(0, mesh.size() / 2), mesh},
                {"wood.exr", "", ""}};
  for (const auto& [file, half, whole] : writes) {
    const std::string old = id("all");
    folder_.write(file, half);
    ASSERT_TRUE(within([&] { return !catalogue_->find("all")->outdated.empty(); })) << file;
    EXPECT_EQ(id("all"), old) << file;
    EXPECT_EQ(catalogue_->find("all")->state, SceneState::Ready);
    EXPECT_THAT(warnings("all"), Contains(HasSubstr("served as it was before"))) << file;
    EXPECT_EQ(get("/v1/scenes/" + old + "/tiles/16x16/0,0,16,16/0-1.f16").status, 200);
    EXPECT_GE(test::seriesOf(get("/metrics").body).at("chamfer_scenes_outdated"), 1);
    EXPECT_EQ(get("/readyz").status, 200);
    if (whole.empty()) break;
    folder_.write(file, whole);
    if (file == "part.obj") folder_.round(file, 0.1);
    ASSERT_TRUE(within([&] { return catalogue_->find("all")->outdated.empty(); })) << file;
    EXPECT_NE(id("all"), old);
    EXPECT_THAT(warnings("all"), testing::IsEmpty());
  }
  EXPECT_EQ(get(tile).status, 404) << "its files are no more";
  EXPECT_FALSE(bytes.empty());
}

TEST_F(Reload, RequestUnderWayEndsWithTheSceneItBeganWith) {
  folder_.addCube("cube.obj");
  watch();
  const std::string tile = "/v1/scenes/" + id("cube") + "/tiles/256x256/0,0,192,192/0-24.f16";
  Response slow;
  std::jthread client([&] {
    Request request = this->request("GET", tile);
    slow = service_->answer(request);
  });
  ASSERT_TRUE(within([&] { return json(get("/v1/info"))["queue"]["running"] == 1; }));
  EXPECT_TRUE(follows("cube", [&] { folder_.addCube("cube.obj", 0.2); }));
  const bool underWay = json(get("/v1/info"))["queue"]["running"] == 1;
  client.join();
  EXPECT_TRUE(underWay) << "the render was too quick for this test";
  EXPECT_EQ(slow.status, 200);
  EXPECT_TRUE(follows("cube", [&] { folder_.addCube("cube.obj"); }));
  EXPECT_EQ(slow.body, get(tile).body) << "the same files again: the same id, the same bytes";
}

TEST_F(Reload, ReadersSeeOneSceneOrTheOther) {
  folder_.addCube("cube.obj");
  watch();
  std::atomic<bool> done = false;
  std::atomic<int> wrong = 0, asked = 0;
  std::vector<std::jthread> readers;
  for (int i = 0; i < 2; ++i)
    readers.emplace_back([&] {
      while (!done) {
        Request request = this->request("GET", "/v1/scenes/cube");
        wrong += service_->answer(request).status != 200;
        ++asked;
      }
    });
  for (int i = 1; i <= 5; ++i)
    EXPECT_TRUE(follows("cube", [&] {
      // As a careful writer does: beside it, then in its place.
      folder_.addCube("new.tmp.obj", 0.1 + 0.02 * i, 0.5);
      fs::rename(folder_.path() / "new.tmp.obj.chamfer", folder_.path() / "cube.obj.chamfer");
    }));
  done = true;
  readers.clear();
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(asked, 10);
}

TEST_F(Reload, ScenesBeyondTheMemoryAreRefusedWithTheNumbers) {
  folder_.addCube("a.obj");
  folder_.addCube("b.obj");
  watch();
  const std::size_t one = catalogue_->find("a")->bytes;
  EXPECT_GT(one, 1000u);
  watch(one + one / 2);
  EXPECT_EQ(catalogue_->find("a")->state, SceneState::Ready);
  EXPECT_EQ(catalogue_->find("b")->state, SceneState::Failed);
  EXPECT_EQ(catalogue_->find("b")->bytes, 0u);
  const Response response = get("/v1/scenes/b");
  EXPECT_EQ(response.status, 409);
  EXPECT_EQ(json(response)["type"], "urn:chamfer:problem:payload-too-large");
  EXPECT_THAT(response.body, HasSubstr("--scene-megabytes"));
  EXPECT_EQ(get("/v1/scenes/a/tiles/8x8/0,0,8,8/0-1.png").status, 307);
  // Room is made: it is tried again.
  fs::remove(folder_.path() / "a.obj.chamfer");
  EXPECT_TRUE(within([&] { return catalogue_->find("b")->state == SceneState::Ready; }));
}

} // namespace
} // namespace chamfer::http
