#include "tests/fuzz/readers.h"

#include <array>
#include <fstream>
#include <iterator>
#include <memory>
#include <sstream>

#include "exporters/design/mesh_parser.h"
#include "exporters/design/mesh_process.h"
#include "exporters/formats/cad_writer.h"
#include "exporters/formats/mesh_writer.h"
#include "exporters/formats/shape_csv.h"
#include "exporters/shape/marker_shape.h"
#include "exporters/surface/surface.h"
#include "exporters/surface/surface_csv.h"
#include "importer/base/error.h"
#include "importer/camera/calibration.h"
#include "importer/database/colmap_database.h"
#include "importer/database/tracking_table.h"
#include "importer/detect/detection_options.h"
#include "importer/layout/dictionary.h"
#include "importer/layout/layout.h"
#include "importer/print/png_file.h"
#include "importer/video/image_file.h"
#include "importer/video/jpeg_codec.h"
#include "importer/video/video_options.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/model/model_io.h"
#include "reconstruct/registration/registration_options.h"
#include "tests/exporters/sail/example_surface.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/temp_dir.h"
#include "tests/support/true_model.h"
#include "workflows/options/option_parser.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;
using Bytes = std::string;

Bytes BytesOf(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void Write(const fs::path& path, const Bytes& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

template <typename Writer>
Bytes Written(const Writer& writer) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  writer(out);
  return out.str();
}

// The folder in which one reader finds its files; kept for the next input.
const TempDir& Folder() {
  static const TempDir dir;
  return dir;
}

// A reader of one file, which gets this name.
template <typename Read>
std::function<void(const Bytes&)> OfFile(const std::string& name, const Read& read) {
  return [=](const Bytes& bytes) {
    const fs::path path = Folder() / name;
    Write(path, bytes);
    read(path.string());
  };
}

std::function<std::vector<Bytes>()> Texts(std::vector<Bytes> texts) {
  return [texts = std::move(texts)] { return texts; };
}

// ---- pictures

void ReadPicture(const std::string& path) {
  std::string reason;
  if (DecodeImageFile(path, &reason).empty()) throw InputError(reason);
}

std::vector<Bytes> PictureSeeds() {
  cv::Mat image(5, 7, CV_8UC3);
  cv::RNG(1).fill(image, cv::RNG::UNIFORM, 0, 256);
  const Bytes pixels(reinterpret_cast<const char*>(image.data), 7 * 5);
  // A TIFF of seven by five grey pixels: header, pixels, one zero to an even offset, and the tags
  // of width, height, compression, colours, offset, rows a strip and bytes.
  Bytes tiff = Bytes("II*\0\x2c\0\0\0", 8) + pixels + Bytes("\0\x07\0", 3);
  for (const auto& [tag, value] : std::initializer_list<std::pair<int, int>>{
           {256, 7}, {257, 5}, {259, 1}, {262, 1}, {273, 8}, {278, 5}, {279, 35}}) {
    for (const int field : {tag, 3, 1, 0, value, 0}) {
      tiff += {static_cast<char>(field & 255), static_cast<char>(field >> 8)};
    }
  }
  return {EncodeJpeg(image, 80), EncodePng(image), "P5 7 5 255\n" + pixels, tiff + Bytes(4, '\0')};
}

// ---- options and layouts

// Without paths: the parser looks at the files that they name.
void ReadProjectFile(const std::string& path) {
  VideoOptions video;
  ArucoDetectionOptions detection;
  RegistrationOptions registration;
  SurfaceOptions surface;
  CommandSyntax syntax{"fuzz", "", "", {}};
  for (const OptionGroup& group : {DescribeOptions(&video), DescribeOptions(&detection),
                                   DescribeOptions(&registration), DescribeOptions(&surface)}) {
    syntax.groups.push_back(group);
  }
  ParseOptions(syntax, {"--project_path", path}, {"known_of_another_command"});
}

const char* const kCalibration =
    "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n"
    "   rows: 3\n   cols: 3\n   dt: d\n   data: [ 600., 0., 319.5, 0., 600., 239.5, 0., 0., 1. ]\n"
    "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
    "   data: [ -0.1, 0.01, 0., 0., 0. ]\n";
const char* const kXml =
    "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>640</image_width>\n"
    "<image_height>480</image_height>\n<camera_matrix type_id=\"opencv-matrix\">\n<rows>3</rows>\n"
    "<cols>3</cols>\n<dt>d</dt>\n<data>600. 0. 319.5 0. 600. 239.5 0. 0. "
    "1.</data></camera_matrix>\n"
    "<distortion_coefficients type_id=\"opencv-matrix\">\n<rows>1</rows>\n<cols>4</cols>\n"
    "<dt>d</dt>\n<data>0. 0. 0. 0.</data></distortion_coefficients>\n"
    "<distortion_model>fisheye</distortion_model>\n</opencv_storage>\n";
const char* const kJson =
    "{\n\"image_width\": 640,\n\"image_height\": 480,\n\"camera_matrix\": [600.0, 0, 319.5, 0, "
    "600.0, 239.5, 0, 0, 1],\n\"distortion_coefficients\": [0.1, 0, 0, 0]\n}\n";
const char* const kCamerasTxt = "# Camera list\n1 OPENCV 640 480 600 600 320 240 -0.1 0.01 0 0\n";

const char* const kDictionary =
    "%YAML:1.0\n---\nnmarkers: 2\nmarkersize: 3\nmaxCorrectionBits: 0\nmarker_0: \"101000110\"\n"
    "marker_1: \"110010001\"\n";

const char* const kLayout =
    "dictionary: DICT_4X4_50\nmarker_length: 0.1\nmarker_lengths: {7: 0.05}\nborder_bits: 1\n"
    "parts:\n  sail:\n    horizontal:\n      - {name: h1, markers: [1, 2, 3]}\n"
    "      - {name: h2, markers: [4, 5, 6]}\n    vertical:\n      - {name: v1, markers: [1, 4]}\n"
    "    markers: [7]\n  hull: {markers: [20, 21, 22], rigid: true}\nreference_part: hull\n"
    "distances:\n  - {from: 20, to: 21.3, length: 0.5, sigma: 0.001, use: scale}\n"
    "known_points:\n  - {at: 20, x: 1, z: -0.5, sigma: 0.002, use: check}\n"
    "frame: reference_part\n";

const char* const kShape =
    "marker_id,corner,x,y,z,sigma_x,sigma_y,sigma_z,num_frames,part\n"
    "1,0,0,0,0,0.001,0.001,0.001,4,sail\n1,1,-0.05,0.05,0,0.001,0.001,0.001,4,sail\n"
    "1,2,0.05,0.05,0,0.001,0.001,0.001,4,sail\n1,3,0.05,-0.05,0,0.001,0.001,0.001,4,sail\n"
    "1,4,-0.05,-0.05,0,0.001,0.001,0.001,4,sail\n2,1,1,0,0,,,,2,\"a,\"\"b\"\n";

const char* const kEdges = "edge,x,y,z\nluff,0,0,0\nluff,0,0,1\nleech,1,0,0\nleech,1,0.1,1\n";

const char* const kResiduals =
    "marker_id,line,u,v,distance,beyond_edge,is_used\n7,\"h,1\",0.25,0.5,-0.00125,0,1\n"
    "9,,1,0.5,0.5,0.25,0\n";

// ---- models and databases

const SyntheticScene& Scene() {
  static const SyntheticScene scene = [] {
    SyntheticSceneOptions options;
    options.num_rows = 1;
    options.num_columns = 2;
    options.num_frames = 2;
    return MakeSyntheticScene(options);
  }();
  return scene;
}

using ModelFiles = std::array<const char*, 3>;
const ModelFiles kBinary = {"cameras.bin", "images.bin", "points3D.bin"};
const ModelFiles kText = {"cameras.txt", "images.txt", "points3D.txt"};

std::vector<Bytes> GoodModel(ModelFormat format, const ModelFiles& names) {
  const TempDir dir;
  WriteModel(TrueModel(Scene()), (dir / "model").string(), format);
  std::vector<Bytes> files;
  for (const char* name : names) files.push_back(BytesOf(dir / "model" / name));
  return files;
}

FuzzedReader OfModel(ModelFormat format, const ModelFiles& names) {
  const auto folder = std::make_shared<TempDir>();  // binary files are read rather than text
  const auto good = std::make_shared<std::vector<Bytes>>();
  const auto read = [=](const Bytes& bytes) {
    if (bytes.empty()) return;
    if (good->empty()) *good = GoodModel(format, names);
    const std::size_t replaced = static_cast<unsigned char>(bytes.front()) % names.size();
    for (std::size_t i = 0; i < names.size(); ++i) {
      Write(*folder / names[i], i == replaced ? bytes.substr(1) : (*good)[i]);
    }
    ReadModel(folder->path().string());
  };
  const auto make_seeds = [=] {
    std::vector<Bytes> seeds = GoodModel(format, names);
    for (std::size_t i = 0; i < seeds.size(); ++i) seeds[i].insert(0, 1, static_cast<char>(i));
    return seeds;
  };
  return {read, make_seeds};
}

void ReadDatabase(const std::string& path) {
  for (const auto mode :
       {ColmapDatabase::Mode::kReadOnly, ColmapDatabase::Mode::kReadWriteCreate}) {
    const ColmapDatabase database(path, mode, 0);
    database.ReadCameras();
    database.HasCalibration();
    database.ReadImageIdsByName();
    database.ReadDetector();
    database.ReadFormation();
    database.ReadSources();
    database.ReadTracking();
    database.ReadImages();
  }
}

std::vector<Bytes> DatabaseSeeds() {
  const TempDir dir;
  {
    ColmapDatabase database((dir / "database.db").string(), ColmapDatabase::Mode::kReadWriteCreate);
    ColmapDatabase::Transaction transaction(&database);
    const CameraId camera_id = database.AddCamera(Scene().camera);
    for (const FrameDetections& frame : Scene().frames) {
      database.AddImage(camera_id, frame, "fuzz");
    }
    database.WriteFormation({});
    database.WriteSource("", {"clip.mp4", 1, 2, 3, 4, 5});
    TrackingState tracking;
    tracking.last_frame = 0;
    tracking.tracks.tracks.emplace_back().corners_px.fill(Eigen::Vector2d::Zero());
    database.WriteTracking(tracking);
    transaction.Commit();
  }
  return {BytesOf(dir / "database.db")};
}

std::vector<Bytes> UncertaintySeeds() {
  AdjustmentUncertainty uncertainty;
  const Eigen::Index num_rows = 6;
  uncertainty.points.point3D_ids = {11, 12};
  uncertainty.points.blocks = {Eigen::MatrixXd::Identity(num_rows, num_rows)};
  uncertainty.points.factor = Eigen::MatrixXd::Ones(num_rows, 2);
  uncertainty.points.signs = Eigen::VectorXd::Ones(2);
  const TempDir dir;
  WriteUncertainty(uncertainty, {}, dir.path().string());
  return {BytesOf(dir / kUncertaintyFileName)};
}

// ---- meshes, in a process of their own

void ReadMeshShortly(const std::string& path) {
  CheckMeshFile(path);
  MeshLimits limits;
  limits.cpu_s = 5;
  limits.wall_s = 15;
  limits.memory_bytes = std::uint64_t{2} << 30;
  MeshReadOptions options;
  options.chord_deviation_mm = 100.0;
  ParseMeshInChild(path, options, limits);
}

template <typename Writer>
FuzzedReader OfCad(const std::string& name, Writer* writer) {
  return {OfFile(name, ReadMeshShortly), [writer] {
            const SplineSurface surface = FitSurface(MarkersOn(BilinearPatch, 3, 4)).surface;
            return std::vector<Bytes>{
                Written([&](std::ostream& out) { writer(surface, "sail", out, CadExtras{}); })};
          }};
}

template <typename Writer>
FuzzedReader OfMesh(const std::string& name, Writer writer) {
  return {
      OfFile(name, ReadMeshShortly), [writer] {
        TriangleMesh mesh;
        mesh.vertices_m = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.1}};
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
        return std::vector<Bytes>{Written([&](std::ostream& out) { writer(mesh, "sail", out); })};
      }};
}

