#include "reconstruct/model/model_io.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>

#include "importer/base/error.h"
#include "tests/reconstruct/sheet_model.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

// Two cameras, odd digits, unused 2D points, an image without any, names with spaces, an order of
// images that is none of theirs.
Model AwkwardModel() {
  SheetOptions options;
  options.num_rows = 1;
  options.num_columns = 2;
  options.num_images = 4;
  Model model = MakeSheetModel(options);
  AddImageNoise(1.0 / 3.0, 5, &model);
  PerturbSeed(0.01, 5, &model);
  model.cameras[4294967295u] = {CameraModel::kFullOpenCV,
                                4000,
                                3000,
                                {1e3 / 3, 7e2, 1.1, 2.2, 1e-17, -1e-300, 0, -0.0, 5, 6, 7, 8}};
  model.images[2].camera_id = 4294967295u;
  RemoveObservation(&model, 12, {3, 1});
  ModelImage bare = model.images[0];
  bare.image_id = 77;
  bare.name = "folder name/bare image.jpg";
  bare.points2D.clear();
  model.images.insert(model.images.begin() + 1, bare);
  model.points3D[10000000000013u].x_in_world = {1e-9, 1e9, -1.0 / 3.0};
  model.points3D.at(12).mean_error_px = 0.1;
  std::swap(model.images[0], model.images[3]);
  CheckModel(model);
  return model;
}

