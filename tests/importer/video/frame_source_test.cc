#include "importer/video/frame_source.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "importer/base/error.h"
#include "tests/importer/video/grey_clip.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

cv::Mat NoiseImage(int width, int height) {
  cv::Mat image(height, width, CV_8UC3);
  cv::RNG(1).fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

void CutFile(const fs::path& path, double fraction) {
  fs::resize_file(path, static_cast<std::uintmax_t>(fraction * fs::file_size(path)));
}

// Frame i is uniformly 10 * i bright.
void WriteVideo(const std::string& path, int num_frames) {
  cv::VideoWriter writer(path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25.0, {64, 48});
  ASSERT_TRUE(writer.isOpened());
  for (int i = 0; i < num_frames; ++i) writer << cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(10 * i));
}

std::vector<Frame> ReadAll(FrameSource* source) {
  std::vector<Frame> frames;
  while (std::optional<Frame> frame = source->Next()) frames.push_back(*frame);
  return frames;
}

std::vector<int> FrameNumbers(const std::vector<Frame>& frames) {
  std::vector<int> numbers;
  for (const Frame& frame : frames) numbers.push_back(frame.frame_number.value());
  return numbers;
}

// The pictures of a folder are read more than once in a run.
TEST(ImageFolder, WarnsOnceOfABrokenFile) {
  const TempDir dir;
  cv::imwrite(dir / "broken.jpg", NoiseImage(64, 48));
  CutFile(dir / "broken.jpg", 0.1);
  testing::internal::CaptureStdout();
  for (int i = 0; i < 3; ++i) {
    const auto source = OpenFrameSource(dir.path(), {});
    Frame frame = source->Next().value();
    std::string reason;
    source->Load(&frame, &reason);
  }
  const std::string log = testing::internal::GetCapturedStdout();
  const std::size_t first = log.find("broken.jpg: ");
  ASSERT_NE(first, std::string::npos) << log;
  EXPECT_EQ(log.find("broken.jpg: ", first + 1), std::string::npos) << log;
}

TEST(ImageFolder, ListsNestedImagesInNaturalOrder) {
  const TempDir dir;
  fs::create_directory(dir / "sub");
  fs::create_directory(dir / ".hidden");
  for (const char* name : {"10.png", "9.PNG", "sub/1.png", ".a.png", ".hidden/b.png"}) {
    std::vector<std::uint8_t> bytes;
    cv::imencode(".png", NoiseImage(8, 6), bytes);
    std::ofstream(dir / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  std::ofstream(dir / "notes.txt") << "no image";
  const auto source = OpenFrameSource(dir.path(), {});
  EXPECT_FALSE(source->IsVideo());
  EXPECT_EQ(source->NumFrames(), 3);
  std::vector<std::string> names;
  for (Frame& frame : ReadAll(source.get())) {
    names.push_back(frame.image_name);
    std::string reason;
    EXPECT_TRUE(frame.gray.empty());
    EXPECT_TRUE(source->Load(&frame, &reason));
    EXPECT_EQ(frame.gray.type(), CV_8UC1);
    EXPECT_EQ(ColorImage(frame).type(), CV_8UC3);
    EXPECT_FALSE(frame.frame_number);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"9.PNG", "10.png", "sub/1.png"}));
  EXPECT_EQ(OpenFrameSource(dir.path(), {}, {"10.png", "other"})->NumFrames(), 2);
}

TEST(ImageFolder, BrokenImageIsNotLoaded) {
  const TempDir dir;
  cv::imwrite(dir / "a.jpg", NoiseImage(80, 60));
  CutFile(dir / "a.jpg", 0.7);
  const auto source = OpenFrameSource(dir.path(), {});
  std::optional<Frame> frame = source->Next();
  ASSERT_TRUE(frame);
  std::string reason;
  EXPECT_FALSE(source->Load(&*frame, &reason));
  EXPECT_EQ(reason, "the file is cut off");
}

TEST(OpenFrameSource, NamesWhatIsWrong) {
  const TempDir dir;
  ExpectThrows<InputError>([&] { OpenFrameSource(dir / "none", {}); }, {"none", "there is no"});
  ExpectThrows<InputError>([&] { OpenFrameSource("", {}); }, {"--image_path"});
  ExpectThrows<InputError>([&] { OpenFrameSource(dir.path(), {}); }, {dir.path(), "no images"});
  std::ofstream(dir / "empty.mp4").close();
  ExpectThrows<InputError>([&] { OpenFrameSource(dir / "empty.mp4", {}); },
                           {"file is empty; copy it from the camera"});
  std::ofstream(dir / "text.mp4") << "no video at all";
  ExpectThrows<InputError>([&] { OpenFrameSource(dir / "text.mp4", {}); },
                           {dir / "text.mp4", "not a readable video"});
  cv::imwrite(dir / "a.png", NoiseImage(8, 6));
  ExpectThrows<InputError>([&] { OpenFrameSource(dir / "a.png", {}); }, {"a single image"});
  std::ofstream(dir / "a.mp4") << std::ifstream(dir / "a.png").rdbuf()
                               << "what follows the picture";
  ExpectThrows<InputError>([&] { OpenFrameSource(dir / "a.mp4", {}); },
                           {dir / "a.mp4", "a picture"});
}

