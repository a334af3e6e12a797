#include "reconstruct/model/adjustment_uncertainty.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

class UncertaintyFile : public testing::Test {
 protected:
  UncertaintyFile() {
    uncertainty_.points.point3D_ids = {11, 12, 24};
    uncertainty_.points.blocks = {2.0 * Eigen::MatrixXd::Identity(6, 6),
                                  3.0 * Eigen::MatrixXd::Identity(3, 3)};
    uncertainty_.points.factor = Eigen::MatrixXd::Constant(9, 2, 0.1);
    uncertainty_.points.factor(4, 1) = 1.0 / 3.0;
    uncertainty_.points.signs = Eigen::Vector2d(1, -1);
    uncertainty_.relative_scale_sigma = 1e-3;
    uncertainty_.print_scale_sigma = 8e-4;
    uncertainty_.markers_bend = true;
    uncertainty_.variance_factor = 1.7;
    uncertainty_.apparent_inset_px = -0.01;
    uncertainty_.apparent_inset_sigma_px = 0.02;
    uncertainty_.calibration = {8, 123.5, 0.25, 0.5, 0.125, -0.09, 0.002, 0.015, 3.5, 0.01};
    uncertainty_.correlation_factor = 1.3;
    uncertainty_.share_above_4_sigma = 0.004;
  }

  std::string Folder() const { return dir_.path().string(); }

  std::string FileBytes() const {
    std::ifstream in(dir_ / kUncertaintyFileName, std::ios::binary);
    std::stringstream bytes;
    bytes << in.rdbuf();
    return bytes.str();
  }

  void WriteBytes(const std::string& bytes) const {
    std::ofstream(dir_ / kUncertaintyFileName, std::ios::binary) << bytes;
  }

  // A file without the last values of the current version.
  void WriteEarlierVersion(char version, std::size_t num_values_less) const {
    WriteUncertainty(uncertainty_, {}, Folder());
    std::string bytes = FileBytes();
    bytes[8] = version;
    bytes.resize(bytes.size() - 8 * num_values_less);
    WriteBytes(bytes);
  }

  void WriteVersionWithoutHash() const { WriteEarlierVersion(4, 3); }

  TempDir dir_;
  AdjustmentUncertainty uncertainty_;
};

TEST_F(UncertaintyFile, ComesBackToTheLastBit) {
  EXPECT_FALSE(HasUncertainty(Folder()));
  WriteUncertainty(uncertainty_, {}, Folder());
  EXPECT_TRUE(HasUncertainty(Folder()));
  const AdjustmentUncertainty read = ReadUncertainty(Folder());
  EXPECT_EQ(read.points.point3D_ids, uncertainty_.points.point3D_ids);
  EXPECT_EQ(read.points.blocks, uncertainty_.points.blocks);
  EXPECT_EQ(read.points.factor, uncertainty_.points.factor);
  EXPECT_EQ(read.points.signs, uncertainty_.points.signs);
  EXPECT_EQ(read.relative_scale_sigma, uncertainty_.relative_scale_sigma);
  EXPECT_EQ(read.print_scale_sigma, uncertainty_.print_scale_sigma);
  EXPECT_EQ(read.markers_bend, uncertainty_.markers_bend);
  EXPECT_EQ(read.variance_factor, uncertainty_.variance_factor);
  EXPECT_EQ(read.apparent_inset_px, uncertainty_.apparent_inset_px);
  EXPECT_EQ(read.correlation_factor, uncertainty_.correlation_factor);
  EXPECT_EQ(read.share_above_4_sigma, uncertainty_.share_above_4_sigma);
  EXPECT_EQ(read.apparent_inset_sigma_px, uncertainty_.apparent_inset_sigma_px);
  const CalibrationEvidence &found = read.calibration, &written = uncertainty_.calibration;
  EXPECT_EQ(found.num_changes, written.num_changes);
  EXPECT_EQ(found.chi_squared, written.chi_squared);
  EXPECT_EQ(found.focal_share, written.focal_share);
  EXPECT_EQ(found.distortion_share, written.distortion_share);
  EXPECT_EQ(found.systematic_px, written.systematic_px);
  EXPECT_EQ(found.focal_change, written.focal_change);
  EXPECT_EQ(found.focal_sigma, written.focal_sigma);
  EXPECT_EQ(found.shape_change_m, written.shape_change_m);
  EXPECT_EQ(found.shape_change_in_sigmas, written.shape_change_in_sigmas);
  EXPECT_EQ(found.scale_change, written.scale_change);
}

