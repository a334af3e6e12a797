// Checks files before OpenCV's FileStorage reads them, because its parsers of YAML, XML and JSON
// crash on files that are cut off or nested deeply.

#pragma once

#include <string>

#include <opencv2/core/persistence.hpp>

namespace velamap {

// Throws InputError, naming the path, unless the text, which has no byte order mark, is well-formed
// by parsers that do not crash, its top is a map, and it is nested no deeper and holds no more
// values than calibrations and dictionaries do.
void CheckStorageText(const std::string& text, const std::string& path);

// Opens a text that passes CheckStorageText. Throws InputError, naming the path and `kind`, such as
// "OpenCV FileStorage file", if OpenCV does not read a map in it.
cv::FileStorage OpenStorage(const std::string& text, const std::string& path,
                            const std::string& kind);

}  // namespace velamap
