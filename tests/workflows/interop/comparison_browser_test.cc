// comparison.html in a real browser: headless Chromium, which draws WebGL in software.

#include <fstream>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include "exporters/compare/comparison_sigma.h"
#include "exporters/comparison_page/comparison_page.h"
#include "tests/exporters/compare/example_comparison.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/interop/browser.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

using testing::HasSubstr;
using testing::Not;

// Two trims of one boat: one pushed out at the bottom and in at the top, and the same again.
class ComparisonBrowser : public BrowserTest {
 protected:
  static void SetUpTestSuite() {
    dir_ = new TempDir;
    Write("comparison.html", {"trim2", "trim3"}, "trim1");
    WriteTextFile(*dir_ / "phone.html",
                  "<!DOCTYPE html><body style=\"margin:0\"><iframe src=\"comparison.html\" "
                  "width=\"390\" height=\"3000\" style=\"border:0\"></iframe>");
  }

  static void Write(const std::string& file, const std::vector<std::string>& names,
                    const std::string& reference_name) {
    const MarkerShape reference = BoatShape(0.001);
    MarkerShape bent = reference;
    for (const ShapeMarker& marker : reference.markers) {
      if (marker.part != "sail") continue;
      const double push_m = 0.02 - 0.01 * marker.x_in_shape_m[0]->z();
      bent = Shifted({marker.marker_id}, push_m * MarkerNormal(marker), bent);
    }
    const auto uncertain = [](const MarkerShape& shape) {
      return UncertainShape{shape, CovarianceFromSigmas(shape)};
    };
    ComparisonOptions options;
    options.with_deflections = true;
    const std::vector<MarkerShape> shapes = {bent, reference};
    std::vector<Comparison> series;
    for (std::size_t i = 0; i < names.size(); ++i) {
      series.push_back(
          Compare(names[i], uncertain(shapes[i]), uncertain(reference), BoatLayout(), options));
    }
    const Layout layout = BoatLayout();
    ComparisonPageInput input{series, &reference, layout};
    input.reference_name = reference_name;
    input.version = "0.0";
    std::ofstream out(*dir_ / file, std::ios::binary);
    WriteComparisonPage(input, out);
  }
};

TEST_F(ComparisonBrowser, FillsThePageWithoutErrors) {
  std::string dom = Open("comparison.html", {"--dump-dom"}).out;
  EXPECT_THAT(dom, HasSubstr("data-ready-ms=")) << "the page's script did not reach its end";
  dom.resize(dom.find("<script"));  // what is seen, not what it is made from
  EXPECT_THAT(dom, HasSubstr("Differences from trim1: trim2 "));
  EXPECT_THAT(dom, HasSubstr("trim3 none"));
  EXPECT_THAT(dom, HasSubstr("trim2 minus trim1"));
  EXPECT_THAT(dom, HasSubstr("<h3>h5</h3>"));
  EXPECT_THAT(dom, HasSubstr("<polyline"));
  EXPECT_THAT(dom, HasSubstr("Markers compared"));
  EXPECT_THAT(dom, Not(HasSubstr("undefined")));
  EXPECT_THAT(dom, Not(HasSubstr("NaN")));
  EXPECT_THAT(dom, Not(HasSubstr("no WebGL")));
}

TEST_F(ComparisonBrowser, TheSurfaceIsColouredByTheSign) {
  const std::string view = "comparison.html#azimuth=0&elevation=0";
  const cv::Mat bent = Screenshot(view, 1400, 1600, "comparison.png");
  const cv::Mat same = Screenshot(view + "&colour=1", 1400, 1600, "comparison_same.png");
  ASSERT_EQ(bent.size(), same.size());
  const auto hues = [](const cv::Mat& picture) {
    int num_red = 0, num_blue = 0;
    for (int y = 0; y < picture.rows; ++y) {
      for (int x = 0; x < picture.cols; ++x) {
        const auto& pixel = picture.at<cv::Vec3b>(y, x);
        num_red += pixel[2] > pixel[0] + 60 ? 1 : 0;
        num_blue += pixel[0] > pixel[2] + 60 ? 1 : 0;
      }
    }
    return std::pair(num_red, num_blue);
  };
  // Both halves of the sail; of a shape that is the same, the legend alone.
  EXPECT_GT(hues(bent).first, hues(same).first + 10000);
  EXPECT_GT(hues(bent).second, hues(same).second + 10000);
}

TEST_F(ComparisonBrowser, NamesRunNoScript) {
  const std::string mark = "document.documentElement.dataset.owned=1";
  for (const std::string& name : std::vector<std::string>{
           "<script>" + mark + "</script>", "\"'><img src=x onerror=\"" + mark + "\">",
           "</script><script>" + mark + "</script>"}) {
    Write("names.html", {name}, name);
    const std::string dom = Open("names.html", {"--dump-dom"}).out;
    EXPECT_THAT(dom, HasSubstr("data-ready-ms=")) << name;
    EXPECT_THAT(dom, Not(HasSubstr("data-owned"))) << name;
  }
}

TEST_F(ComparisonBrowser, FitsAPhone) {
  const cv::Mat phone = Screenshot("phone.html", 500, 3000, "comparison_phone.png");
  const cv::Mat page = phone(cv::Rect(0, 0, 390, 3000));
  // Nothing reaches beyond the screen: its last columns are the page's ground.
  EXPECT_GT(PartOfColour(page.colRange(384, 390), {0xf8, 0xf6, 0xf4}), 0.999);
}

// The words of 'Aligned by' do not push the figures off the screen.
TEST_F(ComparisonBrowser, TheFiguresFitAPhone) {
  Write("one.html", {"trim2"}, "trim1");
  WriteTextFile(*dir_ / "one_phone.html",
                "<!DOCTYPE html><body><iframe width=\"390\" height=\"3000\" srcdoc=\"" +
                    EscapedForAttribute(ReadFileBytes(*dir_ / "one.html")) +
                    "\"></iframe><script>" +
                    "const frame = document.querySelector('iframe');"
                    "frame.addEventListener('load', () => setTimeout(() => {"
                    "const table = frame.contentDocument.querySelector('#table_shapes');"
                    "frame.dataset.beyond_px = table.scrollWidth - table.clientWidth;"
                    "}, 300));</script>");
  EXPECT_THAT(Open("one_phone.html", {"--dump-dom", "--virtual-time-budget=4000"}).out,
              HasSubstr("data-beyond_px=\"0\""));
}

TEST_F(ComparisonBrowser, FollowsADarkTheme) {
  const cv::Mat dark =
      Screenshot("comparison.html", 1400, 900, "comparison_dark.png", {"--force-dark-mode"});
  EXPECT_LT(cv::mean(dark(cv::Rect(0, 0, 1400, 200)))[0], 80);
}

TEST_F(ComparisonBrowser, Prints) {
  const std::string path = (*dir_ / "comparison.pdf").string();
  Open("comparison.html", {"--print-to-pdf=" + path});
  const std::string pdf = ReadFileBytes(path);
  EXPECT_EQ(pdf.substr(0, 5), "%PDF-");
  EXPECT_GT(pdf.size(), 50000u);
}

}  // namespace
}  // namespace velamap
