// Merges the parts of a video (import_part.h) into one database.

#pragma once

#include <string>
#include <vector>

#include "importer/layout/layout.h"

namespace velamap {

struct DatabaseMergerOptions {
  std::vector<std::string> database_paths;  // of all parts, in any order; not changed
  std::string output_path;                  // an existing database of velamap is replaced
  Layout layout;                            // the layout of the imports
};

struct MergeReport {
  int num_images = 0;
  int num_markers = 0;  // accepted detections
  int num_pairs = 0;    // image pairs with matches
};

// Writes the same database, row for row, that a single import of all frames would write. This
// includes the steps of an import that need all frames (import_completion.h).
//
// Throws InputError, naming the database, unless the databases hold all parts of one import, each
// once and finished, with the same video, camera, frames, detection options and image formation;
// also for a different layout, and for an existing output that velamap did not write. Throws
// DataError if no part holds a marker.
MergeReport MergeDatabases(const DatabaseMergerOptions& options);

}  // namespace velamap
