#include "workflows/run/workspace.h"

#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "importer/base/replacement.h"
#include "importer/database/colmap_database.h"
#include "importer/video/written_frame.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
namespace fs = std::filesystem;

std::string ErrorOf(const fs::path& path, const fs::path& image_path) {
  try {
    const Workspace workspace(path.string(), image_path.string());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

Model ModelWithImages(const std::vector<std::string>& names) {
  Model model;
  for (const std::string& name : names) {
    ModelImage image;
    image.name = name;
    model.images.push_back(image);
  }
  return model;
}

TEST(WorkspaceTest, ANewOneThatIsNotKeptLeavesNothing) {
  const TempDir temp_dir;
  {
    const Workspace workspace((temp_dir / "a/b/workspace").string(), "photos");
    ASSERT_TRUE(fs::is_directory(temp_dir / "a/b/workspace"));
    WriteTextFile(workspace.paths().Log(), "log");
  }
  EXPECT_THAT(ListFolder(temp_dir.path()), IsEmpty());
}

TEST(WorkspaceTest, KeptOrOldOnesStay) {
  const TempDir temp_dir;
  {
    Workspace workspace((temp_dir / "workspace").string(), "photos");
    WriteTextFile(workspace.paths().Log(), "log");
    workspace.Keep();
  }
  { const Workspace workspace((temp_dir / "workspace").string(), "photos"); }
  EXPECT_THAT(ListFolder(temp_dir / "workspace"), ElementsAre("velamap.log"));
}

TEST(WorkspaceTest, RefusesWhatIsNoWorkspace) {
  const TempDir temp_dir;
  fs::create_directory(temp_dir / "home");
  WriteTextFile(temp_dir / "home/thesis.tex", "text");
  EXPECT_THAT(ErrorOf(temp_dir / "home", "photos"), HasSubstr("holds thesis.tex"));
  EXPECT_THAT(ErrorOf(temp_dir / "home/thesis.tex", "photos"), HasSubstr("is a file"));
  EXPECT_NE(ErrorOf(temp_dir / "home/thesis.tex/below", "photos"), "");
  EXPECT_THAT(ListFolder(temp_dir / "home"), ElementsAre("thesis.tex"));
}

TEST(WorkspaceTest, TellsOurDatabaseFromOthers) {
  const TempDir temp_dir;
  fs::create_directory(temp_dir / "ours");
  const std::string path = (temp_dir / "ours/database.db").string();
  { ColmapDatabase database(path, ColmapDatabase::Mode::kReadWriteCreate); }
  EXPECT_THAT(ErrorOf(temp_dir / "ours", "photos"), HasSubstr("holds database.db"));
  {
    ColmapDatabase database(path, ColmapDatabase::Mode::kReadWriteCreate);
    FrameDetections detections;
    detections.image_name = "a.jpg";
    MarkerDetection marker;
    marker.marker_id = 1;
    marker.corners_in_image_px.fill(Eigen::Vector2d(10.0, 10.0));
    detections.markers.push_back(marker);
    const CameraId camera_id =
        database.AddCamera({CameraModel::kPinhole, 640, 480, {500, 500, 320, 240}});
    database.AddImage(camera_id, detections, "test");
  }
  EXPECT_EQ(ErrorOf(temp_dir / "ours", "photos"), "");
}

TEST(WorkspaceTest, PhotographsMayLieInIt) {
  const TempDir temp_dir;
  fs::create_directories(temp_dir / "workspace/images");
  EXPECT_EQ(ErrorOf(temp_dir / "workspace", temp_dir / "workspace/images"), "");
  EXPECT_NE(ErrorOf(temp_dir / "workspace", temp_dir / "photos"), "");
}

TEST(WorkspaceTest, MustNotLieAmongThePhotographs) {
  const TempDir temp_dir;
  fs::create_directories(temp_dir / "photos");
  EXPECT_THAT(ErrorOf(temp_dir / "photos/result", temp_dir / "photos"),
              HasSubstr("lies in the image folder"));
  EXPECT_FALSE(fs::exists(temp_dir / "photos/result"));
}

TEST(WorkspaceTest, ClearsAwayWhatAnInterruptedRunLeft) {
  const TempDir temp_dir;
  fs::create_directory(temp_dir / "workspace");
  const pid_t killed = fork();
  if (killed == 0) {
    fs::create_directories(TemporarySibling(temp_dir / "workspace/sparse") / "seed");
    _exit(0);
  }
  waitpid(killed, nullptr, 0);
  EXPECT_EQ(ListFolder(temp_dir / "workspace").size(), 1u);
  WriteTextFile(temp_dir / "workspace/velamap.log", "log");
  EXPECT_EQ(ErrorOf(temp_dir / "workspace", "photos"), "");
  EXPECT_THAT(ListFolder(temp_dir / "workspace"), ElementsAre("velamap.log"));
}

TEST(WorkspaceTest, IsForOneAtATime) {
  const TempDir temp_dir;
  {
    const Workspace workspace((temp_dir / "workspace").string(), "photos");
    EXPECT_THAT(ErrorOf(temp_dir / "workspace", "photos"),
                HasSubstr("another velamap process is using it (since"));
    EXPECT_TRUE(fs::exists(temp_dir / "workspace"));
  }
  EXPECT_EQ(ErrorOf(temp_dir / "workspace", "photos"), "");
}

TEST(ModelImagesTest, AreCopiedWithTheirFolders) {
  const TempDir temp_dir;
  fs::create_directories(temp_dir / "photos/day1");
  WriteTextFile(temp_dir / "photos/day1/a.jpg", "picture");
  WriteTextFile(temp_dir / "photos/b.jpg", "other");
  const fs::path images = temp_dir / "workspace/images";
  fs::create_directories(images);
  fs::create_hard_link(temp_dir / "photos/b.jpg", images / "b.jpg");  // of an earlier velamap
  AddModelImages(ModelWithImages({"day1/a.jpg", "b.jpg"}), (temp_dir / "photos").string(), images);
  for (const char* name : {"day1/a.jpg", "b.jpg"}) {
    EXPECT_EQ(ReadFileBytes(images / name), ReadFileBytes(temp_dir / "photos" / name));
    EXPECT_EQ(fs::hard_link_count(images / name), 1u);
  }
  EXPECT_THAT(ListFolder(images), ElementsAre("b.jpg", "day1"));
}

TEST(ModelImagesTest, OnlyWhatIsNotLostIsRemoved) {
  const TempDir temp_dir;
  const fs::path images = temp_dir / "images";
  fs::create_directories(images);
  fs::create_directories(temp_dir / "photos");
  const std::vector<std::string> names = {"edited.jpg", "left_out.jpg", "not_ours.jpg",
                                          "original_gone.jpg", "used.jpg"};
  for (const std::string& name : names) WriteTextFile(images / name, name);
  WriteTextFile(temp_dir / "photos/left_out.jpg", "left_out.jpg");
  WriteTextFile(temp_dir / "photos/edited.jpg", "original");
  RemoveOtherImages(ModelWithImages({"used.jpg"}),
                    {"edited.jpg", "left_out.jpg", "original_gone.jpg", "used.jpg"},
                    (temp_dir / "photos").string(), images);
  EXPECT_THAT(ListFolder(images),
              ElementsAre("edited.jpg", "not_ours.jpg", "original_gone.jpg", "used.jpg"));
  // Photographs that are read from images/ itself are the originals.
  RemoveOtherImages(ModelWithImages({}), {"used.jpg"}, images.string(), images);
  EXPECT_TRUE(fs::exists(images / "used.jpg"));
}

TEST(ModelImagesTest, OfAVideoOnlyFramesThatVelamapWroteAreRemoved) {
  const TempDir temp_dir;
  WriteTextFile(temp_dir / "clip.mp4", "video");
  fs::create_directories(temp_dir / "images");
  const std::string jpeg = "\xFF\xD8 picture";
  WriteTextFile(temp_dir / "images/ours.jpg", WithFrameMark(jpeg));
  WriteTextFile(temp_dir / "images/edited.jpg", WithFrameMark(jpeg) + " edited");
  WriteTextFile(temp_dir / "images/theirs.jpg", jpeg);
  RemoveOtherImages(ModelWithImages({}), {"edited.jpg", "ours.jpg", "theirs.jpg"},
                    (temp_dir / "clip.mp4").string(), temp_dir / "images");
  EXPECT_THAT(ListFolder(temp_dir / "images"), ElementsAre("edited.jpg", "theirs.jpg"));
}

}  // namespace
}  // namespace velamap
