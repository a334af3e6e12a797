// The central image as the report shows it (Figure 4.25 of the thesis): a smaller JPEG.

#pragma once

#include <string>

namespace velamap {

struct ReportPicture {
  std::string jpeg_base64;
  std::string problem;  // why there is no picture; empty where there is one
};

// The image, not larger than `max_side_px` in width and height, as base64 (RFC 4648) of a JPEG.
ReportPicture MakeReportPicture(const std::string& image_path, int max_side_px);

std::string Base64(const std::string& bytes);

}  // namespace velamap
