#include "workflows/run/central_frame_sweep.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <ostream>
#include <set>
#include <sstream>
#include <tuple>

#include <fmt/format.h>

#include "exporters/formats/shape_csv.h"
#include "exporters/report/verdict.h"
#include "exporters/shape_exporter.h"
#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/numbers.h"
#include "importer/base/replacement.h"
#include "importer/database/colmap_database.h"
#include "importer/text/csv.h"
#include "reconstruct/colmap/warm_start.h"
#include "reconstruct/seed_model.h"
#include "reconstruct/thesis/thesis_registration.h"
#include "workflows/run/logging.h"
#include "workflows/run/pipeline.h"
#include "workflows/run/report_input.h"
#include "workflows/run/version.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

std::string NameOf(const DatabaseImage& image) {
  const FrameDetections& frame = image.detections;
  return frame.frame_number ? std::to_string(*frame.frame_number) : frame.image_name;
}

[[noreturn]] void ThrowBadChoice(const std::string& choice, const std::string& what) {
  throw InputError(fmt::format(
      "--central_frames '{}': {}; give all, every:N, or names or frame numbers with commas", choice,
      what));
}

std::vector<int> ChooseEvery(const std::string& choice, const std::string& count,
                             const PosedImages& posed) {
  int step = 0;
  if (!ParseNumber(count, &step) || step < 1) {
    ThrowBadChoice(choice, fmt::format("'{}' is not a count of 1 or more", count));
  }
  std::vector<int> chosen;
  const auto number = [&posed](int idx) {
    return posed.images[static_cast<std::size_t>(idx)]->detections.frame_number.value_or(idx);
  };
  for (int idx = 0; idx < static_cast<int>(posed.images.size()); ++idx) {
    if ((number(idx) - number(0)) % step == 0) chosen.push_back(idx);
  }
  return chosen;
}

std::vector<int> ChooseListed(const std::string& choice, const PosedImages& posed) {
  std::set<int> chosen;
  std::istringstream list(choice);
  for (std::string name; std::getline(list, name, ',');) {
    const auto known =
        std::find_if(posed.images.begin(), posed.images.end(), [&name](const DatabaseImage* image) {
          return image->detections.image_name == name || NameOf(*image) == name;
        });
    if (known == posed.images.end()) {
      ThrowBadChoice(choice, fmt::format("no image '{}' holds markers", name));
    }
    chosen.insert(static_cast<int>(known - posed.images.begin()));
  }
  return {chosen.begin(), chosen.end()};
}

// The name of the folder for an image: without its extension, unless another image would have the
// same folder or one in it.
fs::path ModelFolderOf(const std::string& image_name, const PosedImages& posed) {
  const fs::path folder = fs::path(image_name).replace_extension();
  const auto is_in_folder = [&](const DatabaseImage* image) {
    const std::string& name = image->detections.image_name;
    const fs::path other = fs::path(name).replace_extension();
    return name != image_name &&
           std::mismatch(folder.begin(), folder.end(), other.begin(), other.end()).first ==
               folder.end();
  };
  const bool is_shared = std::any_of(posed.images.begin(), posed.images.end(), is_in_folder);
  return is_shared ? fs::path(image_name) : folder;
}

// What all central frames share.
class Sweep {
 public:
  Sweep(const CentralFrameSweepOptions& options, const Layout& layout)
      : options_(options), layout_(layout) {
    const ColmapDatabase database(options.database_path, ColmapDatabase::Mode::kReadOnly);
    CheckLayoutOfDatabase(database, options.database_path, layout);
    images_ = database.ReadImages();
    if (!database.HasCalibration()) {
      throw InputError(fmt::format(
          "{}: was made without a calibration, which a sweep needs; import with one, such as the "
          "camera.yml that automatic_reconstructor finds",
          options.database_path));
    }
    cameras_ = database.ReadCameras();
    posed_ = PoseImages(images_, cameras_, layout, options.registration.num_threads);
    corner_errors_ = CornerErrorsOf(images_, database.ReadFormation());
    num_shared_warnings_ = LoggedWarnings().size();
  }

  const PosedImages& posed() const { return posed_; }

