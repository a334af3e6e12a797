// Whether detections look like false ones of a wrong dictionary.

#pragma once

#include <string>
#include <vector>

#include "importer/database/colmap_database.h"

namespace velamap {

// A wrong dictionary or polarity finds a code here and there, most of them once only, where a print
// is seen again in other pictures. Returns what was counted, such as `52 of 60 ids are seen in one
// of the 40 images only`, where most ids are seen in one image only or the images hold fewer than
// three markers in the mean; else, and for fewer than two images with markers, an empty text.
std::string DictionaryDoubt(const std::vector<DatabaseImage>& images);

}  // namespace velamap