template <typename Writer>
auto InMetres(Writer* writer) {
  return [writer](const TriangleMesh& mesh, const std::string& name, std::ostream& out) {
    writer(mesh, name, LengthUnit::kMetre, out);
  };
}

}  // namespace

const std::map<std::string, FuzzedReader>& FuzzedReaders() {
  static const std::map<std::string, FuzzedReader> readers = {
      {"calibration",
       {OfFile("camera.yml", ReadCalibration), Texts({kCalibration, kXml, kJson, kCamerasTxt})}},
      {"dictionary", {OfFile("dictionary.yml", LoadDictionary), Texts({kDictionary})}},
      {"layout", {OfFile("layout.yml", ReadLayout), Texts({kLayout})}},
      {"picture", {OfFile("picture", ReadPicture), PictureSeeds}},
      {"project_file",
       {OfFile("project.ini", ReadProjectFile),
        Texts({"[Video]\nfirst_frame=3\nframe_step=2\n[Registration]\nmethod=thesis\n"})}},
      {"shape_csv",
       {OfFile("shape.csv", [](const std::string& path) { ReadShapeCsv(path); }), Texts({kShape})}},
      {"edges_csv",
       {OfFile("edges.csv", [](const std::string& path) { ReadSurfaceEdges(path); }),
        Texts({kEdges})}},
      {"residuals_csv",
       {OfFile("residuals.csv", [](const std::string& path) { ReadSurfaceResidualRms(path); }),
        Texts({kResiduals})}},
      {"model_binary", OfModel(ModelFormat::kBinary, kBinary)},
      {"model_text", OfModel(ModelFormat::kText, kText)},
      {"uncertainty",
       {OfFile(kUncertaintyFileName,
               [](const std::string& path) {
                 ReadUncertainty(fs::path(path).parent_path().string());
               }),
        UncertaintySeeds}},
      {"database", {OfFile("database.db", ReadDatabase), DatabaseSeeds}},
      {"ply", OfMesh("mesh.ply",
                     [](const TriangleMesh& mesh, const std::string& name, std::ostream& out) {
                       WriteMeshPly(mesh, name, PlyFormat::kBinaryLittleEndian, out);
                     })},
      {"obj", OfMesh("mesh.obj", InMetres(WriteMeshObj))},
      {"stl", OfMesh("mesh.stl", InMetres(WriteMeshStl))},
      {"step", OfCad("mesh.step", WriteStep)},
      {"iges", OfCad("mesh.iges", WriteIges)}};
  return readers;
}

}  // namespace velamap
