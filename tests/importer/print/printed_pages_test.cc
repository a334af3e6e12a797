// The pages as a printer gets them: through pdftoppm (and rsvg-convert) to pictures, and from there
// through the real importer, which has to find every marker in its place and size.

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "importer/database/colmap_database.h"
#include "importer/layout/dictionary.h"
#include "importer/marker_importer.h"
#include "importer/print/marker_sheets.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

constexpr double kMmPerInch = 25.4;
// pdftoppm puts edges on quarters of a pixel, and a fit of what that gives is off by less than
// this. A thousandth is more from 300 px on.
constexpr double kErrorOfPictures_px = 0.3;

struct FoundMarker {
  double side_px = 0.0, side_mm = 0.0;           // mean of the four sides
  Eigen::Vector2d up = Eigen::Vector2d::Zero();  // from bottom left to top left, in the picture
};

class PrintedPagesTest : public testing::Test {
 protected:
  std::string Folder() const { return dir_ / "out"; }
  fs::path Images() const { return dir_ / "images"; }

  // Every page of sheets.pdf, as a program that prints it has it.
  void Rasterize(int dpi) {
    fs::remove_all(Images());
    fs::create_directory(Images());
    const std::string command =
        fmt::format("pdftoppm -gray -r {} {}/sheets.pdf {}/page", dpi, Folder(), Images().string());
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
  }

  // Markers of all pages with the layout that was written. Pages of different sizes have cameras of
  // their own, and so are imported apart. Without a margin around a page, as a camera has it, the
  // paper's edge would be the picture's.
  std::map<int, FoundMarker> Import(double dpi) {
    std::map<int, FoundMarker> found;
    int num_pages = 0;
    for (const auto& entry : fs::directory_iterator(Images())) {
      const fs::path folder = dir_ / fmt::format("page{}", num_pages++);
      fs::create_directory(folder);
      const cv::Mat page = cv::imread(entry.path().string(), cv::IMREAD_GRAYSCALE);
      cv::imwrite((folder / "page.png").string(), page);
      MarkerImporterOptions options;
      options.image_path = folder.string();
      options.database_path = folder.string() + ".db";
      options.camera = {CameraModel::kPinhole,
                        page.cols,
                        page.rows,
                        {1.0 * page.cols, 1.0 * page.cols, 0.5 * page.cols, 0.5 * page.rows}};
      options.camera_path = "camera.yml";
      options.layout = ReadLayout(dir_ / "out/layout.yml");
      options.num_threads = 1;
      options.detection.estimate_formation = estimates_formation_;
      try {
        ImportMarkers(options);
      } catch (const DataError&) {
        continue;  // a drawing of places
      }
      Collect(options.database_path, dpi, &found);
      fs::remove_all(folder);
      fs::remove(options.database_path);
    }
    return found;
  }

  void Collect(const std::string& database_path, double dpi, std::map<int, FoundMarker>* found) {
    const ColmapDatabase database(database_path, ColmapDatabase::Mode::kReadOnly);
    for (const DatabaseImage& image : database.ReadImages()) {
      for (const MarkerDetection& marker : image.detections.markers) {
        const auto& corners = marker.corners_in_image_px;
        double side_px = 0;
        for (std::size_t i = 0; i < 4; ++i)
          side_px += (corners[(i + 1) % 4] - corners[i]).norm() / 4;
        EXPECT_TRUE(found
                        ->emplace(marker.marker_id, FoundMarker{side_px, side_px * kMmPerInch / dpi,
                                                                corners[0] - corners[3]})
                        .second)
            << "marker " << marker.marker_id << " twice";
      }
    }
  }

  void ExpectAll(const std::map<int, FoundMarker>& found, const std::vector<int>& ids,
                 double length_mm, const std::string& what) {
    double mean_size = 0;
    for (const int id : ids) {
      const auto marker = found.find(id);
      ASSERT_NE(marker, found.end()) << what << ": marker " << id << " is missing";
      const double tolerance = std::max(1e-3, kErrorOfPictures_px / marker->second.side_px);
      EXPECT_NEAR(marker->second.side_mm / length_mm, 1.0, tolerance) << what << ": marker " << id;
      mean_size += marker->second.side_mm / length_mm / static_cast<double>(ids.size());
      EXPECT_LT(marker->second.up.y(), 0) << what << ": marker " << id << " is not upright";
      EXPECT_LT(std::abs(marker->second.up.x()), 1) << what;
    }
    EXPECT_NEAR(mean_size, 1.0, 1e-3) << what;
    EXPECT_EQ(found.size(), ids.size()) << what;
  }