  // Throws InputError if a folder for a model holds what velamap did not write.
  void CheckModelFolders(const std::vector<int>& central_frames) const {
    if (options_.models_path.empty()) return;
    for (const int frame_idx : central_frames) {
      const DatabaseImage& image = *posed_.images[static_cast<std::size_t>(frame_idx)];
      CheckReplaceableFolder(fs::path(options_.models_path) /
                             ModelFolderOf(image.detections.image_name, posed_));
    }
  }

  SweepRow Run(int frame_idx) {
    const DatabaseImage& image = *posed_.images[static_cast<std::size_t>(frame_idx)];
    SweepRow row;
    row.central_frame = NameOf(image);
    row.image_name = image.detections.image_name;
    StageClock clock;
    try {
      CheckMarkers(image);
      Reconstruct(&row);
    } catch (const DataError& error) {
      row.reason = error.what();
      adjusted_.reset();
    }
    clock.End("");
    row.wall_s = clock.Times().front().wall_s;
    row.cpu_s = clock.Times().front().cpu_s;
    return row;
  }

 private:
  void CheckMarkers(const DatabaseImage& image) const {
    const int num_needed = options_.registration.min_num_inliers;
    if (static_cast<int>(image.detections.markers.size()) >= num_needed) return;
    throw DataError(fmt::format("holds {} markers; {} are needed", image.detections.markers.size(),
                                num_needed));
  }

  void Reconstruct(SweepRow* row) {
    const std::size_t num_warnings = LoggedWarnings().size();
    RegistrationOptions registration_options = options_.registration;
    registration_options.central_frame = row->image_name;
    const Registration registration =
        RegisterAroundCentralFrame(posed_, layout_, registration_options);
    Model model = MakeSeedModel(registration, images_, cameras_);
    if (options_.warm_start && adjusted_) {
      row->is_warm = StartFromAdjusted(*adjusted_, &model).num_points > 0;
    }
    AdjustmentResult result =
        AdjustModel(options_.adjustment, layout_, corner_errors_, options_.log_path, &model);
    adjusted_ = model;
    const ShapeExportReport report =
        MeasureShape(model, layout_, FrameChoice{FrameKind::kCamera}, options_.scale_by,
                     result.uncertainty ? &*result.uncertainty : nullptr);
    row->shape = report.metrics;
    row->model = report.model_metrics;
    row->num_images = static_cast<int>(model.images.size());
    if (options_.models_path.empty()) return;
    result.uncertainty = report.uncertainty;  // in the frame of the metric model
    Write(*row, report, result, Judge(report, result.steadiness, num_warnings));
  }

  // The verdict on one central frame. The log also holds the warnings of earlier central frames, so
  // only those that all frames share count, and this frame's own, which begin at `first_own`.
  Verdict Judge(const ShapeExportReport& report, const SteadinessVerdict& steadiness,
                std::size_t first_own) const {
    ReportInput input = MakeReportInput(report, layout_, steadiness);
    input.warnings = LoggedWarnings();
    const auto begin = input.warnings.begin();
    input.warnings.erase(begin + static_cast<std::ptrdiff_t>(num_shared_warnings_),
                         begin + static_cast<std::ptrdiff_t>(first_own));
    return MakeVerdict(input);
  }

  void Write(const SweepRow& row, const ShapeExportReport& report, const AdjustmentResult& result,
             const Verdict& verdict) const {
    AtomicFolder folder(fs::path(options_.models_path) / ModelFolderOf(row.image_name, posed_));
    const fs::path path = folder.TemporaryPath();
    WriteAdjustedModel(report.metric_model, result, (path / "sparse").string());
    WriteFile(path / "shape.csv", [&](std::ostream& out) { WriteShapeCsv(report.shape, out); });
    const DescribedFiles files = DescribeShapeFiles(path, LengthUnit::kMetre);
    WriteFile(path / "shape.json", [&](std::ostream& out) {
      WriteShapeJson(report.frame, report.metric_model, report.metrics.num_markers,
                     {kVersion, {}, {}}, &verdict, files, out);
    });
    folder.Commit();
  }

