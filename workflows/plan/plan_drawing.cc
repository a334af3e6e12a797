#include "workflows/plan/plan_drawing.h"

#include <algorithm>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "workflows/plan/plan_writer.h"

namespace velamap {
namespace {

constexpr Color kInk = {0.12, 0.12, 0.12}, kGray = {0.45, 0.45, 0.45}, kPath = {0.10, 0.30, 0.55},
                kMissing = {0.75, 0.75, 0.75};
constexpr double kWidth_mm = 230.0, kHeight_mm = 150.0, kBorder_mm = 10.0;
constexpr double kTitle_mm = 4.5, kWords_mm = 3.2;

// A rectangle of the page that shows two axes of space in one scale.
class Panel {
 public:
  Panel(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm,
        const std::vector<Eigen::Vector2d>& points_m) {
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& point : points_m) box.extend(point);
    const Eigen::Vector2d size = box.sizes().cwiseMax(1e-6), middle = box.center();
    mm_per_m_ = ((max_mm - min_mm).array() / size.array()).minCoeff();
    origin_mm_ = 0.5 * (min_mm + max_mm) - mm_per_m_ * Eigen::Vector2d(middle.x(), -middle.y());
  }
  // `point_m`: right and up.
  Eigen::Vector2d operator()(const Eigen::Vector2d& point_m) const {
    return origin_mm_ + mm_per_m_ * Eigen::Vector2d(point_m.x(), -point_m.y());
  }

 private:
  double mm_per_m_ = 1.0;
  Eigen::Vector2d origin_mm_ = Eigen::Vector2d::Zero();
};

std::vector<Eigen::Vector2d> Square(const Eigen::Vector2d& middle_mm, double half_mm) {
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(half_mm);
  return RectangleOutline(middle_mm - reach, middle_mm + reach);
}

// Below the panel between these corners, in its middle.
void AddCaption(const std::string& text, const Eigen::Vector2d& min_mm,
                const Eigen::Vector2d& max_mm, const Color& color, Drawing* page) {
  page->texts.push_back({text,
                         {0.5 * (min_mm.x() + max_mm.x()), max_mm.y() + 6},
                         kWords_mm,
                         TextAnchor::kMiddle,
                         false,
                         color});
}

Eigen::Vector2d FromAbove(const Eigen::Vector3d& x) { return x.head<2>(); }
Eigen::Vector2d FromAhead(const Eigen::Vector3d& x) { return {x.x(), x.z()}; }

void DrawFromAbove(const ShootPlan& plan, const Eigen::Vector2d& min_mm,
                   const Eigen::Vector2d& max_mm, Drawing* page) {
  std::vector<Eigen::Vector2d> cameras;
  for (const double angle_deg : AnglesOf(plan.path)) {
    const Rigid3 cam_from_plan = CameraAt(plan.surface, plan.path, angle_deg);
    cameras.push_back(FromAbove(Inverse(cam_from_plan).translation));
  }
  std::vector<Eigen::Vector2d> all = cameras;
  for (const ShapeMarker& marker : plan.surface.shape.markers) {
    all.push_back(FromAbove(*marker.x_in_shape_m[0]));
  }
  const Panel panel(min_mm, max_mm, all);
  const Eigen::Vector2d target_mm = panel({0, 0});
  for (const Eigen::Vector2d& end : {cameras.front(), cameras.back()}) {
    page->strokes.push_back({{target_mm, panel(end)}, 0.2, kGray, false, true});
  }
  Stroke path{{}, 0.4, kPath};
  for (const Eigen::Vector2d& camera : cameras) {
    path.points_mm.push_back(panel(camera));
    page->areas.push_back({{Square(panel(camera), 0.7)}, kPath});
  }
  page->strokes.push_back(path);
  for (const ShapeMarker& marker : plan.surface.shape.markers) {
    page->strokes.push_back(
        {{panel(FromAbove(0.5 * (*marker.x_in_shape_m[1] + *marker.x_in_shape_m[4]))),
          panel(FromAbove(0.5 * (*marker.x_in_shape_m[2] + *marker.x_in_shape_m[3])))},
         0.5,
         kInk});
  }
  AddCaption(fmt::format("{:.4g} m, {:.0f} degrees, {} views", plan.path.distance_m,
                         plan.path.arc_deg, plan.path.num_views),
             min_mm, max_mm, kPath, page);
}

// From blue, the least sigma, to red, the greatest.
Color SigmaColor(double part) {
  return {0.15 + 0.7 * part, 0.35 * (1 - part) + 0.15, 0.85 - 0.7 * part};
}

void DrawFromAhead(const ShootPlan& plan, const Eigen::Vector2d& min_mm,
                   const Eigen::Vector2d& max_mm, Drawing* page) {
  std::vector<Eigen::Vector2d> corners;
  for (const ShapeMarker& marker : plan.surface.shape.markers) {
    for (std::size_t i = 1; i <= kNumCorners; ++i) {
      corners.push_back(FromAhead(*marker.x_in_shape_m[i]));
    }
  }
  const Panel panel(min_mm, max_mm, corners);
  const auto& precision = plan.plan().precision;
  double least = 0.0, most = 0.0;
  if (precision) {
    const auto [low, high] =
        std::minmax_element(precision->marker_sigma_mm.begin(), precision->marker_sigma_mm.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; });
    least = low->second;
    most = high->second;
  }
  for (std::size_t i = 0; i < plan.surface.shape.markers.size(); ++i) {
    FilledArea area{{{}}, kMissing};
    for (std::size_t c = 0; c < kNumCorners; ++c) {
      area.outlines_mm.front().push_back(panel(corners[kNumCorners * i + c]));
    }
    const int id = plan.surface.shape.markers[i].marker_id;
    if (precision && precision->marker_sigma_mm.count(id) > 0) {
      const double sigma = precision->marker_sigma_mm.at(id);
      area.color = SigmaColor(most > least ? (sigma - least) / (most - least) : 0.0);
    }
    page->areas.push_back(area);
  }
  const std::string legend =
      precision
          ? fmt::format("1 sigma of the markers: {:.2g} mm (blue) to {:.2g} mm (red)", least, most)
          : "these views give no shape";
  AddCaption(legend, min_mm, max_mm, kGray, page);
}

}  // namespace

Drawing DrawPlan(const ShootPlan& plan) {
  Drawing page;
  page.width_mm = kWidth_mm;
  page.height_mm = kHeight_mm;
  page.texts.push_back({"Plan of the shoot",
                        {kBorder_mm, kBorder_mm + kTitle_mm},
                        kTitle_mm,
                        TextAnchor::kStart,
                        true,
                        kInk});
  page.texts.push_back({RecommendationText(plan),
                        {kBorder_mm, kBorder_mm + kTitle_mm + 6},
                        kWords_mm,
                        TextAnchor::kStart,
                        false,
                        kInk,
                        kWidth_mm - 2 * kBorder_mm});
  const double top_mm = kBorder_mm + kTitle_mm + 14, bottom_mm = kHeight_mm - kBorder_mm - 8;
  const double middle_mm = 0.5 * kWidth_mm;
  DrawFromAbove(plan, {kBorder_mm, top_mm}, {middle_mm - 5, bottom_mm}, &page);
  DrawFromAhead(plan, {middle_mm + 5, top_mm}, {kWidth_mm - kBorder_mm, bottom_mm}, &page);
  return page;
}

}  // namespace velamap
