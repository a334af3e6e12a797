// libFuzzer's entry points for one reader, VELAMAP_FUZZED_READER.

#include <spdlog/spdlog.h>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "exporters/design/mesh_reader.h"
#include "importer/base/error.h"
#include "tests/fuzz/readers.h"

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  velamap::ServeMeshReader(*argc, *argv);
  spdlog::set_level(spdlog::level::off);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const velamap::FuzzedReader& reader = velamap::FuzzedReaders().at(VELAMAP_FUZZED_READER);
  try {
    reader.read({reinterpret_cast<const char*>(data), size});
  } catch (const velamap::InputError&) {
  } catch (const velamap::DataError&) {
  } catch (const std::exception& error) {
    std::fprintf(stderr, "not refused, but: %s\n", error.what());
    std::abort();
  }
  return 0;
}
