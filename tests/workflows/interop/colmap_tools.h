// What the tests of COLMAP's commands share: running them, and looking into a database by plain
// SQL, past the code that wrote it.

#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>

#include "importer/database/colmap_database.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/temp_dir.h"

namespace velamap {

// A temporary folder in which the installed COLMAP runs; skips the test where there is none.
class ColmapTest : public ::testing::Test {
 protected:
  void SetUp() override;

  // Its output; fails the test by an exception if it fails.
  std::string RunCommand(const std::vector<std::string>& arguments) const;

  // Adds "--option value" for the first of `names` that the command knows: names differ between
  // versions. Without any of them, nothing: then the command has no need of it.
  static void AddOption(const std::vector<std::string>& names, const std::string& value,
                        std::vector<std::string>* arguments);

  std::string path(const std::string& name) const { return (dir_ / name).string(); }

  TempDir dir_;
};

// A database as marker_importer writes it: cameras, images, keypoints, matches of all pairs.
void WriteSceneDatabase(const SyntheticScene& scene, const std::string& database_path);

void ExecuteSql(const std::string& database_path, const std::string& statement);

// x, y of all keypoints of an image (px, COLMAP's image frame).
std::vector<Eigen::Vector2d> QueryKeypoints(const std::string& database_path,
                                            const std::string& image_name);

// Parameters of the first camera.
std::vector<double> QueryCameraParams(const std::string& database_path);

using MatchSet = std::set<std::pair<std::uint32_t, std::uint32_t>>;

// Of `matches` or `two_view_geometries`, as (keypoint_idx in the image with the smaller id,
// keypoint_idx in the other); empty where there is no row.
MatchSet QueryMatches(const std::string& database_path, const std::string& table, ImageId image_id1,
                      ImageId image_id2);

}  // namespace velamap