  const CentralFrameSweepOptions& options_;
  const Layout& layout_;
  std::vector<DatabaseImage> images_;
  std::map<CameraId, Camera> cameras_;
  PosedImages posed_;
  CornerErrors corner_errors_;
  std::size_t num_shared_warnings_ = 0;  // of the log, before the first central frame
  std::optional<Model> adjusted_;        // around the previous central frame
};

double Completeness(const SweepRow& row) {
  return row.shape.reconstruction_ratio.value_or(row.shape.num_markers);
}

}  // namespace

std::vector<int> ChooseCentralFrames(const std::string& choice, const PosedImages& posed) {
  const std::string every = "every:";
  if (choice == "all") return ChooseEvery(choice, "1", posed);
  if (choice.rfind(every, 0) == 0) return ChooseEvery(choice, choice.substr(every.size()), posed);
  const std::vector<int> chosen = ChooseListed(choice, posed);
  if (chosen.empty()) ThrowBadChoice(choice, "names no frame");
  return chosen;
}

std::vector<SweepRow> SweepCentralFrames(const CentralFrameSweepOptions& options,
                                         const Layout& layout, StageClock* clock,
                                         const std::function<void(int done, int total)>& done) {
  if (options.registration.method != RegistrationMethod::kThesis) {
    throw InputError(OptionName(&RegistrationOptions::method) +
                     " global: has no central frame to sweep; give thesis");
  }
  options.registration.Check();
  Sweep sweep(options, layout);
  const std::vector<int> central_frames =
      ChooseCentralFrames(options.central_frames, sweep.posed());
  if (central_frames.empty()) {
    throw DataError(fmt::format("{}: holds no image with markers; import a clip that shows some",
                                options.database_path));
  }
  sweep.CheckModelFolders(central_frames);
  clock->End("read", static_cast<int>(sweep.posed().images.size()));
  std::vector<SweepRow> rows;
  for (const int frame_idx : central_frames) {
    rows.push_back(sweep.Run(frame_idx));
    done(static_cast<int>(rows.size()), static_cast<int>(central_frames.size()));
  }
  clock->End("sweep", static_cast<int>(rows.size()));
  return rows;
}

int BestRow(const std::vector<SweepRow>& rows) {
  const auto rank = [](const SweepRow& row) {
    return std::tuple(row.reason.empty(), Completeness(row), -row.shape.area_error_mm2.mean);
  };
  const auto best =
      std::max_element(rows.begin(), rows.end(),
                       [&](const SweepRow& a, const SweepRow& b) { return rank(a) < rank(b); });
  if (best == rows.end() || !best->reason.empty()) return -1;
  return static_cast<int>(best - rows.begin());
}

void WriteSweepCsv(const std::vector<SweepRow>& rows, std::ostream& out) {
  CsvWriter csv(out);
  csv.WriteRecord("central_frame", "image_name", "num_images", "num_markers",
                  "reconstruction_ratio", "reprojection_error_px_mean",
                  "central_reprojection_error_px_mean", "area_error_mm2_mean", "area_error_mm2_max",
                  "area_error_percent_mean", "start", "wall_s", "cpu_s", "reason");
  const auto six_digits = [](double value) { return fmt::format("{:.6g}", value); };
  for (const SweepRow& row : rows) {
    const ShapeMetrics& shape = row.shape;
    csv.AddField(row.central_frame);
    csv.AddField(row.image_name);
    if (row.reason.empty()) {
      const auto& ratio = shape.reconstruction_ratio;
      csv.AddField(row.num_images);
      csv.AddField(shape.num_markers);
      csv.AddField(ratio ? six_digits(*ratio) : "");
      csv.AddField(six_digits(row.model.error_px.mean));
      csv.AddField(six_digits(row.model.central_error_px.mean));
      csv.AddField(six_digits(shape.area_error_mm2.mean));
      csv.AddField(six_digits(shape.area_error_mm2.max));
      csv.AddField(six_digits(shape.area_error_percent.mean));
      csv.AddField(row.is_warm ? "warm" : "cold");
    } else {
      constexpr int kNumFigures = 9;
      for (int i = 0; i < kNumFigures; ++i) csv.AddField("");
    }
    csv.WriteRecord(fmt::format("{:.3f}", row.wall_s), fmt::format("{:.3f}", row.cpu_s),
                    row.reason);
  }
}

}  // namespace velamap
