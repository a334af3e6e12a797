// Refuses options that would have no effect. Only options that were typed on the command line
// count, because a project file serves several commands, and a preset many cases.

#pragma once

#include <string>
#include <vector>

#include "importer/layout/layout.h"
#include "reconstruct/registration/registration_options.h"
#include "workflows/options/option_parser.h"
#include "workflows/options/shared_options.h"
#include "workflows/run/adjustment.h"

namespace velamap {

// Throws InputError for the first of `names` that was typed. A name that ends with a dot stands for
// all options of that section. `reason` says why the option changes nothing.
void RefuseOptionsWithoutEffect(const TypedNames& typed, const std::vector<std::string>& names,
                                const std::string& reason);

// Only warns. For options that take effect once the call gets what it lacks, such as a layout.
void WarnOfOptionsWithoutEffect(const TypedNames& typed, const std::vector<std::string>& names,
                                const std::string& reason);

// Refuses options of videos where --image_path is a folder of photographs.
void RefuseVideoOptions(const CommandOptions& options);

// Refuse options of the adjustment backends and of the registration method that were not chosen.
void RefuseOptionsOfOtherBackend(const TypedNames& typed, AdjustmentBackend backend);
void RefuseOptionsOfOtherMethod(const TypedNames& typed, RegistrationMethod method);

// Refuses --MarkerAdjustment.find_camera 0, which keeps the camera fixed, where there is no
// calibration. `missing` says so in the message, after "0 needs a calibration, and".
void RefuseFixedCameraWithoutCalibration(const TypedNames& typed,
                                         const MarkerAdjustmentOptions& adjustment,
                                         const std::string& missing);

// Refuses options that fix or free parameters of the camera, because an unknown camera has all
// parameters free.
void RefuseOptionsOfKnownCamera(const TypedNames& typed);

// Refuses options of sections and of a sail's surface where the layout has no part with lines.
void RefuseSailOptions(const TypedNames& typed, const Layout& layout);

}  // namespace velamap
