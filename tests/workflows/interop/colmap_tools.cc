#include "tests/workflows/interop/colmap_tools.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include <SQLiteCpp/SQLiteCpp.h>

#include "importer/database/correspondence.h"
#include "reconstruct/colmap/colmap_runner.h"

namespace velamap {
namespace {

template <typename T>
std::vector<T> Values(const SQLite::Column& blob) {
  std::vector<T> values(static_cast<std::size_t>(blob.getBytes()) / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), blob.getBlob(), values.size() * sizeof(T));
  return values;
}

}  // namespace

void ColmapTest::SetUp() {
  if (std::system("command -v colmap > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "colmap is not on the PATH";
  }
}

std::string ColmapTest::RunCommand(const std::vector<std::string>& arguments) const {
  return RunColmap("colmap", arguments, path("colmap.log"));
}

void ColmapTest::AddOption(const std::vector<std::string>& names, const std::string& value,
                           std::vector<std::string>* arguments) {
  for (const std::string& name : names) {
    if (!ColmapHasOption("colmap", arguments->front(), name)) continue;
    arguments->insert(arguments->end(), {"--" + name, value});
    return;
  }
}

void WriteSceneDatabase(const SyntheticScene& scene, const std::string& database_path) {
  ColmapDatabase database(database_path, ColmapDatabase::Mode::kReadWriteCreate);
  ColmapDatabase::Transaction transaction(&database);
  const CameraId camera_id = database.AddCamera(scene.camera);
  std::vector<ImageId> image_ids;
  for (const FrameDetections& frame : scene.frames) {
    image_ids.push_back(database.AddImage(camera_id, frame, "test"));
  }
  for (const auto& [i, j] : PairsToMatch(scene.frames)) {
    const std::size_t first = static_cast<std::size_t>(i), second = static_cast<std::size_t>(j);
    const FeatureMatches matches = MatchByMarkerId(scene.frames[first], scene.frames[second]);
    database.WriteMatches(image_ids[first], image_ids[second], matches);
  }
  transaction.Commit();
}

void ExecuteSql(const std::string& database_path, const std::string& statement) {
  SQLite::Database(database_path, SQLite::OPEN_READWRITE).exec(statement);
}

std::vector<Eigen::Vector2d> QueryKeypoints(const std::string& database_path,
                                            const std::string& image_name) {
  SQLite::Database database(database_path, SQLite::OPEN_READWRITE);
  SQLite::Statement query(
      database, "SELECT cols, data FROM keypoints JOIN images USING(image_id) WHERE name = ?");
  query.bind(1, image_name);
  if (!query.executeStep()) throw std::runtime_error("no keypoints of " + image_name);
  const std::size_t num_columns = query.getColumn(0).getUInt();
  const std::vector<float> values = Values<float>(query.getColumn(1));
  std::vector<Eigen::Vector2d> keypoints;
  for (std::size_t i = 0; i < values.size(); i += num_columns) {
    keypoints.emplace_back(values[i], values[i + 1]);
  }
  return keypoints;
}

std::vector<double> QueryCameraParams(const std::string& database_path) {
  SQLite::Database database(database_path, SQLite::OPEN_READWRITE);
  SQLite::Statement query(database, "SELECT params FROM cameras ORDER BY camera_id");
  if (!query.executeStep()) throw std::runtime_error("no camera in " + database_path);
  return Values<double>(query.getColumn(0));
}

MatchSet QueryMatches(const std::string& database_path, const std::string& table, ImageId image_id1,
                      ImageId image_id2) {
  constexpr std::int64_t kMaxNumImages = 2147483647;
  const auto [first, second] = std::minmax(image_id1, image_id2);
  SQLite::Database database(database_path, SQLite::OPEN_READWRITE);
  SQLite::Statement query(database, "SELECT data FROM " + table + " WHERE pair_id = ?");
  query.bind(1, kMaxNumImages * first + second);
  MatchSet matches;
  if (!query.executeStep()) return matches;
  const std::vector<std::uint32_t> values = Values<std::uint32_t>(query.getColumn(0));
  for (std::size_t i = 0; i < values.size(); i += 2) matches.emplace(values[i], values[i + 1]);
  return matches;
}

}  // namespace velamap
