#include "server/http/catalogue/catalogue.h"

#include "server/http/monitoring/log.h"
#include "tests/http/failing_calls.h"
#include "tests/http/scene_folder.h"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>

namespace chamfer::http {
namespace {

using test::SceneFolder;
using testing::ElementsAre;
using testing::HasSubstr;

namespace fs = std::filesystem;

std::vector<std::string> namesOf(const ScanResult& scan) {
  std::vector<std::string> names;
  for (const FoundScene& scene : scan.scenes)
    names.push_back(scene.name);
  return names;
}

void waitUntil(const std::function<bool()>& condition) {
  for (int i = 0; i < 1000 && !condition(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_TRUE(condition());
}

/// Loads everything below `folder` once.
std::unique_ptr<Catalogue> loaded(const SceneFolder& folder, int rescanMilliseconds = 0) {
  startLog("off");
  auto catalogue = std::make_unique<Catalogue>(folder.path(), std::chrono::milliseconds(rescanMilliseconds));
  catalogue->start();
  waitUntil([&] { return catalogue->loaded(); });
  return catalogue;
}

constexpr const char* kScene = R"({"meshes":[{"name":"m","file":"cube.obj"}],"instances":[{"mesh":"m"}]})";

TEST(CatalogueScan, NamesArePathsWithoutExtensions) {
  const SceneFolder folder;
  folder.write("b.OBJ", "");
  folder.write("b.OBJ.chamfer", "");
  folder.write("deep/er/c.stl", "");
  folder.write("deep/er/c.stl.chamfer", "");
  folder.write("deep/d.scene.json", "{}");
  folder.write("bare.obj", "");
  folder.write("notes.txt", "");
  folder.write("notes.txt.chamfer", "");
  folder.write(".hidden/e.scene.json", "{}");
  EXPECT_THAT(namesOf(scanRoot(folder.path())), ElementsAre("b", "deep/d", "deep/er/c"));
}

TEST(CatalogueScan, SceneFileWinsAndTheRestIsSaid) {
  const SceneFolder folder;
  for (const char* name :
       {"cube.obj", "cube.obj.chamfer", "two.obj", "two.obj.chamfer", "two.ply", "two.ply.chamfer"})
    folder.write(name, "");
  folder.write("cube.scene.json", "{}");
  const ScanResult scan = scanRoot(folder.path());
  EXPECT_THAT(namesOf(scan), ElementsAre("cube", "two", "two.ply"));
  EXPECT_EQ(scan.scenes[0].file.filename(), "cube.scene.json");
  EXPECT_EQ(scan.scenes[1].file.filename(), "two.obj");
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("cube.obj"), HasSubstr("two.ply")));
}

TEST(CatalogueScan, LinksDoNotLeadOut) {
  const SceneFolder outside, folder;
  outside.addCube("secret.obj");
  folder.addCube("real.obj");
  fs::create_symlink(outside.path() / "secret.obj", folder.path() / "link.obj");
  fs::create_symlink(outside.path() / "secret.obj.chamfer", folder.path() / "link.obj.chamfer");
  fs::create_directory_symlink(outside.path(), folder.path() / "folder");
  fs::create_symlink("real.obj", folder.path() / "inner.obj");
  fs::create_symlink("real.obj.chamfer", folder.path() / "inner.obj.chamfer");
  folder.write("half.obj", test::cubeObj());
  fs::create_symlink(outside.path() / "secret.obj.chamfer", folder.path() / "half.obj.chamfer");
  const ScanResult scan = scanRoot(folder.path());
  EXPECT_THAT(namesOf(scan), ElementsAre("inner", "real"));
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("half.obj.chamfer"), HasSubstr("link.obj")));
}

TEST(CatalogueScan, FolderThatVanishesMeanwhileTakesNothingElseWithIt) {
  const SceneFolder folder;
  for (const char* name : {"a", "deep/b", "deep/er/c", "gone/d", "z/e"})
    folder.write(name + std::string(".scene.json"), "{}");
  {
    const test::FailingFolder gone("/gone", ENOENT);
    const ScanResult scan = scanRoot(folder.path());
    EXPECT_THAT(namesOf(scan), ElementsAre("a", "deep/b", "deep/er/c", "z/e"));
    EXPECT_THAT(scan.unread, testing::IsEmpty());
  }
  // Any other fault says nothing of what is in it.
  for (const int error : {EIO, EMFILE, ENFILE, ENOMEM, EACCES, ESTALE}) {
    const test::FailingFolder failing("/deep", error);
    const ScanResult scan = scanRoot(folder.path());
    EXPECT_THAT(namesOf(scan), ElementsAre("a", "gone/d", "z/e")) << error;
    EXPECT_THAT(scan.unread, ElementsAre("deep"));
    EXPECT_TRUE(scan.mayHold("deep/b.scene.json"));
    EXPECT_TRUE(scan.mayHold("deep/er/c.scene.json"));
    EXPECT_FALSE(scan.mayHold("deeper.scene.json"));
    EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("deep cannot be read")));
  }
  const test::FailingFolder root(folder.path().filename().string(), EIO);
  EXPECT_THROW(scanRoot(folder.path()), Error);
}

