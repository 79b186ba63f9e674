#include "common/atomic_file.h"
#include "common/error.h"

#include <fstream>
#include <gmock/gmock.h>
#include <iterator>
#include <sys/stat.h>

namespace chamfer {
namespace {

namespace fs = std::filesystem;

std::span<const std::byte> bytes(std::string_view text) { return std::as_bytes(std::span(text)); }

std::string contentOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class AtomicFiles : public ::testing::Test {
protected:
  AtomicFiles() {
    char name[] = "/tmp/chamfer-atomic-XXXXXX";
    folder_ = ::mkdtemp(name);
  }
  ~AtomicFiles() override { fs::remove_all(folder_); }
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(folder_), {}); }

  fs::path folder_;
};

TEST_F(AtomicFiles, TakeTheirNameWhenCommitted) {
  const fs::path target = folder_ / "a.obj";
  writeAtomically(target, bytes("old"));
  {
    AtomicFile file(target);
    file.write(bytes("new "));
    file.write(bytes("content"));
    EXPECT_EQ(file.temporary().extension(), ".obj");
    EXPECT_EQ(file.temporary().parent_path(), folder_);
    EXPECT_EQ(contentOf(target), "old");
    EXPECT_EQ(files(), 2);
    file.commit();
    EXPECT_EQ(contentOf(target), "new content");
  }
  EXPECT_EQ(contentOf(target), "new content");
  EXPECT_EQ(files(), 1);
}

TEST_F(AtomicFiles, LeaveNothingWhenTheyAreNot) {
  const fs::path target = folder_ / "a";
  writeAtomically(target, bytes("old"));
  {
    AtomicFile file(target);
    file.write(bytes("new"));
    EXPECT_EQ(files(), 2);
  }
  EXPECT_EQ(contentOf(target), "old");
  EXPECT_EQ(files(), 1);
}

TEST_F(AtomicFiles, AreWrittenByNameToo) {
  AtomicFile file(folder_ / "a.txt");
  std::ofstream(file.temporary()) << "by name";
  file.commit();
  EXPECT_EQ(contentOf(folder_ / "a.txt"), "by name");
}

TEST_F(AtomicFiles, HaveThePermissionsOfNewFiles) {
  const mode_t mask = ::umask(027);
  writeAtomically(folder_ / "a", {});
  ::umask(mask);
  struct stat status {};
  ASSERT_EQ(::stat((folder_ / "a").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777u, 0640u);
}

TEST_F(AtomicFiles, SayWhatCannotBeWrittenAndWhy) {
  fs::create_directory(folder_ / "folder");
  const auto thrown = [](const fs::path& target) -> std::string {
    try {
      writeAtomically(target, bytes("content"));
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::CannotWrite);
      return e.what();
    }
    return "nothing";
  };
  const fs::path nowhere = folder_ / "none" / "a";
  EXPECT_EQ(thrown(nowhere), "cannot write " + nowhere.string() + ": No such file or directory");
  EXPECT_EQ(thrown(folder_ / "folder"), "cannot write " + (folder_ / "folder").string() + ": Is a directory");
  EXPECT_EQ(files(), 1) << "nothing is left beside it";
}

} // namespace
} // namespace chamfer
