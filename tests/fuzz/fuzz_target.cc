// libFuzzer's entry points. The program is started as fuzz_READER, which names the reader.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>

#include "exporters/design/mesh_reader.h"
#include "importer/base/error.h"
#include "tests/fuzz/readers.h"
#include "workflows/run/logging.h"

namespace {

const velamap::FuzzedReader* fuzzed_reader = nullptr;

const velamap::FuzzedReader& ReaderOfProgram(const std::string& program) {
  const std::string prefix = "fuzz_", name = std::filesystem::path(program).filename().string();
  const auto& readers = velamap::FuzzedReaders();
  const auto it = readers.find(name.substr(std::min(prefix.size(), name.size())));
  if (it != readers.end()) return it->second;
  std::fprintf(stderr, "%s: start it as fuzz_READER, such as fuzz_layout\n", name.c_str());
  std::exit(2);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  velamap::ServeMeshReader(*argc, *argv);
  fuzzed_reader = &ReaderOfProgram((*argv)[0]);
  velamap::SetLogLevel(velamap::LogLevel::kError);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    fuzzed_reader->read({reinterpret_cast<const char*>(data), size});
  } catch (const velamap::InputError&) {
  } catch (const velamap::DataError&) {
  } catch (const std::exception& error) {
    std::fprintf(stderr, "not refused, but: %s\n", error.what());
    std::abort();
  }
  return 0;
}
