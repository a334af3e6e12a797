// report.html in a real browser: headless Chromium, which draws WebGL in software.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include "exporters/report/report_writer.h"
#include "tests/exporters/report/report_example.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/interop/browser.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

// Of straight lines between this many points.
Eigen::ArrayXd KnotsOfDegree1(int num_points) {
  Eigen::ArrayXd knots(num_points + 2);
  knots << 0, Eigen::ArrayXd::LinSpaced(num_points, 0, 1), 1;
  return knots;
}

// Through the centres of the markers, which stand in rows of 13 by id.
SailSurface SurfaceThrough(const MarkerShape& shape) {
  constexpr int kNumColumns = 13;
  const int num_rows = static_cast<int>(shape.markers.size()) / kNumColumns;
  SailSurface result;
  result.part = "sail";
  SplineSurface& surface = result.fit.surface;
  surface.degree_u = surface.degree_v = 1;
  surface.knots_u = KnotsOfDegree1(kNumColumns);
  surface.knots_v = KnotsOfDegree1(num_rows);
  surface.poles_in_shape_m.resize(kNumColumns * num_rows, 3);
  for (int i = 0; i < kNumColumns * num_rows; ++i) {
    surface.poles_in_shape_m.row(i % kNumColumns * num_rows + i / kNumColumns) =
        shape.markers[static_cast<std::size_t>(i)].x_in_shape_m[0]->transpose();
  }
  result.area_m2 = SurfaceArea(surface);
  return result;
}

// The largest example asked for: 130 markers, 100 cameras, with sigmas, sections and a surface.
class ReportBrowser : public BrowserTest {
 protected:
  static void SetUpTestSuite() {
    dir_ = new TempDir;
    ReportExample example = MakeReportExample(10, 100);
    num_markers_ = static_cast<int>(example.shape.markers.size());
    for (ShapeMarker& marker : example.shape.markers) {
      marker.sigma_m[0] = Eigen::Vector3d(2e-4, 3e-4, 6e-4);
    }
    DrawCentralImage(example.model, dir_->path());
    Section section = StraightSection("line h3", *example.shape.markers[39].x_in_shape_m[0],
                                      *example.shape.markers[51].x_in_shape_m[0]);
    section.chord_m = {2.345, 0.0012};
    section.camber = {0.0925, 0.00003};
    section.draft_position = Estimate{0.412, 0.0012};
    section.entry_angle_deg = {20.5, 0.14};
    section.exit_angle_deg = {-17.5, 0.14};
    section.twist_deg = Estimate{10.3, 0.011};
    section.leech_twist_deg = Estimate{-10.1, 0.12};
    section.girth_m = {2.4021, 0.0013};
    section.num_missing_at_luff = 3;
    section.num_missing_at_leech = 2;
    example.sail.sections.sections = {section};
    example.sail.sections.notes = {"twist of sail refers to section h4"};
    example.sail.surfaces = {SurfaceThrough(example.shape)};
    ReportInput input = example.Input();
    input.image_path = dir_->path().string();
    input.images_left_out = {{"frame_000200.jpg", "too blurred for two markers"}};
    input.images_not_needed = {{"frame_000201.jpg", "frames next to it are sharper"}};
    input.design = ReportDesign{"design.step", 130, 31.25, {{{0, 0}, {1, 0.15}, {2.345, 0}}}};
    std::ofstream out(*dir_ / "report.html", std::ios::binary);
    WriteReport(input, out);
    WriteTextFile(*dir_ / "phone.html",
                  "<!DOCTYPE html><body style=\"margin:0\"><iframe src=\"report.html\" "
                  "width=\"390\" height=\"1500\" style=\"border:0\"></iframe>");
  }

  std::vector<std::string> ProblemsOf(const std::string& page,
                                      const std::vector<std::string>& widths) const;

  static int num_markers_;
};

int ReportBrowser::num_markers_ = 0;