TEST(Catalogue, FolderThatCannotBeReadNowKeepsItsScenes) {
  const SceneFolder folder;
  folder.addCube("a.obj", 0.1);
  folder.addCube("deep/b.obj", 0.2);
  folder.addCube("z/c.obj", 0.3);
  const auto catalogue = loaded(folder, 20);
  const std::string id = catalogue->find("deep/b")->scene->id.hex();
  const auto passes = [&](const char* name) { // a scan has been made since this was put there
    folder.addCube(name);
    waitUntil([&] {
      const auto entry = catalogue->find(fs::path(name).stem());
      return entry && entry->state == SceneState::Ready;
    });
  };
  {
    const test::FailingFolder failing("/deep", EIO);
    passes("one.obj");
    EXPECT_THAT(catalogue->warnings(), ElementsAre(HasSubstr("deep cannot be read")));
    for (const char* name : {"a", "deep/b", "z/c"}) {
      ASSERT_TRUE(catalogue->find(name)) << name;
      EXPECT_EQ(catalogue->find(name)->state, SceneState::Ready) << name;
    }
    EXPECT_EQ(catalogue->find(id), catalogue->find("deep/b"));
  }
  {
    const test::FailingFolder root(folder.path().filename().string(), ESTALE);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_EQ(catalogue->list().size(), 4u);
  }
  passes("two.obj");
  EXPECT_THAT(catalogue->warnings(), testing::IsEmpty());
  {
    const test::FailingFolder gone("/deep", ENOENT);
    passes("three.obj");
    EXPECT_FALSE(catalogue->find("deep/b"));
    EXPECT_FALSE(catalogue->find(id));
  }
  EXPECT_TRUE(catalogue->find("z/c"));
}

TEST(Catalogue, IdLivesAsLongAsAnyNameHasItsContent) {
  const SceneFolder folder;
  for (const char* name : {"a.obj", "b.obj", "c/d.obj"})
    folder.addCube(name);
  const auto catalogue = loaded(folder, 20);
  const std::string id = catalogue->find("a")->scene->id.hex();
  ASSERT_EQ(catalogue->find("b")->scene->id.hex(), id);
  ASSERT_EQ(catalogue->find("c/d")->scene->id.hex(), id);
  ASSERT_TRUE(catalogue->find(id));
  // One goes, one becomes another scene, and back; the last takes the id along.
  fs::remove(folder.path() / "a.obj.chamfer");
  waitUntil([&] { return !catalogue->find("a"); });
  ASSERT_TRUE(catalogue->find(id));
  EXPECT_EQ(catalogue->find(id)->scene->id.hex(), id);
  folder.round("c/d.obj", 0.2);
  waitUntil([&] { return catalogue->find("c/d")->scene->id.hex() != id; });
  EXPECT_EQ(catalogue->find(id), catalogue->find("b"));
  folder.round("c/d.obj", 0.1);
  waitUntil([&] { return catalogue->find("c/d")->scene->id.hex() == id; });
  folder.round("b.obj", 0.3);
  waitUntil([&] { return catalogue->find("b")->scene->id.hex() != id; });
  EXPECT_EQ(catalogue->find(id), catalogue->find("c/d"));
  fs::remove(folder.path() / "c/d.obj");
  waitUntil([&] { return !catalogue->find("c/d"); });
  EXPECT_FALSE(catalogue->find(id));
}

TEST(Catalogue, RootMustBeAFolder) {
  const SceneFolder folder;
  const auto file = folder.write("x", "");
  for (const fs::path& root : {file, folder.path() / "none"})
    EXPECT_THROW(Catalogue(root, std::chrono::milliseconds(0)), Error);
}

TEST(Catalogue, FindsByNameAndId) {
  const SceneFolder folder;
  folder.addCube("cube.obj");
  folder.addCube("sub/other.obj", 0.2);
  const auto catalogue = loaded(folder);
  ASSERT_EQ(catalogue->list().size(), 2u);
  const auto cube = catalogue->find("cube"), other = catalogue->find("sub/other");
  ASSERT_TRUE(cube && cube->scene && other && other->scene);
  EXPECT_EQ(cube->state, SceneState::Ready);
  EXPECT_EQ(cube->scene->roundedEdges, 12u);
  EXPECT_EQ(catalogue->find(cube->scene->id.hex()), cube);
  EXPECT_NE(cube->scene->id, other->scene->id);
  EXPECT_EQ(catalogue->find("cub"), nullptr);
  EXPECT_EQ(catalogue->find("../cube"), nullptr);
}