std::string ReadBytes(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void WriteBytes(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

std::string ErrorOf(const fs::path& path) {
  try {
    ReadModel(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

class ModelIoTest : public testing::TestWithParam<ModelFormat> {
 protected:
  TempDir dir_;
};

TEST_P(ModelIoTest, RoundTripIsExactAndKeepsTheOrderOfImages) {
  const Model model = AwkwardModel();
  WriteModel(model, dir_ / "0", GetParam());
  EXPECT_EQ(Bytes(ReadModel(dir_ / "0")), Bytes(model));
}

TEST_P(ModelIoTest, SameModelSameBytesWhateverTheOrderInTheTracks) {
  Model model = AwkwardModel();
  WriteModel(model, dir_ / "a", GetParam());
  for (auto& [point3D_id, point] : model.points3D) {
    std::reverse(point.track.begin(), point.track.end());
  }
  WriteModel(model, dir_ / "b", GetParam());
  int num_files = 0;
  for (const auto& entry : fs::directory_iterator(dir_ / "a")) {
    EXPECT_EQ(ReadBytes(entry.path()), ReadBytes((dir_ / "b") / entry.path().filename()));
    ++num_files;
  }
  // The record of what velamap wrote is one more.
  EXPECT_EQ(num_files, GetParam() == ModelFormat::kBinaryAndText ? 7 : 4);
}

TEST_P(ModelIoTest, ReplacesAnOldModelAndLeavesNothingBeside) {
  WriteModel(MakeSheetModel(), dir_ / "0", ModelFormat::kBinaryAndText);
  const Model model = AwkwardModel();
  WriteModel(model, dir_ / "0", GetParam());
  EXPECT_EQ(Bytes(ReadModel(dir_ / "0")), Bytes(model));
  EXPECT_EQ(std::distance(fs::directory_iterator(dir_.path()), {}), 1);
}

INSTANTIATE_TEST_SUITE_P(Formats, ModelIoTest,
                         testing::Values(ModelFormat::kBinary, ModelFormat::kText,
                                         ModelFormat::kBinaryAndText));

class ModelFiles : public testing::Test {
 protected:
  void Write(ModelFormat format) { WriteModel(AwkwardModel(), path_, format); }

  // The error after `line` (from 1) of a text file has been replaced.
  std::string ErrorWithLine(const std::string& file, int line, const std::string& text) {
    fs::remove_all(path_);
    Write(ModelFormat::kText);
    std::istringstream lines(ReadBytes(path_ / file));
    std::string changed, old;
    for (int i = 1; std::getline(lines, old); ++i) changed += (i == line ? text : old) + "\n";
    WriteBytes(path_ / file, changed);
    return ErrorOf(path_);
  }

  TempDir dir_;
  fs::path path_ = dir_ / "0";
};

TEST_F(ModelFiles, EveryTruncationOfABinaryFileIsAnErrorThatNamesIt) {
  Write(ModelFormat::kBinary);
  for (const std::string file : {"cameras.bin", "images.bin", "points3D.bin"}) {
    const std::string bytes = ReadBytes(path_ / file);
    for (std::size_t size = 0; size < bytes.size(); size += 7) {
      WriteBytes(path_ / file, bytes.substr(0, size));
      ASSERT_THAT(ErrorOf(path_), AllOf(HasSubstr(file), HasSubstr("truncated"))) << size;
    }
    WriteBytes(path_ / file, bytes + '\0');
    EXPECT_THAT(ErrorOf(path_), AllOf(HasSubstr(file), HasSubstr("continues after the last")));
    WriteBytes(path_ / file, bytes);
  }
  EXPECT_EQ(ErrorOf(path_), "no error");
}

TEST_F(ModelFiles, EveryLostLineOfATextFileIsAnError) {
  Write(ModelFormat::kText);
  for (const std::string file : {"cameras.txt", "images.txt", "points3D.txt"}) {
    const std::string text = ReadBytes(path_ / file);
    for (std::size_t end = text.find('\n'); end + 1 < text.size(); end = text.find('\n', end + 1)) {
      WriteBytes(path_ / file, text.substr(0, end + 1));
      // Only the point without a track can go unnoticed.
      if (text.substr(end + 1).rfind("10000000000013", 0) == 0) continue;
      EXPECT_THAT(ErrorOf(path_), HasSubstr(path_.string())) << file << " cut at " << end;
    }
    WriteBytes(path_ / file, text);
  }
}

TEST_F(ModelFiles, FaultyLinesAreNamed) {
  EXPECT_THAT(ErrorWithLine("cameras.txt", 2, "1 PINHOLE 640 480 500 500 320"),
              HasSubstr("cameras.txt:2: expected PARAMS[], but the line ends"));
  EXPECT_THAT(ErrorWithLine("cameras.txt", 2, "1 PINHOLE 640 480 500 500 320 240 1"),
              HasSubstr("cameras.txt:2: expected the end of the line, found '1'"));
  EXPECT_THAT(ErrorWithLine("cameras.txt", 2, "1 FOV 640 480 500 500 320 240 1"),
              HasSubstr("cameras.txt:2: camera 1 has the camera model FOV; velamap reads"));
  EXPECT_THAT(ErrorWithLine("cameras.txt", 2, "4294967295 PINHOLE 640 480 500 500 320 240"),
              HasSubstr("cameras.txt:3: there are two cameras with the id 4294967295"));
  EXPECT_THAT(ErrorWithLine("images.txt", 3, "1 1 0 0 0 zero 0 0 1 name"),
              HasSubstr("images.txt:3: expected TX as a number, found 'zero'"));
  EXPECT_THAT(ErrorWithLine("images.txt", 3, "1 0 0 0 0 0 0 0 1 name"),
              HasSubstr("images.txt:3: image 1 has no valid rotation"));
  EXPECT_THAT(ErrorWithLine("images.txt", 4, "1.5 2.5"),
              HasSubstr("images.txt:4: expected POINT3D_ID, but the line ends"));
  EXPECT_THAT(ErrorWithLine("images.txt", 4, "1.5 2.5 -2"),
              HasSubstr("images.txt:4: expected POINT3D_ID from 0, or -1 for none, found -2"));
  EXPECT_THAT(ErrorWithLine("points3D.txt", 2, "11 1 2 3 256 0 0 0.1"),
              HasSubstr("points3D.txt:2: expected R G B as a whole number from 0, found '256'"));
  EXPECT_THAT(ErrorWithLine("points3D.txt", 2, "11 1 2 3 0 0 0 0.1 5"),
              HasSubstr("points3D.txt:2: expected POINT2D_IDX, but the line ends"));
  EXPECT_THAT(ErrorWithLine("points3D.txt", 2, "12 1 2 3 0 0 0 0.1"),
              HasSubstr("points3D.txt:3: there are two points with the id 12"));
}

TEST_F(ModelFiles, FilesThatDoNotFitTogetherAreAnError) {
  EXPECT_THAT(ErrorWithLine("points3D.txt", 2, "11 1 2 3 0 0 0 0.1 1 0"),
              AllOf(HasSubstr(path_.string()), HasSubstr("do not fit together: point 11 is")));
  EXPECT_THAT(ErrorWithLine("points3D.txt", 2, "11 nan 2 3 0 0 0 0.1 1 0"),
              HasSubstr("point 11 is not finite"));
}

TEST_F(ModelFiles, BinaryWins) {
  WriteModel(MakeSheetModel(), path_, ModelFormat::kBinaryAndText);
  for (const char* file : {"cameras.txt", "images.txt", "points3D.txt"}) {
    WriteBytes(path_ / file, "garbage");
  }
  EXPECT_EQ(Bytes(ReadModel(path_)), Bytes(MakeSheetModel()));
}

TEST_F(ModelFiles, MissingFilesAreNamed) {
  EXPECT_THAT(ErrorOf(path_), AllOf(HasSubstr(path_.string()), HasSubstr("no such folder")));
  fs::create_directories(path_);
  EXPECT_THAT(ErrorOf(path_), HasSubstr("holds no COLMAP model"));
  EXPECT_THAT(ErrorOf(dir_.path()), HasSubstr("did you mean its folder 0?"));
  Write(ModelFormat::kBinary);
  fs::remove(path_ / "images.bin");
  EXPECT_THAT(ErrorOf(path_), HasSubstr("images.bin: missing"));
}

TEST_F(ModelFiles, UnwritablePathIsAnErrorThatNamesIt) {
  WriteBytes(dir_ / "file", "");
  ExpectThrows<InputError>(
      [&] { WriteModel(AwkwardModel(), (dir_ / "file") / "0", ModelFormat::kBinary); },
      {(dir_ / "file").string()});
}

TEST_F(ModelFiles, FailedWriteLeavesTheOldModel) {
  Write(ModelFormat::kText);
  Model model = AwkwardModel();
  model.images[1].name = "two\nlines";
  EXPECT_THROW(WriteModel(model, path_, ModelFormat::kText), InputError);
  EXPECT_EQ(Bytes(ReadModel(path_)), Bytes(AwkwardModel()));
  EXPECT_EQ(std::distance(fs::directory_iterator(dir_.path()), {}), 1);
}

// Hand-written as other programs do: comments, CRLF, few digits, no order.
TEST(ModelText, ReadsForeignText) {
  Model model;
  std::istringstream cameras("# a comment\r\n\r\n2 SIMPLE_RADIAL 640 480 500 320 240 -0.1\r\n");
  ReadCamerasText(cameras, "cameras.txt", &model);
  std::istringstream images(
      "# a comment\n"
      "3 0.7071 0.7071 0 0 1 2 3 2 b.jpg\n"
      "1 2 -1 3 4 5 6 7.25 5\n"
      "1 1 0 0 0 0 0 0 2 a.jpg\n"
      "\n");
  ReadImagesText(images, "images.txt", &model);
  std::istringstream points("5 1e0 -2 .5 1 2 3 0.25 3 1 3 2");
  ReadPoints3DText(points, "points3D.txt", &model);

  EXPECT_EQ(FindModelFault(model), "");
  ASSERT_EQ(model.images.size(), 2u);
  EXPECT_EQ(model.images[0].image_id, 3u);
  EXPECT_DOUBLE_EQ(model.images[0].cam_from_world.rotation.norm(), 1.0);
  EXPECT_DOUBLE_EQ(model.images[0].cam_from_world.rotation.x(), std::sqrt(0.5));
  ASSERT_EQ(model.images[0].points2D.size(), 3u);
  EXPECT_EQ(model.images[0].points2D[0].point3D_id, kInvalidPoint3DId);
  EXPECT_EQ(model.images[0].points2D[2].point3D_id, 5u);
  EXPECT_EQ(model.images[0].points2D[2].x_in_image_px, Eigen::Vector2d(6, 7.25));
  EXPECT_TRUE(model.images[1].points2D.empty());
  EXPECT_EQ(model.cameras.at(2).params.back(), -0.1);
  EXPECT_EQ(model.points3D.at(5).x_in_world, Eigen::Vector3d(1, -2, 0.5));
  EXPECT_EQ(model.points3D.at(5).track.size(), 2u);
}

}  // namespace
}  // namespace velamap
