// Finds the dictionary of a clip's markers if none is given.

#pragma once

#include <string>
#include <vector>

#include "importer/dictionary_hint.h"
#include "importer/layout/layout.h"
#include "workflows/check/clip_frames.h"

namespace velamap {

// The predefined dictionaries that find markers in the frames, the best one first.
std::vector<DictionaryHint> FindDictionaries(const ClipFrames& clip,
                                             const ArucoDetectionOptions& options);

// "DICT_4X4_50, inverted".
std::string DictionaryName(const DictionaryHint& hint);

// A layout that has only the dictionary, and an arbitrary length of the markers. Sets the polarity
// of `detection`.
Layout UseDictionary(const DictionaryHint& hint, ArucoDetectionOptions* detection);

}  // namespace velamap
