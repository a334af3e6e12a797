#include "reconstruct/registration/registration_options.h"

#include "importer/base/error.h"

namespace velamap {
namespace {

void Require(bool ok, const std::string& option, const std::string& expected) {
  if (!ok) throw InputError("--Registration." + option + ": expected " + expected);
}

}  // namespace

void ThesisRegistrationOptions::Check() const {
  Require(num_frames >= 0, "num_frames", "0 (the central frame alone) or more");
  Require(skip >= 1, "skip", "at least 1");
  Require(neighborhood >= 0, "neighborhood", "0 or more");
  Require(ransac_max_error_m >= 0, "ransac_max_error", "0 (the marker's side) or a distance in m");
  Require(frequency_threshold >= 0 && frequency_threshold <= 1, "frequency_threshold",
          "a fraction between 0 and 1");
  Require(num_mean_iterations >= 0, "num_mean_iterations", "0 or more");
  Require(mean_sigma_m > 0, "mean_sigma", "a positive distance in m");
}

void GlobalRegistrationOptions::Check() const {
  Require(max_num_frames >= 3, "max_num_frames", "at least 3");
  Require(num_starts >= 1, "num_starts", "at least 1");
}

void RegistrationOptions::Check() const {
  Require(min_num_inliers >= 2, "min_num_inliers", "at least 2");
  Require(min_num_frames >= 2, "min_num_frames", "at least 2");
  thesis.Check();
  global.Check();
}

}  // namespace velamap