TEST_F(ReportBrowser, FillsThePageWithoutErrors) {
  std::string dom = Open("report.html", {"--dump-dom"}).out;
  dom.resize(dom.find("<script"));  // what is seen, not what it is made from
  ASSERT_EQ(num_markers_, 130);
  EXPECT_THAT(dom, HasSubstr("130 of 131"));
  EXPECT_THAT(dom, HasSubstr("100 of 102"));
  EXPECT_THAT(dom, HasSubstr("too blurred for two markers"));
  EXPECT_GT(dom.find("frames next to it are sharper"), dom.find(">Not needed<"));
  EXPECT_THAT(dom, HasSubstr("</span>1 sigma × "));
  EXPECT_THAT(dom, HasSubstr("line h3"));
  EXPECT_THAT(dom, HasSubstr("2345.0 ± 1.2"));
  EXPECT_THAT(dom, HasSubstr("9.250 ± 0.003"));
  EXPECT_THAT(dom, HasSubstr("Dashed: design.step"));
  EXPECT_THAT(dom, HasSubstr("twist of sail refers to section h4"));
  EXPECT_THAT(dom, HasSubstr("Registration.method"));
  EXPECT_THAT(dom, HasSubstr("data:image/jpeg;base64,"));
  EXPECT_THAT(dom, HasSubstr("save the chart"));
  EXPECT_THAT(dom, Not(HasSubstr("No picture")));
  EXPECT_THAT(dom, Not(HasSubstr("no WebGL")));
  std::smatch time;
  ASSERT_TRUE(std::regex_search(dom, time, std::regex("data-ready-ms=\"([0-9]+)\"")))
      << "the page's script did not reach its end";
  RecordProperty("ready_ms", time[1]);
  // Counts from the start of the browser, which draws WebGL in software beside other tests; with
  // the machine to itself it is below a second.
  EXPECT_LT(std::stoi(time[1]), 15000);
}

TEST_F(ReportBrowser, NamesRunNoScript) {
  const std::string mark = "document.documentElement.dataset.owned=1";
  // One after the other in each name, because to start the browser takes seconds.
  const std::string name = "<script>" + mark + "</script>" + "\"'><img src=x onerror=\"" + mark +
                           "\">" + "</script><script>" + mark + "</script>" + "'};" + mark + ";//" +
                           "--><!--\\u003cscript>";
  ReportExample example = MakeReportExample(1, 3);
  for (LayoutPart& part : example.layout.parts) part.name = name;
  for (ShapeMarker& marker : example.shape.markers) marker.part = name;
  for (ModelImage& image : example.model.images) image.name = name + image.name;
  example.sail.sections.sections = {StraightSection(name, {0, 0, 0}, {2, 0, 0})};
  example.sail.sections.notes = {name};
  ReportInput input = example.Input();
  input.title = name;
  input.images_left_out = {{name, name}};
  input.markers_left_out = {{name, name}};
  input.warnings = {name};
  input.options = {{name, name}};
  input.versions = {{name, name}};
  input.design = ReportDesign{name, 30, 1.5, {{{0, 0}, {1, 0.2}, {2, 0}}}};
  std::ostringstream page;
  WriteReport(input, page);
  WriteTextFile(*dir_ / "names.html", page.str());
  const std::string dom = Open("names.html", {"--dump-dom"}).out;
  EXPECT_THAT(dom, HasSubstr("data-ready-ms="));
  EXPECT_THAT(dom, Not(HasSubstr("data-owned")));
}

TEST_F(ReportBrowser, TheViewTurns) {
  const cv::Mat front = Screenshot("report.html#azimuth=0&elevation=0", 1280, 1150, "front.png");
  const cv::Mat again = Screenshot("report.html#azimuth=0&elevation=0", 1280, 1150, "again.png");
  const cv::Mat turned =
      Screenshot("report.html#azimuth=50&elevation=30", 1280, 1150, "turned.png");
  ASSERT_EQ(front.size(), turned.size());
  EXPECT_LT(PartThatDiffers(front, again), 1e-4);
  EXPECT_GT(PartThatDiffers(front, turned), 0.01);
  // All that differs lies in the view, below the key numbers.
  const cv::Rect head(0, 0, 1280, 300);
  EXPECT_EQ(PartThatDiffers(front(head), turned(head)), 0);
  // Markers of the first part are there, seen from the front.
  EXPECT_GT(PartOfColour(front, {0xb2, 0x72, 0x00}), 0.01);
}