TEST(OpenFrameSource, SaysWhatToDoWithAFolderOfAPhone) {
  const TempDir dir;
  std::ofstream(dir / "IMG_1.DNG") << "a picture";
  ExpectThrows<InputError>([&] { OpenFrameSource(dir.path(), {}); },
                           {"no images", "IMG_1.DNG", "JPEG", "without correction"});
  std::ofstream(dir / "clip.MOV") << "a video";
  ExpectThrows<InputError>([&] { OpenFrameSource(dir.path(), {}); },
                           {"IMG_1.DNG", "give the file itself: " + (dir / "clip.MOV").string()});
}

// Root may read everything, so the test takes the rights of another user for a while.
TEST(OpenFrameSource, NamesAMissingPermission) {
  const TempDir dir;
  WriteVideo(dir / "v.avi", 3);
  std::filesystem::permissions(dir.path(), std::filesystem::perms::all);
  std::filesystem::permissions(dir / "v.avi", std::filesystem::perms::none);
  constexpr uid_t kNobody = 65534;
  const uid_t user = geteuid();
  if (user == 0) {
    ASSERT_EQ(seteuid(kNobody), 0);
  }
  ExpectThrows<InputError>([&] { OpenFrameSource(dir / "v.avi", {}); },
                           {dir / "v.avi", "no permission to read this file"});
  if (user == 0) {
    ASSERT_EQ(seteuid(user), 0);
  }
}

TEST(VideoFile, FramesAreNumberedTimedAndComplete) {
  const TempDir dir;
  WriteVideo(dir / "v.avi", 20);
  const auto source = OpenFrameSource(dir / "v.avi", {});
  EXPECT_TRUE(source->IsVideo());
  EXPECT_EQ(source->NumFrames(), 20);
  const std::vector<Frame> frames = ReadAll(source.get());
  ASSERT_EQ(frames.size(), 20u);
  for (int i = 0; i < 20; ++i) {
    Frame frame = frames[static_cast<std::size_t>(i)];
    EXPECT_EQ(frame.frame_number, i);
    EXPECT_NEAR(frame.time_s.value(), i / 25.0, 1e-9);
    std::string reason;
    EXPECT_TRUE(source->Load(&frame, &reason)) << reason;
    EXPECT_NEAR(cv::mean(frame.gray)[0], 10 * i, 3);
    EXPECT_NEAR(cv::mean(ColorImage(frame))[0], 10 * i, 3);
  }
  EXPECT_EQ(frames[7].image_name, "frame_000007.jpg");
}

TEST(VideoFile, StepRangeAndKnownFrames) {
  const TempDir dir;
  WriteVideo(dir / "v.avi", 20);
  const auto source = OpenFrameSource(dir / "v.avi", {3, 16, 4}, {"frame_000011.jpg"});
  EXPECT_EQ(source->NumFrames(), 3);
  const std::vector<Frame> frames = ReadAll(source.get());
  EXPECT_EQ(FrameNumbers(frames), (std::vector<int>{3, 7, 15}));
  EXPECT_NEAR(cv::mean(ColorImage(frames[2]))[0], 150, 3);
  EXPECT_NEAR(frames[2].time_s.value(), 15 / 25.0, 1e-9);
}

TEST(VideoFile, OptionsMayBeAsLargeAsAnInt) {
  const TempDir dir;
  WriteVideo(dir / "v.avi", 20);
  constexpr int kMax = std::numeric_limits<int>::max();
  const auto source = OpenFrameSource(dir / "v.avi", {3, kMax, kMax}, {"frame_000011.jpg"});
  EXPECT_EQ(source->NumFrames(), 1);
  EXPECT_EQ(FrameNumbers(ReadAll(source.get())), (std::vector<int>{3}));
}

TEST(VideoFile, FirstFrameBehindTheEndIsAnError) {
  const TempDir dir;
  WriteVideo(dir / "v.avi", 5);
  const auto source = OpenFrameSource(dir / "v.avi", {5, -1, 1});
  ExpectThrows<InputError>([&] { source->Next(); }, {"v.avi", "5 frames", "frame 5"});
}

TEST(VideoFile, BrokenOffVideoIsUsedAsFarAsItGoes) {
  const TempDir dir;
  WriteVideo(dir / "v.avi", 20);
  CutFile(dir / "v.avi", 0.8);  // half of this small file is its header
  const auto source = OpenFrameSource(dir / "v.avi", {});
  const std::vector<Frame> frames = ReadAll(source.get());
  EXPECT_GE(frames.size(), 5u);
  EXPECT_LT(frames.size(), 20u);
}

TEST(PixelAspectTest, PixelsAreSquareUnlessTheVideoSaysOtherwise) {
  const TempDir dir;
  ASSERT_NO_FATAL_FAILURE(MakeGreyClip(dir / "square.mp4", "-c:v libx264"));
  ASSERT_NO_FATAL_FAILURE(
      MakeGreyClip(dir / "wide.mp4", "-vf hue=s=0,format=yuv420p,setsar=4/3 -c:v libx264"));
  EXPECT_EQ(PixelAspect(dir / "square.mp4"), 1.0);
  EXPECT_NEAR(PixelAspect(dir / "wide.mp4"), 4.0 / 3, 1e-12);
}

}  // namespace
}  // namespace velamap
