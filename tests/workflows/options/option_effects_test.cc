#include "workflows/options/option_effects.h"

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"
#include "tests/workflows/run_velamap.h"

namespace velamap {
namespace {

TEST(OptionEffectsTest, RefusesNamesAndSections) {
  const TypedNames typed = {"Video.first_frame", "unit"};
  EXPECT_NO_THROW(RefuseOptionsWithoutEffect(typed, {"Videos.", "Video", "uni", "units"}, "so"));
  EXPECT_NO_THROW(RefuseOptionsWithoutEffect({}, {"Video.", "unit"}, "so"));
  ExpectThrows<InputError>(
      [&] {
        RefuseOptionsWithoutEffect(typed, {"x", "unit"}, "it is so");
      },
      {"--unit: it would change nothing, because it is so; leave it out"});
  ExpectThrows<InputError>([&] { RefuseOptionsWithoutEffect(typed, {"Video."}, "so"); },
                           {"--Video.first_frame: "});
}

TEST(OptionEffectsTest, PhotographsAreNoVideo) {
  const TempDir dir;
  WriteTextFile(dir / "clip.mp4", "video");
  for (const char* name :
       {"Video.frame_step", "frame_output_path", "ArucoDetection.full_search_interval",
        "MarkerAdjustment.rolling_shutter", "MarkerAdjustment.estimate_rolling_shutter"}) {
    CommandOptions options;
    options.typed = {name};
    options.paths.image_path = (dir / "clip.mp4").string();
    EXPECT_NO_THROW(RefuseVideoOptions(options));
    options.paths.image_path = dir.path().string();
    ExpectThrows<InputError>([&] { RefuseVideoOptions(options); }, {name, "photographs"});
  }
}

TEST(OptionEffectsTest, AnUnknownCameraIsRefinedWhateverTheOptions) {
  AdjustmentOptions options;
  std::vector<Option> all = DescribeOptions(&options.markers).options;
  for (const Option& option : DescribeOptions(&options.colmap).options) all.push_back(option);
  const auto is_refused = [](const Option& option) {
    try {
      RefuseOptionsOfKnownCamera({option.name});
      return false;
    } catch (const InputError&) {
      return true;
    }
  };
  EXPECT_EQ(std::count_if(all.begin(), all.end(), is_refused), 5);
}

TEST(OptionEffectsTest, EachBackendHasItsOptions) {
  const auto refuse = [](const std::string& name, AdjustmentBackend backend) {
    RefuseOptionsOfOtherBackend({name}, backend);
  };
  AdjustmentOptions options;
  for (const Option& option : DescribeOptions(&options.markers).options) {
    EXPECT_THROW(refuse(option.name, AdjustmentBackend::kColmap), InputError) << option.name;
    EXPECT_NO_THROW(refuse(option.name, AdjustmentBackend::kMarkers)) << option.name;
  }
  for (const Option& option : DescribeOptions(&options.colmap).options) {
    EXPECT_NO_THROW(refuse(option.name, AdjustmentBackend::kColmap)) << option.name;
    EXPECT_NO_THROW(refuse(option.name, AdjustmentBackend::kBoth)) << option.name;
  }
  EXPECT_THROW(refuse("BundleAdjustment.outlier_ratio", AdjustmentBackend::kMarkers), InputError);
  EXPECT_NO_THROW(refuse("BundleAdjustment.refine_focal_length", AdjustmentBackend::kMarkers));
  EXPECT_THROW(refuse("log_path", AdjustmentBackend::kMarkers), InputError);
  EXPECT_THROW(refuse("scale_by", AdjustmentBackend::kBoth), InputError);
  EXPECT_NO_THROW(refuse("scale_by", AdjustmentBackend::kColmap));
}

TEST(OptionEffectsTest, EachMethodHasItsOptions) {
  const auto refuse = [](const std::string& name, RegistrationMethod method) {
    RefuseOptionsOfOtherMethod({name}, method);
  };
  EXPECT_THROW(refuse("Registration.skip", RegistrationMethod::kGlobal), InputError);
  EXPECT_THROW(refuse("Registration.num_starts", RegistrationMethod::kThesis), InputError);
  EXPECT_NO_THROW(refuse("Registration.skip", RegistrationMethod::kThesis));
  EXPECT_NO_THROW(refuse("Registration.central_frame", RegistrationMethod::kGlobal));
}

TEST(OptionEffectsTest, AnUnknownCameraIsFound) {
  MarkerAdjustmentOptions adjustment;
  const TypedNames typed = {"MarkerAdjustment.find_camera"};
  EXPECT_NO_THROW(RefuseFixedCameraWithoutCalibration({}, adjustment, "none is there"));
  ExpectThrows<InputError>(
      [&] { RefuseFixedCameraWithoutCalibration(typed, adjustment, "none is there"); },
      {"--MarkerAdjustment.find_camera: 0 needs", "none is there"});
  adjustment.find_camera = true;
  EXPECT_NO_THROW(RefuseFixedCameraWithoutCalibration(typed, adjustment, "none is there"));
}

TEST(OptionEffectsTest, SectionsNeedLines) {
  Layout layout = MakeLayout("DICT_4X4_50", 0.1);
  for (const char* name : {"Section.heights", "Surface.luff_extension", "Surface.edges_path"}) {
    ExpectThrows<InputError>([&] { RefuseSailOptions({name}, layout); },
                             {name, "no part of the layout has horizontal lines"});
  }
  EXPECT_NO_THROW(RefuseSailOptions({"Surface.edge_length", "frame"}, layout));
  LayoutPart sail;
  sail.horizontal = {{"h1", {1, 2, 3}}};
  layout.parts = {sail};
  EXPECT_NO_THROW(RefuseSailOptions({"Section.heights"}, layout));
}

}  // namespace
}  // namespace velamap