TEST_F(UncertaintyFile, IsTiedToItsModel) {
  Model model;
  EXPECT_FALSE(ReadUncertaintyOf(model, Folder()));
  for (const Point3DId id : uncertainty_.points.point3D_ids) {
    model.points3D[id].x_in_world = Eigen::Vector3d(1.0, 2.0, static_cast<double>(id));
  }
  WriteUncertainty(uncertainty_, model, Folder());
  ASSERT_TRUE(ReadUncertaintyOf(model, Folder()));
  EXPECT_EQ(ReadUncertaintyOf(model, Folder())->points.factor, uncertainty_.points.factor);
  Model other = model;
  other.points3D.begin()->second.x_in_world.x() += 1e-12;
  EXPECT_THROW(ReadUncertaintyOf(other, Folder()), InputError);
  other = model;
  other.points3D[9999].x_in_world.setOnes();
  EXPECT_THROW(ReadUncertaintyOf(other, Folder()), InputError);
  WriteVersionWithoutHash();  // does not say of which model
  EXPECT_TRUE(ReadUncertaintyOf(other, Folder()));
  other.points3D.erase(uncertainty_.points.point3D_ids.front());
  EXPECT_THROW(ReadUncertaintyOf(other, Folder()), InputError);
}

TEST_F(UncertaintyFile, FilesOfEarlierVersionsAreRead) {
  WriteVersionWithoutHash();
  EXPECT_EQ(ReadUncertainty(Folder()).points.signs, uncertainty_.points.signs);
  EXPECT_EQ(ReadUncertainty(Folder()).model_hash, 0u);
  WriteEarlierVersion(6, 1);
  EXPECT_EQ(ReadUncertainty(Folder()).print_scale_sigma, uncertainty_.print_scale_sigma);
  EXPECT_FALSE(ReadUncertainty(Folder()).markers_bend);
  WriteEarlierVersion(5, 2);
  EXPECT_NE(ReadUncertainty(Folder()).model_hash, 0u);
  EXPECT_EQ(ReadUncertainty(Folder()).print_scale_sigma, 0.0);
}

TEST_F(UncertaintyFile, NoPointsAndNoFactorAreFine) {
  WriteUncertainty({}, {}, Folder());
  EXPECT_TRUE(ReadUncertainty(Folder()).points.IsEmpty());
  uncertainty_.points.factor.resize(9, 0);
  uncertainty_.points.signs.resize(0);
  WriteUncertainty(uncertainty_, {}, Folder());
  EXPECT_EQ(ReadUncertainty(Folder()).points.factor.rows(), 9);
}

TEST_F(UncertaintyFile, EveryTruncationIsAnInputErrorThatNamesTheFile) {
  WriteUncertainty(uncertainty_, {}, Folder());
  const std::string bytes = FileBytes();
  for (std::size_t size = 0; size < bytes.size(); size += 7) {
    WriteBytes(bytes.substr(0, size));
    SCOPED_TRACE(size);
    ExpectThrows<InputError>([&] { ReadUncertainty(Folder()); }, {kUncertaintyFileName});
  }
  WriteBytes(bytes + "x");
  EXPECT_THROW(ReadUncertainty(Folder()), InputError);
}

TEST_F(UncertaintyFile, ForeignOrBrokenFilesAreInputErrors) {
  WriteUncertainty(uncertainty_, {}, Folder());
  const std::string bytes = FileBytes();
  WriteBytes("no uncertainty at all, but a text that somebody put here");
  EXPECT_THROW(ReadUncertainty(Folder()), InputError);
  for (const std::size_t at : {8u, 156u, 163u}) {  // version, number of points
    std::string broken = bytes;
    broken[at] = '\x7f';
    WriteBytes(broken);
    EXPECT_THROW(ReadUncertainty(Folder()), InputError) << at;
  }
  std::filesystem::remove(dir_ / kUncertaintyFileName);
  EXPECT_THROW(ReadUncertainty(Folder()), InputError);
  EXPECT_THROW(WriteUncertainty(uncertainty_, {}, Folder() + "/missing"), InputError);
}

}  // namespace
}  // namespace velamap
