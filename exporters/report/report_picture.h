// The central image of the report (figure 4.25 of the thesis) as a smaller JPEG.

#pragma once

#include <string>

namespace velamap {

struct ReportPicture {
  std::string jpeg_base64;
  std::string problem;  // why there is no picture; empty if there is one
};

// The image as base64 (RFC 4648) of a JPEG, at most `max_side_px` wide and high.
ReportPicture MakeReportPicture(const std::string& image_path, int max_side_px);

std::string Base64(const std::string& bytes);

}  // namespace velamap
