// Opens files of OpenCV's FileStorage. Its parsers of YAML, XML and JSON crash or never end on
// files that are damaged, so that they see only what yaml-cpp and pugixml have read and written
// again.

#pragma once

#include <string>

#include <opencv2/core/persistence.hpp>

namespace velamap {

// `text` has no byte order mark. Throws InputError, naming the path and `kind`, such as "OpenCV
// FileStorage file", unless its top is a map, and it is nested no deeper and holds no more values
// than calibrations and dictionaries do. Keys of other forms than names in such files are left out.
cv::FileStorage OpenStorage(const std::string& text, const std::string& path,
                            const std::string& kind);

}  // namespace velamap
