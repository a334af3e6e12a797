#include <iostream>

#include <fmt/format.h>

#include "importer/base/atomic_output.h"
#include "reconstruct/model/model_io.h"
#include "reconstruct/model/reprojection.h"
#include "reconstruct/seed_model.h"
#include "workflows/commands/commands.h"
#include "workflows/options/option_effects.h"
#include "workflows/options/shared_options.h"
#include "workflows/run/pipeline.h"
#include "workflows/run/stage_times.h"
#include "workflows/run/summary.h"

namespace velamap {
namespace {

struct FrameRegistratorCommandOptions : CommandOptions {
  RegistrationOptions registration;
};

CommandSyntax Declare(FrameRegistratorCommandOptions* options) {
  PathOptions* paths = &options->paths;
  return {"frame_registrator",
          "finds where the camera was for each image; writes the seed model for bundle_adjuster",
          "--database_path database.db --layout_path layout.yml --output_path sparse/seed",
          {{"Input and output",
            {DatabaseInputOption(paths),
             Required(PathOption("output_path", PathUse::kWritesFolder, &paths->output_path,
                                 "folder of the seed model")),
             BesideIfLeftOut(
                 PathOption("registration_path", PathUse::kWritesFile, &paths->registration_path,
                            "table of all images, CSV; left out: registration.csv beside "
                            "output_path"),
                 &paths->output_path, "registration.csv"),
             PresetOption(&options->preset)}},
           DescribeOptions(&options->markers, false),
           DescribeOptions(&options->registration),
           DescribeOptions(&options->general)},
          &options->preset};
}

void Validate(FrameRegistratorCommandOptions* options) {
  LogPreset(options->preset);
  RefuseOptionsOfOtherMethod(options->typed, options->registration.method);
  CompleteRegistration(options->general, &options->registration);
}

void Print(const SeedResult& seed, const PathOptions& paths, std::ostream& out) {
  out << fmt::format("images_registered: {} of {}\n", seed.model.images.size(),
                     seed.image_names.size());
  out << fmt::format("images_left_out: {}\n", LeftOutText(seed.left_out));
  if (!seed.not_needed.empty()) {
    out << fmt::format("images_not_needed: {}\n", LeftOutText(seed.not_needed));
  }
  out << fmt::format("markers_left_out: {}\n",
                     LeftOutText(NamedById(seed.registration.dropped_markers), "marker"));
  out << fmt::format("central_image: {}\n", seed.registration.central_image_name);
  out << fmt::format("markers: {}\n", seed.registration.shape.size());
  out << fmt::format("reprojection_error_px: {}\n",
                     ErrorText(SummarizeReprojectionErrors(seed.model)));
  out << fmt::format("model_path: {}\n", paths.output_path);
  out << fmt::format("registration_path: {}\n", paths.registration_path);
}

void Run(const FrameRegistratorCommandOptions& options) {
  StageClock clock;
  const SeedResult seed = RegisterDatabase(
      options.paths.database_path, LoadLayout(options.markers, false), options.registration);
  clock.End("register", static_cast<int>(seed.image_names.size()));
  WriteModel(seed.model, options.paths.output_path, ModelFormat::kBinaryAndText);
  WriteFileAtomically(options.paths.registration_path,
                      [&seed](std::ostream& out) { WriteRegistrationCsv(seed.registration, out); });
  clock.End("export");
  LogStageTimes(clock);
  Print(seed, options.paths, std::cout);
}

}  // namespace

Command FrameRegistrator() {
  return MakeCommand<FrameRegistratorCommandOptions>(Declare, Validate, Run);
}

}  // namespace velamap