TEST(Catalogue, NamesTheFaultOfEachBrokenScene) {
  const SceneFolder folder;
  folder.addCube("good.obj");
  folder.addCube("stale.obj");
  folder.write("stale.obj", test::cubeObj(0.75));
  folder.addCube("cut.obj");
  fs::resize_file(folder.path() / "cut.obj.chamfer", 100);
  folder.addCube("flipped.obj");
  {
    std::fstream file(folder.path() / "flipped.obj.chamfer", std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(-5, std::ios::end);
    const int byte = file.peek();
    file.put(static_cast<char>(byte ^ 4));
  }
  folder.addCube("broken.obj");
  folder.write("broken.obj", "v 0 0 nan\n");
  folder.write("wrong.scene.json", R"({"meshes":[],"instances":[{"mesh":"none"}]})");
  const auto catalogue = loaded(folder);

  EXPECT_EQ(catalogue->find("good")->state, SceneState::Ready);
  EXPECT_EQ(catalogue->find("stale")->state, SceneState::Stale);
  EXPECT_EQ(catalogue->find("cut")->state, SceneState::Damaged);
  EXPECT_EQ(catalogue->find("flipped")->state, SceneState::Damaged);
  EXPECT_EQ(catalogue->find("broken")->state, SceneState::Failed);
  EXPECT_EQ(catalogue->find("broken")->fault, ErrorKind::Malformed);
  EXPECT_EQ(catalogue->find("wrong")->state, SceneState::Failed);
  for (const auto& entry : catalogue->list()) {
    if (entry->state == SceneState::Ready) continue;
    EXPECT_EQ(entry->scene, nullptr) << entry->name;
    EXPECT_FALSE(entry->error.empty()) << entry->name;
    EXPECT_EQ(entry->error.find(folder.path().string()), std::string::npos) << entry->error;
  }
}

TEST(Catalogue, LoadsAgainWhatHasChanged) {
  const SceneFolder folder;
  folder.addCube("cube.obj");
  folder.write("both.scene.json", kScene);
  const auto catalogue = loaded(folder, 20);
  const auto before = catalogue->find("cube"), scene = catalogue->find("both");
  ASSERT_TRUE(before->scene && scene->scene) << scene->error;

  folder.addCube("cube.obj", 0.2);
  waitUntil([&] {
    const auto now = catalogue->find("cube"), now2 = catalogue->find("both");
    return now->state == SceneState::Ready && now->scene->id != before->scene->id &&
           now2->state == SceneState::Ready && now2->scene->id != scene->scene->id;
  });
  EXPECT_EQ(catalogue->find(before->scene->id.hex()), nullptr) << "the old id has no files any more";

  fs::remove(folder.path() / "cube.obj.chamfer");
  folder.addCube("new.obj");
  waitUntil([&] {
    const auto entry = catalogue->find("new");
    return !catalogue->find("cube") && entry && entry->state == SceneState::Ready;
  });
}

TEST(Catalogue, TriesABrokenSceneAgainWhenAnyFileIsMended) {
  const SceneFolder folder;
  folder.write("both.scene.json", kScene); // its mesh is missing
  const auto catalogue = loaded(folder, 20);
  EXPECT_EQ(catalogue->find("both")->state, SceneState::Failed);
  folder.addCube("cube.obj");
  waitUntil([&] { return catalogue->find("both")->state == SceneState::Ready; });
}

TEST(CatalogueUpAxis, TurnsBareMeshesUpright) {
  const test::SceneFolder folder;
  folder.write("post.obj", "v 0 0 0\nv 1 0 0\nv 0 5 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  folder.round("post.obj", 0.05);
  Catalogue catalogue(folder.path(), std::chrono::milliseconds(0), SIZE_MAX, UpAxis::Y);
  catalogue.start();
  for (int i = 0; i < 1000 && !catalogue.loaded(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const auto post = catalogue.find("post");
  ASSERT_TRUE(post && post->scene);
  EXPECT_EQ(post->scene->bounds.lower, Point3(0, -2, 0));
  EXPECT_EQ(post->scene->bounds.upper, Point3(1, 0, 5));
  // With its other axis up it goes by its id, the same on every node, and is not listed.
  const auto other = catalogue.find(post->scene->otherUpId.hex());
  ASSERT_TRUE(other && other->scene);
  EXPECT_EQ(other->name, "post");
  EXPECT_EQ(other->scene->bounds.upper, Point3(1, 5, 2));
  EXPECT_EQ(other->scene->id, loadScene(folder.path() / "post.obj", folder.path(), "post")->id);
  EXPECT_EQ(catalogue.list().size(), 1u);
}

} // namespace
} // namespace chamfer::http
