#include "exporters/calibration/calibration_page.h"

#include <stdexcept>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "exporters/calibration/calibration_drawing.h"
#include "exporters/calibration/calibration_verdict.h"
#include "exporters/report/html_page.h"
#include "exporters/report/report_assets.h"
#include "importer/camera/camera_projection.h"
#include "importer/text/markup.h"
#include "importer/text/output_date.h"

namespace velamap {
namespace {

std::string TableRow(const std::vector<std::string>& cells, const char* tag = "td") {
  std::string row = "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    row += fmt::format("<{0}{1}>{2}</{0}>", tag, i == 0 ? " class=\"text\"" : "",
                       EscapeForMarkup(cells[i]));
  }
  return row + "</tr>";
}

std::string BulletList(const std::vector<std::string>& texts) {
  std::string items;
  for (const std::string& text : texts) items += "<li>" + EscapeForMarkup(text) + "</li>";
  return "<ul>" + items + "</ul>";
}

std::string VerdictHtml(const Verdict& verdict) {
  const std::string level = StatusName(verdict.level);
  const char* meaning = verdict.level == ReportStatus::kGood ? "Good: use the camera file."
                        : verdict.level == ReportStatus::kCheck
                            ? "Usable, but it could be better."
                            : "Bad: do not use the camera file.";
  std::string items;
  for (const VerdictReason& reason : verdict.reasons) {
    items += fmt::format("<li class=\"{}\">{}</li>", StatusName(reason.level),
                         EscapeForMarkup(reason.text));
  }
  return fmt::format("<div class=\"card {}\"><p class=\"value verdict\">{}</p>{}</div>", level,
                     meaning, items.empty() ? "" : "<ul>" + items + "</ul>");
}

std::vector<std::string> ParameterNames(const Camera& camera) {
  std::vector<std::string> names = {"focal length, px"};
  if (!HasOneFocalLength(camera.model)) names = {"focal length in x, px", "focal length in y, px"};
  names.insert(names.end(), {"principal point x, px", "principal point y, px"});
  for (std::size_t i = 0; names.size() < camera.params.size(); ++i) {
    names.emplace_back(DistortionName(camera.model, i));
  }
  return names;
}

std::string ParameterTable(const EstimatedCamera& found) {
  const std::vector<std::string> names = ParameterNames(found.camera);
  std::string rows = TableRow({CameraModelName(found.camera.model), "value", "sigma"}, "th");
  for (std::size_t i = 0; i < found.camera.params.size(); ++i) {
    if (IsHeldAtZero(found, i)) continue;
    const bool is_px = names[i].find("px") != std::string::npos;
    rows += TableRow({names[i], fmt::format("{:.{}f}", found.camera.params[i], is_px ? 2 : 6),
                      fmt::format("{:.{}f}", found.sigmas[i], is_px ? 2 : 6)});
  }
  return rows;
}

std::string ModelTable(const CameraCalibration& calibration) {
  std::string rows = TableRow({"model", "parameters", "unseen, px", "all, px"}, "th");
  for (const CameraModelScore& score : calibration.scores) {
    const bool is_taken = score.model == calibration.camera.camera.model;
    rows += TableRow({CameraModelName(score.model) + (is_taken ? ": taken" : "") +
                          (score.is_folded ? ": folds over inside the picture" : ""),
                      fmt::format("{}", NumCameraParams(score.model)),
                      fmt::format("{:.4f}", score.unseen_error_px),
                      fmt::format("{:.4f}", score.seen_error_px)});
  }
  return rows;
}

std::string ViewTable(const CameraCalibration& calibration) {
  std::string rows = TableRow({"picture", "corners", "tilt, degrees", "error, px"}, "th");
  for (const CalibrationView& view : calibration.views) {
    rows +=
        TableRow({view.view.image_name, fmt::format("{}", view.view.corners_in_image_px.size()),
                  fmt::format("{:.0f}", view.view.tilt_deg),
                  view.is_used ? fmt::format("{:.3f}", view.error_px) : std::string("left out")});
  }
  return rows;
}

std::string PlaceholderHtml(std::string_view name, const CameraCalibration& calibration,
                            const CalibrationSource& source, const ResidualDrawing& residuals) {
  const Camera& camera = calibration.camera.camera;
  if (name == "STYLE") return std::string(kReportStyle);
  if (name == "TITLE") {
    return EscapeForMarkup(fmt::format("{} from {}", source.camera_file, source.pictures));
  }
  if (name == "ORIGIN") {
    return EscapeForMarkup(fmt::format("{}, {} x {} px, {}", DateText(OutputDate()),
                                       camera.width_px, camera.height_px, source.board));
  }
  if (name == "VERDICT") return VerdictHtml(JudgeCalibration(calibration));
  if (name == "PARAMETERS") return ParameterTable(calibration.camera);
  if (name == "MORE") {
    const std::vector<std::string> advice = AdvisedViews(calibration);
    return advice.empty() ? "<p>Nothing is missing.</p>" : BulletList(advice);
  }
  if (name == "COVERAGE") return DrawCoverage(calibration);
  if (name == "RESIDUALS") return residuals.svg;
  if (name == "RESIDUALS_CAPTION") {
    return fmt::format(
        "Residuals of the corners: {:.3f} px (RMS). Grey dots: single corners; larger dots are "
        "worse. Red: the mean over each part of the picture, drawn {:.0f} times as long. Arrows "
        "that point in all directions are noise; arrows in a pattern show a lens that the camera "
        "model does not describe.",
        calibration.error_px.rms, residuals.magnification);
  }
  if (name == "MODELS") return ModelTable(calibration);
  if (name == "BOARD") return EscapeForMarkup("The board is " + DescribeBoard(calibration.board));
  if (name == "VIEWS_CAPTION") {
    return fmt::format(
        "{} of the {} pictures that show the board were used; {} of their corners were left out "
        "as outliers.",
        calibration.UsedViews().size(), calibration.num_images, calibration.num_outliers);
  }
  if (name == "VIEWS") return ViewTable(calibration);
  throw std::logic_error("calibration.html has an unknown placeholder: " + std::string(name));
}

}  // namespace

void WriteCalibrationPage(const CameraCalibration& calibration, const CalibrationSource& source,
                          std::ostream& out) {
  const ResidualDrawing residuals = DrawResiduals(calibration);
  WriteHtmlPage(
      kCalibrationPage,
      [&](std::string_view name) { return PlaceholderHtml(name, calibration, source, residuals); },
      out);
}

}  // namespace velamap
