#include "exporters/calibration/calibration_page.h"

#include <algorithm>
#include <limits>
#include <sstream>
#include <string>

#include <gmock/gmock.h>

#include "exporters/calibration/calibration_verdict.h"
#include "tests/support/scoped_date.h"

namespace velamap {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// Twelve views that cover the whole picture with all tilts and hardly any residuals.
CameraCalibration GoodCalibration() {
  CameraCalibration calibration;
  calibration.camera.camera = {CameraModel::kSimpleRadial, 800, 600, {700, 401, 299, -0.05}};
  calibration.camera.sigmas = {0.5, 0.4, 0.4, 1e-3};
  calibration.scores = {{CameraModel::kSimpleRadial, 0.1, 0.09, false},
                        {CameraModel::kOpenCV, 0.11, 0.08, false}};
  calibration.num_images = 12;
  calibration.error_px.rms = 0.1;
  calibration.board = {0.3, true, 3e-4, 6e-4, 1e-5, 1e-3, 1e-4, 1e-3};
  for (int i = 0; i < 12; ++i) {
    BoardView view;
    view.image_name = "picture " + std::to_string(i);
    view.tilt_deg = i % 5 == 0 ? 2.0 : 30.0;
    view.tilt_direction_deg = 45.0 * (i % 4);
    for (int x_px = 10; x_px < 800; x_px += 40) {
      for (int y_px = 10; y_px < 600; y_px += 40) {
        view.corners_in_image_px.emplace_back(x_px, y_px);
        const double sign = (x_px / 40 + y_px / 40 + i) % 2 == 0 ? 1.0 : -1.0;
        calibration.residuals.push_back({{x_px, y_px}, {0.07 * sign, -0.07 * sign}});
      }
    }
    calibration.views.push_back({view, 0.1, true});
  }
  return calibration;
}

std::string Page(const CameraCalibration& calibration) {
  std::ostringstream out;
  WriteCalibrationPage(calibration, {"board<1>.mp4", "phone.yml", "DICT_4X4_50"}, out);
  return out.str();
}

// So that the pages of two cameras are not mistaken for each other.
TEST(CalibrationPage, NamesCameraFilePicturesAndDate) {
  const ScopedDate date("1700000000");
  EXPECT_THAT(
      Page(GoodCalibration()),
      AllOf(HasSubstr("<title>phone.yml from board&lt;1&gt;.mp4 – velamap camera calibration"),
            HasSubstr("<h1>Camera calibration: phone.yml from board&lt;1&gt;.mp4</h1>"),
            HasSubstr("2023-11-14 22:13 UTC")));
}

TEST(CalibrationPage, SaysTheVerdictFirstAndEverythingOnce) {
  const std::string page = Page(GoodCalibration());
  EXPECT_THAT(page, AllOf(HasSubstr("Good: use the camera file."), HasSubstr("Nothing is missing."),
                          HasSubstr("SIMPLE_RADIAL: taken"), HasSubstr("focal length, px"),
                          HasSubstr("12 of the 12 pictures that show the board were used"),
                          HasSubstr("</html>"), Not(HasSubstr("{{"))));
  // A scale that can be read.
  EXPECT_THAT(page, ContainsRegex("drawn [125]0* times as long"));
  EXPECT_THAT(page, HasSubstr("only where its error there is smaller by more than chance"));
  EXPECT_LT(page.find("id=\"verdict\""), page.find("id=\"camera_title\""));
}

TEST(CalibrationPage, HoldsNoScriptAndNothingFromOutside) {
  CameraCalibration calibration = GoodCalibration();
  calibration.views[0].view.image_name = "<script>alert(1)</script><img src=http://x.y/z>.png";
  calibration.warnings = {"<b>{{STYLE}}</b>"};
  const std::string page = Page(calibration);
  EXPECT_THAT(page, AllOf(Not(HasSubstr("<script")), Not(HasSubstr("<img")), Not(HasSubstr("<b>")),
                          HasSubstr("&lt;script&gt;alert(1)"), HasSubstr("&lt;b&gt;{{STYLE}}"),
                          HasSubstr("default-src 'none'"), HasSubstr("width=device-width")));
}

TEST(CalibrationVerdict, AGoodCalibrationLeavesNothingToDo) {
  const Verdict verdict = JudgeCalibration(GoodCalibration());
  EXPECT_EQ(verdict.level, ReportStatus::kGood) << verdict.reasons.front().text;
  EXPECT_THAT(AdvisedViews(GoodCalibration()), IsEmpty());
}

TEST(CalibrationVerdict, AFisheyeTakenForAPinholeIsBad) {
  CameraCalibration calibration = GoodCalibration();
  calibration.scores[1] = {CameraModel::kOpenCVFisheye, 0.05, 0.05, false};
  const Verdict verdict = JudgeCalibration(calibration);
  EXPECT_EQ(verdict.level, ReportStatus::kBad);
  EXPECT_THAT(verdict.reasons.front().text, HasSubstr("those of a fisheye lens"));
}

TEST(CalibrationVerdict, EachFaultIsNamed) {
  const auto first_reason = [](void (*spoil)(CameraCalibration*)) {
    CameraCalibration calibration = GoodCalibration();
    spoil(&calibration);
    const Verdict verdict = JudgeCalibration(calibration);
    return verdict.reasons.empty() ? std::string() : verdict.reasons.front().text;
  };
  EXPECT_THAT(first_reason([](auto* c) {
                for (auto& score : c->scores) {
                  score.unseen_error_px = std::numeric_limits<double>::infinity();
                }
              }),
              HasSubstr("the pictures are too few to leave some out"));
  EXPECT_THAT(first_reason([](auto* c) { c->camera.sigmas[0] = 7.0; }),
              HasSubstr("the focal length is known to 1.00 %"));
  EXPECT_THAT(first_reason([](auto* c) { c->camera.sigmas[2] = 4.0; }),
              HasSubstr("the principal point is known to 4.0 px"));
  EXPECT_THAT(first_reason([](auto* c) { c->views.resize(5); }), HasSubstr("only 5 pictures"));
  EXPECT_THAT(first_reason([](auto* c) { c->num_outliers = 1000; }),
              HasSubstr("of the corners were left out"));
  EXPECT_THAT(first_reason([](auto* c) {
                for (auto& view : c->views) view.view.tilt_deg = 3.0;
              }),
              HasSubstr("hardly ever tilted"));
  EXPECT_THAT(first_reason([](auto* c) {
                for (auto& residual : c->residuals) {
                  residual.residual_px = {residual.x_in_image_px.x() < 400 ? 0.1 : -0.1, 0.0};
                }
              }),
              HasSubstr("have a pattern over the picture"));
}

TEST(CalibrationVerdict, EmptyPartsOfThePictureAreNamed) {
  CameraCalibration calibration = GoodCalibration();
  for (CalibrationView& view : calibration.views) {
    auto& corners = view.view.corners_in_image_px;
    corners.erase(std::remove_if(corners.begin(), corners.end(),
                                 [](const auto& x_px) { return x_px.x() > 300; }),
                  corners.end());
  }
  EXPECT_THAT(AdvisedViews(calibration).front(),
              AllOf(HasSubstr("top right"), HasSubstr("bottom right"), Not(HasSubstr("left"))));
  EXPECT_THAT(JudgeCalibration(calibration).reasons.front().text,
              HasSubstr("move it into every corner"));
}

}  // namespace
}  // namespace velamap
