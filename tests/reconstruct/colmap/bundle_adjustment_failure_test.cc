// What AdjustWithColmap does when COLMAP fails or lies. Shell scripts stand in for it: their
// arguments are `bundle_adjuster -h`, or `bundle_adjuster --input_path $3 --output_path $5 ...`.

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "importer/base/error.h"
#include "reconstruct/colmap/bundle_adjustment.h"
#include "reconstruct/model/model_io.h"
#include "tests/reconstruct/sheet_model.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class FakeBundleAdjuster : public testing::Test {
 protected:
  static constexpr const char* kHelp =
      "--BundleAdjustment.refine_focal_length --BundleAdjustment.refine_principal_point "
      "--BundleAdjustment.refine_extra_params --BundleAdjustment.max_num_iterations "
      "--BundleAdjustment.function_tolerance";

  void SetUp() override { PerturbSeed(0.001, 1, &model_); }

  void Script(const std::string& body, const std::string& help = kHelp) {
    const fs::path path = dir_ / "fake_colmap";
    std::ofstream(path) << "#!/bin/sh\nif [ \"$2\" = -h ]; then echo '" << help << "'; exit 0; fi\n"
                        << body << "\n";
    fs::permissions(path, fs::perms::owner_all);
    options_.colmap_path = path;
  }

  std::string ErrorOf() {
    const std::string before = Bytes(model_);
    std::string message = "no error";
    try {
      AdjustWithColmap(options_, log_path_, &model_);
    } catch (const ExternalToolError& error) {
      message = error.what();
    }
    EXPECT_EQ(Bytes(model_), before);
    return message;
  }

  // The error for a program that gives `result` out, whatever comes in.
  std::string ErrorWithResult(const Model& result) {
    WriteModel(result, dir_ / "result", ModelFormat::kBinary);
    Script("cp '" + (dir_ / "result").string() + "'/* \"$5\"");
    return ErrorOf();
  }

  TempDir dir_;
  Model model_ = MakeSheetModel();
  BundleAdjustmentOptions options_;
  std::string log_path_ = dir_ / "colmap.log";
};

TEST_F(FakeBundleAdjuster, FailuresAreExternalToolErrors) {
  Script("echo 'ERROR: bad day'; exit 1");
  EXPECT_THAT(ErrorOf(), AllOf(HasSubstr("exited with status 1"), HasSubstr("ERROR: bad day"),
                               HasSubstr("bundle_adjuster --input_path"), HasSubstr(log_path_)));
  Script("kill -9 $$");
  EXPECT_THAT(ErrorOf(), AllOf(HasSubstr("killed by signal 9"), HasSubstr(log_path_)));
  options_.colmap_path = "velamap-no-such-program";
  EXPECT_THAT(ErrorOf(), HasSubstr("--colmap_path"));
}

TEST_F(FakeBundleAdjuster, ImplausibleFilesAreExternalToolErrors) {
  Script("true");
  EXPECT_THAT(ErrorOf(), AllOf(HasSubstr("implausible"), HasSubstr("holds no COLMAP model"),
                               HasSubstr(log_path_)));
  Script("for f in cameras images points3D; do echo garbage > \"$5\"/$f.bin; done");
  EXPECT_THAT(ErrorOf(), AllOf(HasSubstr("implausible"), HasSubstr("cameras.bin")));
}

TEST_F(FakeBundleAdjuster, ImplausibleModelsAreExternalToolErrors) {
  Model result = model_;
  RemoveShortTracks(&result, 100);
  EXPECT_THAT(ErrorWithResult(result), HasSubstr("0 of 80 points came back"));

  result = model_;
  for (int i = 0; i < 8; ++i) RemoveObservation(&result, 11, result.points3D.at(11).track[0]);
  EXPECT_THAT(ErrorWithResult(result), HasSubstr("point 11 or some of its observations are lost"));

  result = model_;
  result.cameras.at(1).params[0] += 1;
  EXPECT_THAT(ErrorWithResult(result), HasSubstr("camera 1 has implausible parameters"));

  result = model_;
  PerturbSeed(0.01, 2, &result);
  EXPECT_THAT(ErrorWithResult(result), HasSubstr("RMS reprojection error grew from"));

  result = model_;
  result.points3D.at(12).x_in_world.x() = std::nan("");
  EXPECT_THAT(ErrorWithResult(result), HasSubstr("point 12 is not finite"));
}

TEST_F(FakeBundleAdjuster, ADistortionThatFoldsOverIsAnInputErrorIfItsRefinementWasAskedFor) {
  Model result = model_;
  result.cameras.at(1).params[4] = -0.6;
  options_.refine_focal_length = true;
  EXPECT_THAT(ErrorWithResult(result), HasSubstr("folds over inside the image"));
  options_.refine_extra_params = true;
  const std::string before = Bytes(model_);
  ExpectThrows<InputError>([&] { AdjustWithColmap(options_, log_path_, &model_); },
                           {"--BundleAdjustment.refine_extra_params 1", "leave the option out"});
  EXPECT_EQ(Bytes(model_), before);
}

TEST_F(FakeBundleAdjuster, OnlyOptionsThatTheProgramKnowsAreGiven) {
  const std::string copy =
      "echo \"$@\" > " + (dir_ / "arguments").string() + "; cp \"$3\"/* \"$5\"";
  Script(copy,
         "--BundleAdjustment.refine_focal_length arg\n"
         "--BundleAdjustmentCeres.max_num_iterations arg (=100)");
  options_.max_num_iterations = 17;
  AdjustWithColmap(options_, log_path_, &model_);
  std::ifstream in(dir_ / "arguments");
  const std::string arguments{std::istreambuf_iterator<char>(in), {}};
  EXPECT_THAT(arguments, HasSubstr(" --BundleAdjustment.refine_focal_length 0 "
                                   "--BundleAdjustmentCeres.max_num_iterations 17\n"));
  EXPECT_THAT(arguments, Not(HasSubstr("tolerance")));
}

TEST(BundleAdjustmentOptions, FaultsNameTheOption) {
  EXPECT_NO_THROW(BundleAdjustmentOptions{}.Check());
  BundleAdjustmentOptions options;
  options.min_track_length = 1;
  ExpectThrows<InputError>([&] { options.Check(); }, {"--BundleAdjustment.min_track_length: 1"});
  options = {};
  options.function_tolerance = std::nan("");
  EXPECT_THROW(options.Check(), InputError);
}

TEST(CheckMeanError, DoubtsTheCalibrationWhereThereIsOne) {
  EXPECT_NO_THROW(CheckMeanError(1.0, 2.0, true));
  ExpectThrows<DataError>([] { CheckMeanError(3.0, 2.0, true); },
                          {"3.00 px", "--BundleAdjustment.max_mean_error", "calibration"});
  ExpectThrows<DataError>([] { CheckMeanError(std::nan(""), 2.0, false); }, {"one camera"});
  try {
    CheckMeanError(3.0, 2.0, false);
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), AllOf(Not(HasSubstr("calibration")), Not(HasSubstr("--"))));
  }
}

}  // namespace
}  // namespace velamap
