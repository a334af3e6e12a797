#include <iostream>
#include <memory>

#include "reconstruct/colmap/bundle_adjustment_options.h"
#include "workflows/commands/commands.h"
#include "workflows/run/version.h"
#include "workflows/run/versions.h"

namespace velamap {

Command Version() {
  const auto options = std::make_shared<BundleAdjustmentOptions>();
  const auto run = [options](const Arguments&) {
    std::cout << "velamap: " << kVersion << '\n';
    for (const auto& [name, version] : LibraryVersions(options->colmap_path)) {
      std::cout << name << ": " << version << '\n';
    }
  };
  return {{"version",
           "versions of velamap and of the libraries and programs that it uses",
           "--colmap_path /usr/bin/colmap",
           {{"Options", {Common(ColmapPathOption(options.get()))}}}},
          run};
}

}  // namespace velamap
