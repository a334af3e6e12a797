#include "workflows/calibrate/board_calibration.h"

#include <vector>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/log.h"
#include "importer/database/colmap_database.h"
#include "workflows/check/clip_frames.h"
#include "workflows/check/dictionary_search.h"
#include "workflows/run/pipeline.h"

namespace velamap {
namespace {

// The markers that stand for the squares of a chessboard; nothing looks up their codes.
Layout LayoutOfChessboard(const BoardCalibrationOptions& options) {
  if (options.chessboard->LooksTheSameTurned()) {
    LogWarning(
        "a {} looks the same when it is turned: hold it upright in all pictures, or take one with "
        "an odd and an even number of corners",
        ChessboardName(*options.chessboard));
  }
  Layout layout;
  layout.marker_length_m = options.square_m;
  return layout;
}

// The layout of the best dictionary; the camera does not depend on the size of the board.
Layout LayoutOfBestDictionary(const BoardCalibrationOptions& options,
                              ArucoDetectionOptions* detection) {
  constexpr int kNumFrames = 10;
  const int num_frames = OpenFrameSource(options.image_path, options.video)->NumFrames();
  const ClipFrames clip =
      ReadClipFrames(options.image_path, SpreadOverClip(options.video, num_frames, kNumFrames),
                     kNumFrames, options.calibration.num_threads);
  const std::vector<DictionaryHint> hints = FindDictionaries(clip, *detection);
  if (hints.empty()) {
    throw DataError(fmt::format(
        "{}: no marker of any of OpenCV's dictionaries is seen in {} pictures: show a board of "
        "markers, larger and in better light, or name its dictionary file with --dictionary and "
        "the side of its markers with --marker_length",
        options.image_path, clip.frames.size()));
  }
  LogInfo("markers of {}", DictionaryName(hints[0]));
  return UseDictionary(hints[0], detection);
}

}  // namespace

BoardCalibration CalibrateWithBoard(const BoardCalibrationOptions& options) {
  const TemporaryFolder folder;
  MarkerImporterOptions importer;
  importer.image_path = options.image_path;
  importer.database_path = (folder.path() / "board.db").string();
  importer.detection = options.detection;
  importer.video = options.video;
  importer.num_threads = options.calibration.num_threads;
  importer.chessboard = options.chessboard;
  importer.layout = options.chessboard ? LayoutOfChessboard(options)
                    : options.layout   ? *options.layout
                                       : LayoutOfBestDictionary(options, &importer.detection);
  ImportImages(importer);
  const ColmapDatabase database(importer.database_path, ColmapDatabase::Mode::kReadOnly);
  return {options.chessboard ? ChessboardName(*options.chessboard)
                             : "markers of " + importer.layout.dictionary,
          CalibrateCamera(options.calibration, database.ReadImages(), database.ReadCameras(),
                          importer.layout, database.ReadFormation())};
}

}  // namespace velamap
