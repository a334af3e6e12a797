#include "reconstruct/model/adjustment_uncertainty.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/log.h"
#include "importer/text/text_file.h"

namespace velamap {
namespace {

// Layout of the file: magic, version, eight doubles, CalibrationEvidence, points, blocks, factor,
// signs, hash of the model (from version 5 on), print_scale_sigma (from version 6 on), markers_bend
// as 8 bytes (from version 7 on); little-endian.
constexpr char kMagic[8] = {'V', 'E', 'L', 'A', 'U', 'N', 'C', '\0'};
constexpr std::uint32_t kVersion = 7, kFirstVersionWithPrintScale = 6, kFirstVersionWithHash = 5,
                        kOldestVersion = 4;

// In the order of the file.
constexpr std::array<double AdjustmentUncertainty::*, 8> kMembers = {
    &AdjustmentUncertainty::relative_scale_sigma, &AdjustmentUncertainty::variance_factor,
    &AdjustmentUncertainty::apparent_inset_px,    &AdjustmentUncertainty::apparent_inset_sigma_px,
    &AdjustmentUncertainty::correlation_factor,   &AdjustmentUncertainty::share_above_4_sigma,
    &AdjustmentUncertainty::rolling_shutter_s,    &AdjustmentUncertainty::rolling_shutter_sigma_s};

// The same, after num_changes.
constexpr std::array<double CalibrationEvidence::*, 9> kEvidenceMembers = {
    &CalibrationEvidence::chi_squared,      &CalibrationEvidence::focal_share,
    &CalibrationEvidence::distortion_share, &CalibrationEvidence::systematic_px,
    &CalibrationEvidence::focal_change,     &CalibrationEvidence::focal_sigma,
    &CalibrationEvidence::shape_change_m,   &CalibrationEvidence::shape_change_in_sigmas,
    &CalibrationEvidence::scale_change};

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the file is written as memory holds it");

std::filesystem::path FilePath(const std::string& folder) {
  return std::filesystem::path(folder) / kUncertaintyFileName;
}

template <typename T>
void Write(const T* values, std::size_t count, std::ostream* out) {
  out->write(reinterpret_cast<const char*>(values),
             static_cast<std::streamsize>(count * sizeof(T)));
}

template <typename T>
void Write(const T& value, std::ostream* out) {
  Write(&value, 1, out);
}

void WriteCount(std::size_t count, std::ostream* out) {
  Write(static_cast<std::uint64_t>(count), out);
}

// Reads the output of Write. Every count is compared with the remaining bytes, so that a damaged
// file cannot make it allocate all memory.
class UncertaintyReader {
 public:
  explicit UncertaintyReader(const std::filesystem::path& path) : path_(path.string()) {
    constexpr std::uintmax_t kMaxSize = std::uintmax_t{4} << 30;
    CheckInputFile(path_, kUncertaintyFileName, kMaxSize);
    in_.open(path, std::ios::binary);
    if (!in_) throw InputError(path_ + ": cannot be read");
    in_.seekg(0, std::ios::end);
    left_ = static_cast<std::uint64_t>(in_.tellg());
    in_.seekg(0);
  }

  template <typename T>
  void Read(T* values, std::uint64_t count) {
    if (count > left_ / sizeof(T)) Fail("is truncated");
    in_.read(reinterpret_cast<char*>(values), static_cast<std::streamsize>(count * sizeof(T)));
    if (!in_) Fail("is truncated");
    left_ -= count * sizeof(T);
  }

  template <typename T>
  T Read() {
    T value;
    Read(&value, 1);
    return value;
  }

  std::uint64_t ReadCount(std::uint64_t bytes_each) {
    const auto count = Read<std::uint64_t>();
    if (count > left_ / bytes_each) Fail("is truncated or broken");
    return count;
  }

  Eigen::MatrixXd ReadMatrix() {
    constexpr std::uint64_t kMaxSize = 1u << 30;
    const auto rows = Read<std::uint64_t>(), cols = Read<std::uint64_t>();
    if (rows > kMaxSize || cols > kMaxSize) Fail("is truncated or broken");
    if (rows * cols > left_ / sizeof(double)) Fail("is truncated or broken");
    Eigen::MatrixXd matrix(rows, cols);
    Read(matrix.data(), rows * cols);
    return matrix;
  }

  void ExpectEnd() {
    if (left_ != 0) Fail("has more data than expected");
  }

  [[noreturn]] void Fail(const std::string& what) const {
    throw InputError(fmt::format(
        "{}: {}; run velamap bundle_adjuster --backend markers again, or remove the file", path_,
        what));
  }

