// Mesh files for tests: written to a folder of their own that goes with the fixture.
#pragma once

#include "common/error.h"
#include "preprocess/mesh.h"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

namespace chamfer {

class MeshFiles : public testing::Test {
protected:
  MeshFiles() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("chamfer_" + std::to_string(getpid()) + "_" + test->test_suite_name() + "_" + test->name());
    std::filesystem::create_directories(folder_);
  }
  ~MeshFiles() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& content) const {
    const auto path = folder_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }
  TriangleMesh read(const std::string& name, const std::string& content) const {
    return readMesh(write(name, content));
  }
  /// The message of the Error(Malformed) that reading must throw; empty (and a failure) when it does not.
  std::string malformed(const std::string& name, const std::string& content) const {
    try {
      read(name, content);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::Malformed) << error.what();
      return error.what();
    }
    ADD_FAILURE() << name << " was read";
    return {};
  }

  std::filesystem::path folder_;
};

} // namespace chamfer
