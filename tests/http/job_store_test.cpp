// The folder of jobs: where it may lie, what is kept.
#include "server/http/comparisons/job_store.h"

#include "server/http/comparisons/job_lock.h"
#include "tests/support/temporary_folder.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>

namespace chamfer::http {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

std::string idOf(int number) {
  const std::string digits = std::to_string(number);
  return std::string(32 - digits.size(), '0') + digits;
}

class JobStoreTest : public testing::Test {
protected:
  JobStore store(JobOptions options = {}) const {
    options.folder = base_.path() / "jobs";
    return {options, root_};
  }
  /// An ended job so many seconds old.
  void addEnded(const JobStore& store, int number, int age, std::size_t bytes = 10) const {
    store.add(idOf(number), "{}");
    store.write(idOf(number), "report.html", std::string(bytes, 'x'));
    store.write(idOf(number), "state.json", R"({"state":"done"})");
    const std::time_t now = std::time(nullptr);
    const timespec times[] = {{now - age, 0}, {now - age, 0}};
    ::utimensat(AT_FDCWD, store.path(idOf(number), "state.json").c_str(), times, 0);
  }

  test::TemporaryFolder base_;
  fs::path root_ = [this] {
    fs::create_directories(base_.path() / "root/sub");
    return fs::canonical(base_.path() / "root");
  }();
};

TEST_F(JobStoreTest, MustNotLieWithinTheServedFolderNorItWithin) {
  fs::create_directory_symlink(root_ / "sub", base_.path() / "link");
  base_.write("file", "");
  for (const fs::path& folder :
       {root_, root_ / "sub", root_ / "new/deeper", base_.path(), fs::path("/"), base_.path() / "link",
        base_.path() / "link/new", base_.path() / "x/../root/sub/new"})
    EXPECT_THAT(test::thrownBy([&] { JobStore({.folder = folder}, root_); }), StartsWith("usage: "))
        << folder;
  EXPECT_FALSE(fs::exists(root_ / "new")) << "nothing is made before it is refused";
  EXPECT_FALSE(fs::exists(root_ / "sub/new"));
  EXPECT_THAT(test::thrownBy([&] { JobStore({.folder = base_.path() / "file"}, root_); }),
              StartsWith("cannot-write: "));
  EXPECT_EQ(test::thrownBy([&] { JobStore({.folder = base_.path() / "root-like/a/b"}, root_); }), "nothing");
}

TEST_F(JobStoreTest, SeedsOfEndedJobsGo) {
  const JobStore jobs = store();
  addEnded(jobs, 1, 50);
  base_.write("jobs/" + idOf(1) + "/seeds/x.exr", "");
  jobs.add(idOf(2), "{}");
  base_.write("jobs/" + idOf(2) + "/seeds/x.exr", "");
  jobs.tidy();
  EXPECT_FALSE(fs::exists(jobs.path(idOf(1), "seeds")));
  EXPECT_TRUE(fs::exists(jobs.path(idOf(2), "seeds/x.exr")));
}

TEST_F(JobStoreTest, OldJobsGo) {
  const JobStore jobs = store({.age = std::chrono::seconds(100)});
  addEnded(jobs, 1, 50);
  addEnded(jobs, 2, 150);
  jobs.add(idOf(3), "{}"); // not ended, however old
  jobs.tidy();
  EXPECT_THAT(jobs.ids(), testing::UnorderedElementsAre(idOf(1), idOf(3)));
}

TEST_F(JobStoreTest, TheOldestGoWhereRoomIsShort) {
  const JobStore jobs = store({.bytes = 25'000});
  addEnded(jobs, 1, 30, 10'000);
  addEnded(jobs, 2, 50, 10'000);
  addEnded(jobs, 3, 40, 10'000);
  jobs.tidy();
  EXPECT_THAT(jobs.ids(), testing::UnorderedElementsAre(idOf(1), idOf(3)));
}

TEST_F(JobStoreTest, WhatIsWorkedOnStays) {
  const JobStore jobs = store({.bytes = 1, .age = std::chrono::seconds(0)});
  addEnded(jobs, 1, 50);
  const auto lock = JobLock::tryTake(jobs.path(idOf(1), "lock"));
  ASSERT_TRUE(lock);
  EXPECT_TRUE(jobs.running(idOf(1)));
  EXPECT_FALSE(JobLock::tryTake(jobs.path(idOf(1), "lock"))) << "one at a time, in this process, too";
  jobs.tidy();
  EXPECT_TRUE(jobs.has(idOf(1)));
}

TEST_F(JobStoreTest, LocksEndWithTheirHolder) {
  const JobStore jobs = store();
  jobs.add(idOf(1), "{}");
  { const auto lock = JobLock::tryTake(jobs.path(idOf(1), "lock")); }
  EXPECT_FALSE(jobs.running(idOf(1)));
  EXPECT_TRUE(JobLock::tryTake(jobs.path(idOf(1), "lock")));
  EXPECT_FALSE(JobLock::tryTake(jobs.path(idOf(2), "lock"))) << "there is no such job";
}

TEST_F(JobStoreTest, AddingTwiceChangesNothing) {
  const JobStore jobs = store();
  jobs.add(idOf(1), "first");
  jobs.add(idOf(1), "second");
  EXPECT_EQ(*jobs.read(idOf(1), "request.json"), "first");
  EXPECT_EQ(jobs.ids().size(), 1u);
  // What a removed job's work left behind is in nobody's way.
  base_.write("jobs/" + idOf(2) + "/seeds/x.exr", "");
  EXPECT_FALSE(jobs.has(idOf(2)));
  jobs.add(idOf(2), "second");
  EXPECT_EQ(*jobs.read(idOf(2), "request.json"), "second");
  EXPECT_THAT(jobs.ids(), testing::ElementsAre(idOf(1), idOf(2))) << "in the order of their coming";
}

TEST_F(JobStoreTest, AnEndedJobBeginsAgainWithoutItsResults) {
  const JobStore jobs = store();
  addEnded(jobs, 1, 10);
  EXPECT_TRUE(jobs.unfinished().empty());
  jobs.restart(idOf(1), "again");
  EXPECT_THAT(jobs.unfinished(), testing::ElementsAre(idOf(1)));
  EXPECT_FALSE(jobs.read(idOf(1), "report.html"));
}

} // namespace
} // namespace chamfer::http
