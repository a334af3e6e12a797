// Interlaced video consists of two fields, the even and the odd lines, exposed one after the other.
// Where something moved in between, the woven picture has combs at its edges.

#pragma once

#include <opencv2/core.hpp>

namespace velamap {

// Whether combs show in the picture (8 bit). Each line is compared with its neighbours, which
// belong to the other field, and with the next-but-one lines, which belong to its own: in a comb, a
// line differs only from its neighbours. In a progressive picture, lines differ from the
// next-but-one lines at least as often, except where a texture repeats every two lines, which looks
// combed, and at edges where a colour filter array was interpolated badly: these zippers cross
// lines and columns alike, so the combs must exceed those of the columns too. A picture in which
// hardly anything has moved between its fields is not combed.
bool IsCombed(const cv::Mat& gray);

}  // namespace velamap
