// Finds the dictionary of a clip's markers if none is given.

#pragma once

#include <string>
#include <vector>

#include "importer/database/colmap_database.h"
#include "importer/dictionary_hint.h"
#include "importer/layout/layout.h"
#include "workflows/check/clip_frames.h"

namespace velamap {

// The predefined dictionaries that find markers in the frames, the best one first.
std::vector<DictionaryHint> FindDictionaries(const ClipFrames& clip,
                                             const ArucoDetectionOptions& options);

// "DICT_4X4_50, inverted".
std::string DictionaryName(const DictionaryHint& hint);

// The smallest dictionary of the family of `dictionary` that has all ids that the images show, but
// for rare ones (rare_ids.h).
std::string DictionaryOfIds(const std::vector<DatabaseImage>& images,
                            const std::string& dictionary);

// A layout that has only the dictionary, and an arbitrary length of the markers. Sets the polarity
// of `detection`.
Layout UseDictionary(const DictionaryHint& hint, ArucoDetectionOptions* detection);

}  // namespace velamap