  TempDir dir_;
  PrintOptions options_;
  // It takes long where markers are large, and a page has no camera to estimate.
  bool estimates_formation_ = false;
};

std::vector<int> Range(int first, int count) {
  std::vector<int> ids;
  for (int i = 0; i < count; ++i) ids.push_back(first + i);
  return ids;
}

TEST_F(PrintedPagesTest, EverySizeAndPaperAtBothResolutions) {
  for (const auto& [paper, length_m] :
       {std::pair("A4", 0.1), std::pair("Letter", 0.06), std::pair("180x130", 0.055)}) {
    options_.sheet.paper = ParsePaper(paper, "");
    options_.marker_length_m = length_m;
    options_.first_id = 7;
    options_.num_markers = 2;
    PrintMarkers(options_, Folder());
    for (const int dpi : {150, 300}) {
      estimates_formation_ = dpi == 150;
      Rasterize(dpi);
      ExpectAll(Import(dpi), Range(7, 2), 1000 * length_m, fmt::format("{} {} dpi", paper, dpi));
    }
  }
}

TEST_F(PrintedPagesTest, EveryPredefinedDictionary) {
  options_.sheet.paper = ParsePaper("130x100", "");
  options_.marker_length_m = 0.03;
  for (const std::string& name : PredefinedDictionaryNames()) {
    options_.dictionary = name;
    options_.ids = {0, NumMarkers(LoadDictionary(name)) - 1};
    PrintMarkers(options_, Folder());
    Rasterize(300);
    ExpectAll(Import(300), options_.ids, 30, name);
  }
}

TEST_F(PrintedPagesTest, OwnDictionariesOfAllSizes) {
  options_.sheet.paper = ParsePaper("180x100", "");
  options_.marker_length_m = 0.03;
  options_.num_markers = 3;
  for (int bits = 3; bits <= 8; ++bits) {
    options_.codes.bits_per_side = bits;
    PrintMarkers(options_, Folder());
    Rasterize(300);
    ExpectAll(Import(300), Range(0, 3), 30, fmt::format("{}x{} bits", bits, bits));
  }
}

TEST_F(PrintedPagesTest, SheetsOfASailWithItsLayout) {
  options_.arrangement = Arrangement::kSail;
  options_.sail.luff_m = 2;
  options_.sail.foot_m = 1;
  options_.sail.leech_m = 2.1;
  options_.sail.num_lines = 2;
  options_.sail.markers_per_line = 4;
  options_.sail.hull_markers = 3;
  options_.marker_length_m = 0.04;
  const PrintReport report = PrintMarkers(options_, Folder());
  Rasterize(150);
  ExpectAll(Import(150), Range(0, report.num_markers), 40, "sail");
}

TEST_F(PrintedPagesTest, BoardsAreReadWithTheirLayout) {
  for (const Arrangement arrangement : {Arrangement::kBoard, Arrangement::kCharuco}) {
    options_.arrangement = arrangement;
    const PrintReport report = PrintMarkers(options_, Folder());
    const double length_mm = 1000 * ReadLayout(dir_ / "out/layout.yml").marker_length_m;
    for (const int dpi : {150, 300}) {
      Rasterize(dpi);
      ExpectAll(Import(dpi), Range(0, report.num_markers), length_mm,
                fmt::format("board {} at {} dpi", static_cast<int>(arrangement), dpi));
    }
  }
}

TEST_F(PrintedPagesTest, SingleMarkersAsPngAndSvg) {
  options_.sheet.write_png = options_.sheet.write_svg = true;
  options_.marker_length_m = 0.05;
  options_.ids = {12};
  PrintMarkers(options_, Folder());
  fs::create_directory(Images());
  fs::copy(dir_ / "out/markers/marker_0012.png", Images() / "12.png");
  // A cell of 8.33 mm has 99 pixels, the least whole number that makes 300 dpi.
  ExpectAll(Import(99 / (50.0 / 6) * kMmPerInch), {12}, 50, "png");
  fs::remove_all(Images());
  fs::create_directory(Images());
  const std::string command =
      fmt::format("rsvg-convert -d 300 -p 300 {}/markers/marker_0012.svg -o {}/12.png", Folder(),
                  Images().string());
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  ExpectAll(Import(300), {12}, 50, "svg");
}

}  // namespace
}  // namespace velamap
