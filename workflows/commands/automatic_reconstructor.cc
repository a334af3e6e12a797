#include <filesystem>
#include <iostream>
#include <map>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "exporters/report/report_sail.h"
#include "exporters/report/report_writer.h"
#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/log.h"
#include "importer/base/replacement.h"
#include "importer/camera/calibration_writer.h"
#include "importer/text/output_date.h"
#include "importer/text/shown_text.h"
#include "importer/text/text_file.h"
#include "reconstruct/model/model_io.h"
#include "reconstruct/seed_model.h"
#include "workflows/commands/commands.h"
#include "workflows/commands/report_design.h"
#include "workflows/options/option_effects.h"
#include "workflows/options/sail_options.h"
#include "workflows/options/shared_options.h"
#include "workflows/run/adjustment.h"
#include "workflows/run/logging.h"
#include "workflows/run/pipeline.h"
#include "workflows/run/report_input.h"
#include "workflows/run/run_summary.h"
#include "workflows/run/stage_times.h"
#include "workflows/run/summary.h"
#include "workflows/run/version.h"
#include "workflows/run/versions.h"
#include "workflows/run/workspace.h"

namespace velamap {
namespace {

struct AutomaticReconstructorCommandOptions : CommandOptions {
  MarkerImporterOptions importer;
  RegistrationOptions registration;
  AdjustmentOptions adjustment;
  ShapeExporterOptions exporter;
  SurfaceFileOptions surface;
  DesignOptions design;
  bool full_paths = false;
  SummaryFormat summary = SummaryFormat::kText;
};

CommandSyntax Declare(AutomaticReconstructorCommandOptions* options) {
  PathOptions* paths = &options->paths;
  CommandSyntax syntax = {
      "automatic_reconstructor",
      "photographs or a video of markers in, a workspace with the metric shape out",
      "--image_path photos --camera_path camera.yml --layout_path layout.yml \\\n"
      "    --workspace_path result",
      {{"Input and output",
        {ImagePathOption(paths), CameraPathOption(paths), PriorShapePathOption(paths),
         Required(PathOption(
             "workspace_path", PathUse::kWritesWorkspace, &paths->workspace_path,
             "folder of the result: new, empty, or of an earlier run, whose detections are kept")),
         ImportAnewOption(&options->importer), BackendOption(&options->adjustment.backend),
         PresetOption(&options->preset)}},
       DescribeOptions(&options->markers, true),
       DescribeOptions(&options->importer.detection),
       DescribeOptions(&options->importer.video),
       DescribeOptions(&options->registration),
       DescribeOptions(&options->adjustment.colmap),
       DescribeOptions(&options->adjustment.markers)}};
  for (const OptionGroup& group : SailGroups(&options->exporter, &options->surface)) {
    syntax.groups.push_back(group);
  }
  syntax.groups.push_back(DescribeOptions(&options->design));
  syntax.preset = &options->preset;
  syntax.groups.push_back(DescribeOptions(&options->general));
  syntax.groups.back().options.push_back({"full_paths", &options->full_paths, "0|1",
                                          "1: log and report name files with their folders; 0: "
                                          "without, so that they can be shared"});
  syntax.groups.back().options.push_back(ChoiceOption(
      "summary", &options->summary,
      {{SummaryFormat::kText, "text"}, {SummaryFormat::kJson, "json"}},
      "what is printed at the end: text for people, or json with all figures for programs"));
  return syntax;
}

// Checks everything that can be checked without touching the workspace.
void Validate(AutomaticReconstructorCommandOptions* options) {
  ShowFolders(options->full_paths);
  RefuseVideoOptions(*options);
  RefuseOptionsOfOtherBackend(options->typed, options->adjustment.backend);
  RefuseOptionsOfOtherMethod(options->typed, options->registration.method);
  CompleteRegistration(options->general, &options->registration);
  if (options->paths.camera_path.empty()) {
    if (!options->adjustment.UsesMarkers()) {
      throw InputError(
          "--camera_path: missing; --backend colmap cannot adjust an unknown camera: give a "
          "calibration, or --backend both or markers");
    }
    RefuseFixedCameraWithoutCalibration(options->typed, options->adjustment.markers,
                                        "--camera_path is missing");
    options->adjustment.markers.find_camera = true;
    RefuseOptionsOfKnownCamera(options->typed);
    CheckOwnFile("--workspace_path",
                 WorkspacePaths{AbsoluteFolder(options->paths.workspace_path)}.Camera());
  }
  options->adjustment.Complete(options->general.num_threads);
  CompleteSailOptions(options->surface, &options->exporter);
  options->exporter.num_threads = options->general.num_threads;
  CompleteImporter(*options, &options->importer);
  RefuseSailOptions(options->typed, options->importer.layout);
  CheckDesign(options->design, options->typed);
  CheckFrameChoice(options->exporter.frame, options->importer.layout);
  options->importer.allowed_frames = options->importer.video;
  options->importer.video = NarrowToReach(options->importer.video, options->registration);
  if (options->adjustment.UsesColmap()) CheckColmap(options->adjustment.colmap.colmap_path);
}

ImportReport Import(MarkerImporterOptions options, Workspace* workspace,
                    std::vector<ReportLeftOut>* unreadable) {
  options.database_path = workspace->paths().Database().string();
  options.frame_output_path = workspace->paths().Images().string();
  options.is_only_source = true;
  ImportReport report = ImportImages(options);
  workspace->Keep();
  for (const SkippedImage& skipped : report.skipped) {
    unreadable->push_back({skipped.image_name, skipped.reason});
  }
  return report;
}

// The video, or the folder of photographs without a trailing slash, whose name would be empty.
std::filesystem::path Source(const AutomaticReconstructorCommandOptions& options) {
  return AbsoluteFolder(options.paths.image_path);
}

ShapeOrigin OriginOf(const AutomaticReconstructorCommandOptions& options,
                     const AdjustmentResult& adjustment) {
  const std::filesystem::path source = Source(options);
  return {kVersion, (options.full_paths ? source : source.filename()).string(),
          !adjustment.cameras.empty()};
}

// Logs everything that contradicts the shape. The input refers to `summary`; `design` may be null.
ReportInput JudgedInput(const AutomaticReconstructorCommandOptions& options,
                        const WorkspacePaths& paths, const SeedResult& seed,
                        const MeshDistance* design, const ReconstructionSummary& summary) {
  const ShapeExportReport& shape = summary.shape;
  WarnOfOtherMarkers(shape.metrics);
  WarnOfMissingSections(shape.sail.sections);
  ReportInput input =
      MakeReportInput(shape, options.importer.layout, summary.adjustment.steadiness);
  input.title = ReportTitle(Source(options));
  input.version = kVersion;
  input.created = DateText(OutputDate());
  input.image_path = paths.Images().string();
  input.frame = MakeReportFrame(shape.frame, shape.metric_model);
  for (const std::string& note : SurfaceNotes(shape)) LogInfo("surface of {}", note);
  input.clip = seed.clip;
  input.images_left_out = summary.images_left_out;
  input.images_not_needed = summary.images_not_needed;
  input.markers_left_out = NamedById(summary.dropped_markers);
  input.num_ids_found = seed.num_ids_found;
  for (const auto& [camera_id, camera] : summary.adjustment.cameras) {
    input.found_cameras.push_back(camera);
  }
  input.warnings = WarningsBeforeContradictions(shape);
  if (design != nullptr) {  // after the warnings: the verdict is on the shape alone
    AddDesign(options.design, *design, shape, options.importer.layout,
              options.exporter.sail.sections, &input);
  }
  input.options = TypedOptions(options.arguments);
  input.versions = LibraryVersions(options.adjustment.colmap.colmap_path);
  LeaveFoldersOut(&input);
  return input;
}

constexpr char kFoundBy[] = "found by velamap";

// Removes the camera that an earlier run has found: this run used a calibration, so its result does
// not have that camera. A file that the user has put there stays.
void RemoveFoundCamera(const std::string& camera_path, const WorkspacePaths& paths) {
  const std::filesystem::path file = paths.Camera();
  if (CanonicalPath(camera_path) == CanonicalPath(file) || !IsOwnFile(file)) return;
  const bool is_found = ReadTextFile(file.string(), "camera").find(kFoundBy) != std::string::npos;
  if (is_found) RemoveFileOrEmptyFolder(file);
}

// Writes the camera that was found, so that it can be used for the next clip. If there are several,
// writes the one with the most images.
void WriteFoundCamera(const AdjustmentResult& adjustment, const Model& model,
                      const WorkspacePaths& paths) {
  std::map<CameraId, int> num_images;
  for (const ModelImage& image : model.images) ++num_images[image.camera_id];
  const EstimatedCamera* most_used = nullptr;
  int most = 0;
  for (const auto& [camera_id, camera] : adjustment.cameras) {
    if (num_images[camera_id] <= most) continue;
    most = num_images[camera_id];
    most_used = &camera;
  }
  if (most_used == nullptr) return;
  WriteCalibration(*most_used,
                   fmt::format("{} {} from {} images of markers", kFoundBy, kVersion, most),
                   paths.Camera().string());
}

// Makes the final files from the seed. sparse/ and shape/ replace the old ones when both are
// complete.
void AdjustAndExport(const AutomaticReconstructorCommandOptions& options,
                     const WorkspacePaths& paths, const SeedResult& seed,
                     const MeshDistance* design, ReconstructionSummary* summary,
                     StageClock* clock) {
  AtomicFolder sparse(paths.Sparse());
  WriteModel(seed.model, (sparse.TemporaryPath() / "seed").string(), ModelFormat::kBinaryAndText);
  Model model = seed.model;
  summary->adjustment = AdjustModel(options.adjustment, options.importer.layout, seed.corner_errors,
                                    paths.ColmapLog().string(), &model);
  clock->End("adjust", static_cast<int>(model.images.size()));
  AddModelImages(model, options.paths.image_path, paths.Images());
  const auto& uncertainty = summary->adjustment.uncertainty;
  ShapeExporterOptions exporter = options.exporter;
  exporter.model_output_path = (sparse.TemporaryPath() / "0").string();
  exporter.shape_output_path = paths.Shape().string();
  exporter.origin = OriginOf(options, summary->adjustment);
  summary->shape =
      ComputeShape(model, options.importer.layout, exporter, uncertainty ? &*uncertainty : nullptr);
  summary->shape.ThrowSurfaceErrorBeforeReplacing({paths.Sparse(), paths.Shape(), paths.Report()});
  const ReportInput input = JudgedInput(options, paths, seed, design, *summary);
  summary->verdict = MakeVerdict(input);
  WriteShape(summary->shape, exporter, &summary->verdict);
  sparse.Commit();
  if (options.paths.camera_path.empty()) {
    WriteFoundCamera(summary->adjustment, model, paths);
  } else {
    RemoveFoundCamera(options.paths.camera_path, paths);
  }
  WriteFileAtomically(paths.RegistrationCsv(),
                      [&seed](std::ostream& out) { WriteRegistrationCsv(seed.registration, out); });
  clock->End("export");
  WriteSealedPage(paths.Report(), [&input](std::ostream& out) { WriteReport(input, out); });
  clock->End("report");
  RemoveOtherImages(model, seed.image_names, options.paths.image_path, paths.Images());
  summary->num_images = static_cast<int>(model.images.size());
}

void WriteTimes(const StageClock& clock, const WorkspacePaths& paths) {
  LogStageTimes(clock);
  WriteFileAtomically(paths.Timing(),
                      [&clock](std::ostream& out) { WriteStageTimesJson(clock.Times(), out); });
}

void Run(const AutomaticReconstructorCommandOptions& options) {
  const std::unique_ptr<MeshDistance> design = ReadDesign(options.design);
  Workspace workspace(options.paths.workspace_path, options.paths.image_path);
  const WorkspacePaths& paths = workspace.paths();
  AddLogFile(paths.Log().string());
  LogInfo("velamap {} automatic_reconstructor {}", kVersion, fmt::join(options.arguments, " "));
  LogPreset(options.preset);

  ReconstructionSummary summary;
  StageClock clock;
  const ImportReport import = Import(options.importer, &workspace, &summary.images_left_out);
  clock.EndImport(import.times, import.num_frames_read);
  const SeedResult seed = RegisterDatabase(paths.Database().string(), options.importer.layout,
                                           options.registration, options.adjustment.markers);
  clock.End("register", static_cast<int>(seed.image_names.size()));
  summary.num_images_total =
      static_cast<int>(seed.image_names.size() + summary.images_left_out.size());
  summary.dropped_markers = seed.registration.dropped_markers;
  summary.images_left_out.insert(summary.images_left_out.end(), seed.left_out.begin(),
                                 seed.left_out.end());
  summary.images_not_needed = seed.not_needed;
  AdjustAndExport(options, paths, seed, design.get(), &summary, &clock);
  WriteTimes(clock, paths);
  summary.shape.ThrowSurfaceError();
  if (options.summary == SummaryFormat::kJson) {
    WriteMetricsJson(SummaryMetrics(summary, paths), std::cout);
  } else {
    PrintSummary(summary, paths, std::cout);
  }
}

}  // namespace

Command AutomaticReconstructor() {
  return MakeCommand<AutomaticReconstructorCommandOptions>(Declare, Validate, Run);
}

}  // namespace velamap
