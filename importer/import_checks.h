// Refuses a database that was made with other settings, and frames that cannot be used.

#pragma once

#include <string>
#include <vector>

#include "importer/database/colmap_database.h"
#include "importer/dictionary_hint.h"
#include "importer/marker_importer.h"

namespace velamap {

// With fewer markers per frame than this, those found are probably false ones.
inline constexpr double kFewMarkersPerFrame = 0.5;

inline constexpr char kImportAnewRemedy[] =
    "write to a new place, or give --import_anew 1 to import everything again";

// Throws InputError if `database` holds images that were imported with another `detector`
// (DescribeDetector()) or another calibration than this run has.
void CheckSameSettings(const MarkerImporterOptions& options, const std::string& detector,
                       const ColmapDatabase& database);

// Throws InputError if a photograph of the database, or its video, has changed or is missing, or if
// the database holds frames that options.allowed_frames leaves out.
void CheckSources(const MarkerImporterOptions& options, const std::vector<std::string>& known_names,
                  const ColmapDatabase& database);

// Records the source files of a database that an earlier velamap has made, with a warning.
void RecordSources(const MarkerImporterOptions& options,
                   const std::vector<std::string>& known_names, ColmapDatabase* database);

// Throws InputError if a frame of the video could replace a picture that velamap did not write.
// Removes what an interrupted run has left unfinished.
void CheckFrameFolder(const MarkerImporterOptions& options,
                      const std::vector<std::string>& known_names);

// Throws InputError if the pixels of a video are not square and no calibration describes them.
void CheckPixelAspect(const MarkerImporterOptions& options);

// Throws InputError if the calibration is for another size than the first frame that can be read,
// as the import of each frame does. To be called before the estimate of camera and print, which
// takes a long time.
void CheckCalibrationSize(const MarkerImporterOptions& options);

// Throws DataError if the frames hold no marker, or hardly any while another dictionary finds many.
// With a wrong dictionary or polarity, false ids are found, most of which the layout does not name.
// The suggestion of another dictionary therefore comes before any complaint about ids.
void CheckMarkersFound(const MarkerImporterOptions& options, const std::string& dictionary_name,
                       const ImageSample& sample, const ImportReport& report);

}  // namespace velamap