 private:
  std::string path_;
  std::ifstream in_;
  std::uint64_t left_ = 0;
};

void WriteMatrix(const Eigen::MatrixXd& matrix, std::ostream* out) {
  WriteCount(static_cast<std::size_t>(matrix.rows()), out);
  WriteCount(static_cast<std::size_t>(matrix.cols()), out);
  Write(matrix.data(), static_cast<std::size_t>(matrix.size()), out);
}

void CheckShapes(const PointCovariance& points, const UncertaintyReader& reader) {
  const auto num_rows = static_cast<Eigen::Index>(3 * points.point3D_ids.size());
  Eigen::Index num_block_rows = 0;
  for (const Eigen::MatrixXd& block : points.blocks) {
    if (block.rows() != block.cols() || block.rows() % 3 != 0) reader.Fail("is broken");
    num_block_rows += block.rows();
  }
  for (std::size_t i = 1; i < points.point3D_ids.size(); ++i) {
    if (points.point3D_ids[i] <= points.point3D_ids[i - 1]) reader.Fail("is broken");
  }
  if (num_block_rows != num_rows || points.factor.rows() != num_rows ||
      points.signs.size() != points.factor.cols()) {
    reader.Fail("is broken");
  }
}

// Hash of the ids and coordinates of all points; never 0.
std::uint64_t HashOfPoints(const Model& model) {
  std::uint64_t hash = Hash("points");
  for (const auto& [point3D_id, point] : model.points3D) {
    const double* x = point.x_in_world.data();
    hash = Hash({reinterpret_cast<const char*>(&point3D_id), sizeof(point3D_id)}, hash);
    hash = Hash({reinterpret_cast<const char*>(x), 3 * sizeof(double)}, hash);
  }
  return hash == 0 ? 1 : hash;
}

void WriteContent(const AdjustmentUncertainty& uncertainty, const Model& model, std::ostream* out) {
  Write(kMagic, sizeof(kMagic), out);
  Write(kVersion, out);
  for (const auto member : kMembers) Write(uncertainty.*member, out);
  const CalibrationEvidence& calibration = uncertainty.calibration;
  Write(static_cast<std::uint64_t>(calibration.num_changes), out);
  for (const auto member : kEvidenceMembers) Write(calibration.*member, out);
  const PointCovariance& points = uncertainty.points;
  WriteCount(points.point3D_ids.size(), out);
  Write(points.point3D_ids.data(), points.point3D_ids.size(), out);
  WriteCount(points.blocks.size(), out);
  for (const Eigen::MatrixXd& block : points.blocks) WriteMatrix(block, out);
  WriteMatrix(points.factor, out);
  WriteMatrix(points.signs, out);
  Write(HashOfPoints(model), out);
  Write(uncertainty.print_scale_sigma, out);
  WriteCount(uncertainty.markers_bend ? 1 : 0, out);
}

}  // namespace

void WriteUncertainty(const AdjustmentUncertainty& uncertainty, const Model& model,
                      const std::string& folder) {
  WriteFile(FilePath(folder), [&](std::ostream& out) { WriteContent(uncertainty, model, &out); });
}

bool HasUncertainty(const std::string& folder) { return IsRegularFile(FilePath(folder)); }

AdjustmentUncertainty ReadUncertainty(const std::string& folder) {
  UncertaintyReader reader(FilePath(folder));
  char magic[sizeof(kMagic)];
  reader.Read(magic, sizeof(magic));
  if (!std::equal(magic, magic + sizeof(magic), kMagic))
    reader.Fail("is not an uncertainty file of velamap");
  const auto version = reader.Read<std::uint32_t>();
  if (version < kOldestVersion || version > kVersion)
    reader.Fail(fmt::format("has the unknown version {}", version));
  AdjustmentUncertainty uncertainty;
  for (const auto member : kMembers) uncertainty.*member = reader.Read<double>();
  uncertainty.calibration.num_changes = static_cast<int>(reader.Read<std::uint64_t>());
  for (const auto member : kEvidenceMembers) {
    uncertainty.calibration.*member = reader.Read<double>();
  }
  PointCovariance& points = uncertainty.points;
  points.point3D_ids.resize(reader.ReadCount(sizeof(Point3DId)));
  reader.Read(points.point3D_ids.data(), points.point3D_ids.size());
  points.blocks.resize(reader.ReadCount(2 * sizeof(std::uint64_t)));
  for (Eigen::MatrixXd& block : points.blocks) block = reader.ReadMatrix();
  points.factor = reader.ReadMatrix();
  const Eigen::MatrixXd signs = reader.ReadMatrix();
  if (signs.cols() != 1) reader.Fail("is broken");
  points.signs = signs;
  if (version >= kFirstVersionWithHash) uncertainty.model_hash = reader.Read<std::uint64_t>();
  if (version >= kFirstVersionWithPrintScale) {
    uncertainty.print_scale_sigma = reader.Read<double>();
  }
  if (version == kVersion) uncertainty.markers_bend = reader.Read<std::uint64_t>() != 0;
  reader.ExpectEnd();
  CheckShapes(points, reader);
  return uncertainty;
}

std::optional<AdjustmentUncertainty> ReadUncertaintyOf(const Model& model,
                                                       const std::string& folder) {
  if (!HasUncertainty(folder)) return std::nullopt;
  AdjustmentUncertainty uncertainty = ReadUncertainty(folder);
  const std::string path = FilePath(folder).string();
  const auto& ids = uncertainty.points.point3D_ids;
  const bool has_all = std::all_of(ids.begin(), ids.end(), [&](Point3DId point3D_id) {
    return model.points3D.count(point3D_id) > 0;
  });
  const bool is_known = uncertainty.model_hash != 0;
  if (!has_all || (is_known && uncertainty.model_hash != HashOfPoints(model))) {
    throw InputError(fmt::format(
        "{}: does not belong to the model beside it; run velamap bundle_adjuster --backend "
        "markers again, or remove the file",
        path));
  }
  if (!is_known) {
    LogWarning("{}: does not say which model it belongs to; assuming the one beside it", path);
  }
  return uncertainty;
}

}  // namespace velamap
