// Opens files of OpenCV's FileStorage. Its parsers of YAML, XML and JSON crash or loop forever on
// damaged files, so they only see text that yaml-cpp or pugixml has parsed and written again.

#pragma once

#include <string>

#include <opencv2/core/persistence.hpp>

namespace velamap {

// `text` has no byte order mark. Throws InputError, naming the path and `kind`, such as "OpenCV
// FileStorage file", unless its top level is a map, and it is nested no deeper and holds no more
// values than calibrations and dictionaries do. Keys that are not plain identifiers are left out.
cv::FileStorage OpenStorage(const std::string& text, const std::string& path,
                            const std::string& kind);

}  // namespace velamap