// The example with its lowest row of markers as a hull, lower by this many heights of the sail.
std::string PageWithHull(double drop) {
  constexpr int kNumColumns = 13;
  ReportExample example = MakeReportExample(10, 5);
  std::vector<ShapeMarker>& markers = example.shape.markers;
  const auto height_m = [](const ShapeMarker& marker) { return marker.x_in_shape_m[0]->z(); };
  std::vector<double> heights_m;
  for (const ShapeMarker& marker : markers) heights_m.push_back(height_m(marker));
  std::sort(heights_m.begin(), heights_m.end());
  MarkerShape sail;
  for (ShapeMarker& marker : markers) {
    if (height_m(marker) >= heights_m[kNumColumns]) {
      sail.markers.push_back(marker);
      continue;
    }
    marker.part = "hull";
    for (auto& x : marker.x_in_shape_m) x->z() -= drop * (heights_m.back() - heights_m.front());
  }
  example.sail.surfaces = {SurfaceThrough(sail)};
  ReportInput input = example.Input();
  input.frame = ReportFrame{"upright", Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY()};
  std::ostringstream page;
  WriteReport(input, page);
  return page.str();
}

// Places of the labels of the axes that are shown, px.
std::vector<cv::Point2d> AxisLabels(const std::string& dom) {
  const std::size_t begin = dom.find("id=\"view_axes\"");
  const std::string spans = dom.substr(begin, dom.find("</div>", begin) - begin);
  const std::regex label(
      "<span style=\"transform: translate\\((-?[0-9.]+)px, (-?[0-9.]+)px\\)[^\"]*\">");
  std::vector<cv::Point2d> places;
  for (std::sregex_iterator it(spans.begin(), spans.end(), label), end; it != end; ++it) {
    places.emplace_back(std::stod((*it)[1]), std::stod((*it)[2]));
  }
  return places;
}

TEST_F(ReportBrowser, TheFirstViewHoldsAllThatItsLegendLists) {
  const cv::Scalar of_hull(0xb2, 0x72, 0x00);  // BGR
  WriteTextFile(*dir_ / "near.html", PageWithHull(0.3));
  WriteTextFile(*dir_ / "far.html", PageWithHull(5));
  const std::string note = "not in the first view: hull (\"All cameras\" shows all)";
  const std::string near = Open("near.html", {"--dump-dom"}).out;
  const std::string far = Open("far.html", {"--dump-dom"}).out;
  EXPECT_THAT(near.substr(0, near.find("<script")), Not(HasSubstr(note)));
  EXPECT_THAT(far.substr(0, far.find("<script")), HasSubstr(note));
  const cv::Mat near_picture = Screenshot("near.html", 1280, 1500, "near.png");
  EXPECT_GT(PartOfColour(near_picture, of_hull), 0.0005);
  // The sail would be tiny beside a hull that is far away; the swatch of the legend is left.
  EXPECT_LT(PartOfColour(Screenshot("far.html", 1280, 1500, "far.png"), of_hull), 0.0002);
}

TEST_F(ReportBrowser, LabelsOfTheAxesStandApartInTheView) {
  WriteTextFile(*dir_ / "axes.html", PageWithHull(0.3));
  for (const char* view : {"", "#azimuth=0&elevation=0", "#azimuth=90&elevation=0"}) {
    const std::string dom =
        Open(std::string("axes.html") + view, {"--dump-dom", "--window-size=1280,1500"}).out;
    const std::vector<cv::Point2d> labels = AxisLabels(dom);
    EXPECT_GT(labels.size(), 5u) << view;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      EXPECT_GT(std::min(labels[i].x, labels[i].y), 6) << view;
      EXPECT_LT(labels[i].y, 614) << view;  // of 620
      for (std::size_t j = 0; j < i; ++j) {
        // In the first view, none stands beside another one either, as of two axes.
        const double least_x = *view == '\0' ? 40 : 11;
        const cv::Point2d apart = labels[i] - labels[j];
        EXPECT_TRUE(std::abs(apart.x) > least_x || std::abs(apart.y) >= 12) << view << labels[i];
      }
    }
  }
}

