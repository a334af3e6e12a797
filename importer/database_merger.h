// Puts the parts of a video (import_part.h) together into one database.

#pragma once

#include <string>
#include <vector>

#include "importer/layout/layout.h"

namespace velamap {

struct DatabaseMergerOptions {
  std::vector<std::string> database_paths;  // of all parts, in any order; they stay as they are
  std::string output_path;                  // a database of velamap that is there is replaced
  Layout layout;                            // the layout of the imports
};

struct MergeReport {
  int num_images = 0;
  int num_markers = 0;  // accepted detections
  int num_pairs = 0;    // image pairs with matches
};

// Writes the database that one import of all frames makes: every row of every table is the same.
// The steps of an import that need all frames (import_completion.h) are done here.
//
// Throws InputError, naming the database, unless the databases hold all parts of one import, each
// once and finished: of the same video, camera, frames, detection options and image formation; also
// for another layout, and for an output that velamap has not made. Throws DataError if no part
// holds a marker.
MergeReport MergeDatabases(const DatabaseMergerOptions& options);

}  // namespace velamap
