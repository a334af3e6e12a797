// Whether detections look like false ones of a wrong dictionary.

#pragma once

#include <string>
#include <vector>

#include "importer/database/colmap_database.h"

namespace velamap {

// With a wrong dictionary or polarity, codes are found by chance, most of them once, whereas a
// print is seen again in other pictures. If most ids are seen in one image only, or the images hold
// fewer than three markers on average, returns the count, such as `52 of 60 ids are seen in only
// one of the 40 images`. Otherwise, and for fewer than two images with markers, returns an empty
// text.
std::string DictionaryDoubt(const std::vector<DatabaseImage>& images);

}  // namespace velamap