TEST_F(ReportBrowser, ColoursFollowTheSwitch) {
  const cv::Mat part = Screenshot("report.html#azimuth=0&elevation=0", 1280, 1150, "front.png");
  const cv::Mat error =
      Screenshot("report.html#azimuth=0&elevation=0&colour=error", 1280, 1150, "error.png");
  EXPECT_GT(PartThatDiffers(part, error), 0.01);
  EXPECT_LT(PartOfColour(error, {0xb2, 0x72, 0x00}), 0.002);
}

TEST_F(ReportBrowser, FitsAPhone) {
  const cv::Mat phone = Screenshot("phone.html", 500, 1500, "phone.png");
  cv::Mat page = phone(cv::Rect(0, 0, 390, 1500));
  cv::Scalar mean, deviation;
  cv::meanStdDev(page, mean, deviation);
  EXPECT_GT(deviation[0], 10);
  EXPECT_GT(PartOfColour(page, {0xb2, 0x72, 0x00}), 0.002);
  // Nothing reaches beyond the screen: its last columns are the page's ground.
  EXPECT_GT(PartOfColour(page.colRange(384, 390), {0xf8, 0xf6, 0xf4}), 0.999);
}

// What page_problems.js finds in the page at each of these widths, px.
std::vector<std::string> ReportBrowser::ProblemsOf(const std::string& page,
                                                   const std::vector<std::string>& widths) const {
  const std::string escaped = EscapedForAttribute(page);
  std::string frames;
  for (const std::string& width : widths) {
    frames +=
        "<iframe width=\"" + width + "\" height=\"3000\" srcdoc=\"" + escaped + "\"></iframe>";
  }
  WriteTextFile(*dir_ / "measured.html",
                "<!DOCTYPE html><body>" + frames + "<script>" +
                    ReadFileBytes(fs::path(VELAMAP_INTEROP_DIR) / "page_problems.js") +
                    "</script>");
  const std::string dom =
      Open("measured.html", {"--dump-dom", "--window-size=1500,3000", "--virtual-time-budget=4000"})
          .out;
  const std::regex problems("data-problems=\"([^\"]*)\"");
  std::vector<std::string> found;
  for (std::sregex_iterator it(dom.begin(), dom.end(), problems), end; it != end; ++it) {
    found.push_back((*it)[1]);
  }
  return found;
}

// Sizes and places of the elements on a phone and on a large screen.
TEST_F(ReportBrowser, NothingOverlapsOrIsCut) {
  EXPECT_THAT(ProblemsOf(ReadFileBytes(*dir_ / "report.html"), {"390", "1400"}),
              ElementsAre("none", "none"));
}

// The page as it is laid out for a printer, which a browser shows if it takes the rules of print
// for those of its screen.
TEST_F(ReportBrowser, NoPrintedTableIsWiderThanThePaper) {
  constexpr char kA4_px[] = "703";  // 186 mm between the margins
  std::string page = ReadFileBytes(*dir_ / "report.html");
  page = std::regex_replace(page, std::regex("@media print"), "@media screen");
  page = std::regex_replace(page, std::regex("<html"), "<html class=\"printing\"");
  EXPECT_THAT(ProblemsOf(page, {kA4_px}), ElementsAre("none"));
}

TEST_F(ReportBrowser, Prints) {
  const std::string path = (*dir_ / "report.pdf").string();
  Open("report.html", {"--print-to-pdf=" + path});
  const std::string pdf = ReadFileBytes(path);
  EXPECT_EQ(pdf.substr(0, 5), "%PDF-");
  // The pictures of the view and of the central image are inside.
  EXPECT_GT(pdf.size(), 100000u);
  // Long tables print only if they are opened.
  const std::regex page("/Type /Page[^s]");
  const auto num_pages = std::distance(std::sregex_iterator(pdf.begin(), pdf.end(), page), {});
  EXPECT_GE(num_pages, 2);
  EXPECT_LE(num_pages, 5);
}

}  // namespace
}  // namespace velamap
