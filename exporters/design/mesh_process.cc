#include "exporters/design/mesh_process.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "exporters/design/mesh_parser.h"
#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/numbers.h"
#include "importer/process/child_process.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

constexpr char kProgram[] = "/proc/self/exe";
constexpr char kArgument[] = "read_mesh_for_parent";
constexpr int kNumArguments = 7;  // program, kArgument, path, chord, unit, seconds, bytes
constexpr int kAnswerFd = STDERR_FILENO + 1;

// The first byte of the child's answer. kError is followed by the message, kMesh by the numbers of
// vertices and triangles, their coordinates and their indices.
enum Answer : char { kError = 'e', kMesh = 't' };

std::atomic<bool> serves_mesh_reader{false};

std::string FailureText(const fs::path& path, const std::string& why) {
  return fmt::format("{}: {}; export it again, the surface alone", path.string(), why);
}

// ---- the child

void Limit(__rlimit_resource resource, rlim_t limit) {
  // The soft limit comes first: its SIGXCPU names the cause, the SIGKILL of the hard one does not.
  const rlimit soft_and_hard{limit, limit + 1};
  setrlimit(resource, &soft_and_hard);
}

// Keeps the output for the answer: the libraries write to both streams.
bool KeepOutputForAnswer() {
  if (dup2(STDOUT_FILENO, kAnswerFd) < 0) return false;
  const int nowhere = open("/dev/null", O_WRONLY);
  return dup2(nowhere, STDOUT_FILENO) >= 0 && dup2(nowhere, STDERR_FILENO) >= 0;
}

template <typename Item>
bool WriteItems(const std::vector<Item>& items) {
  return WriteAll(kAnswerFd, items.data(), items.size() * sizeof(Item));
}

bool WriteMesh(const TriangleMesh& mesh) {
  const Answer answer = kMesh;
  const std::array<std::uint64_t, 2> counts = {mesh.vertices_m.size(), mesh.triangles.size()};
  return WriteAll(kAnswerFd, &answer, 1) && WriteAll(kAnswerFd, counts.data(), sizeof(counts)) &&
         WriteItems(mesh.vertices_m) && WriteItems(mesh.triangles);
}

bool WriteFailure(std::string_view message) {
  const Answer answer = kError;
  return WriteAll(kAnswerFd, &answer, 1) && WriteAll(kAnswerFd, message.data(), message.size());
}

// The answer when memory runs out, made in advance, because making it allocates.
std::string memory_failure;

[[noreturn]] void EndForWantOfMemory() {
  _exit(WriteFailure(memory_failure) ? EXIT_SUCCESS : EXIT_FAILURE);
}

void LimitThisProcess(const fs::path& path, const MeshLimits& limits) {
  Limit(RLIMIT_CORE, 0);
  Limit(RLIMIT_CPU, static_cast<rlim_t>(limits.cpu_s));
#ifndef VELAMAP_SANITIZE  // the address sanitizer reserves terabytes
  Limit(RLIMIT_AS, limits.memory_bytes);
#endif
  memory_failure = FailureText(
      path, fmt::format("reading it takes more than {} MB of memory", limits.memory_bytes >> 20));
  // The libraries catch some exceptions and go on with half of the file.
  std::set_new_handler(EndForWantOfMemory);
}

bool ReadForParent(char** argv) {
  MeshReadOptions options;
  MeshLimits limits;
  double m_per_unit = 0.0;
  if (!ParseNumber(argv[3], &options.chord_deviation_mm) || !ParseNumber(argv[4], &m_per_unit) ||
      !ParseNumber(argv[5], &limits.cpu_s) || !ParseNumber(argv[6], &limits.memory_bytes)) {
    return false;
  }
  if (m_per_unit > 0) options.m_per_unit = m_per_unit;
  if (!KeepOutputForAnswer()) return false;
  LimitThisProcess(argv[2], limits);
  try {
    return WriteMesh(ParseMesh(argv[2], options));
  } catch (const InputError& error) {
    return WriteFailure(error.what());
  } catch (const std::bad_alloc&) {
    EndForWantOfMemory();
  }
}

// ---- the parent

// Lowers the limits below those of this process (ulimit), so that the child reaches its own first.
MeshLimits BelowOwnLimits(MeshLimits limits) {
  const auto below = [](__rlimit_resource resource, rlim_t limit) {
    rlimit own{};
    if (getrlimit(resource, &own) != 0 || own.rlim_cur > limit) return limit;
    return own.rlim_cur - std::min<rlim_t>(own.rlim_cur, 1);
  };
  limits.cpu_s = static_cast<int>(below(RLIMIT_CPU, static_cast<rlim_t>(limits.cpu_s)));
  limits.memory_bytes = below(RLIMIT_AS, limits.memory_bytes);
  return limits;
}

struct ChildAnswer {
  std::string bytes;
  int status;  // as of waitpid()
};

// Returns nothing if the child does not end in time or if its answer is too long.
std::optional<ChildAnswer> ReadAnswer(const ChildProcess& child, std::chrono::seconds limit) {
  constexpr std::size_t kMaxSize =
      kMaxMeshElements * (sizeof(Eigen::Vector3d) + sizeof(std::array<int, 3>)) + 1024;
  const auto deadline = std::chrono::steady_clock::now() + limit;
  ChildAnswer answer{};
  while (answer.bytes.size() <= kMaxSize) {
    const std::optional<std::string> more = child.Read(deadline);
    if (!more) return std::nullopt;
    if (!more->empty()) {
      answer.bytes += *more;
      continue;
    }
    const std::optional<int> status = child.Wait(deadline);
    if (!status) return std::nullopt;
    answer.status = *status;
    return answer;
  }
  return std::nullopt;
}

std::vector<std::string> OwnEnvironment() {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) variables.push_back(*variable);
  return variables;
}

template <typename Item>
void TakeItems(std::uint64_t count, std::string_view* bytes, std::vector<Item>* items) {
  static_assert(std::is_standard_layout_v<Item>);
  items->resize(count);
  std::memcpy(static_cast<void*>(items->data()), bytes->data(), count * sizeof(Item));
  bytes->remove_prefix(count * sizeof(Item));
}

// Returns nothing unless the bytes are a whole mesh: a damaged file may have made the child write
// anything.
std::optional<TriangleMesh> MeshFromBytes(std::string_view bytes) {
  TriangleMesh mesh;
  std::array<std::uint64_t, 2> counts{};
  if (bytes.size() < sizeof(counts)) return std::nullopt;
  std::memcpy(counts.data(), bytes.data(), sizeof(counts));
  bytes.remove_prefix(sizeof(counts));
  const auto [num_vertices, num_triangles] = counts;
  if (num_vertices > kMaxMeshElements || num_triangles > kMaxMeshElements ||
      bytes.size() !=
          num_vertices * sizeof(Eigen::Vector3d) + num_triangles * sizeof(std::array<int, 3>)) {
    return std::nullopt;
  }
  TakeItems(num_vertices, &bytes, &mesh.vertices_m);
  TakeItems(num_triangles, &bytes, &mesh.triangles);
  for (const auto& triangle : mesh.triangles) {
    for (const int vertex : triangle) {
      if (vertex < 0 || vertex >= static_cast<int>(num_vertices)) return std::nullopt;
    }
  }
  return mesh;
}

std::string TimeText(int limit_s) {
  return fmt::format("reading it takes more than {} s", limit_s);
}

// Why a child that has not answered ended.
std::string EndText(int status, const MeshLimits& limits) {
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal == SIGXCPU) return TimeText(limits.cpu_s);
  if (signal == SIGKILL) return "its reader was killed, perhaps because memory ran out";
  if (signal != 0) return fmt::format("its reader crashed on it ({})", strsignal(signal));
  return fmt::format("its reader ended without a mesh (status {})", WEXITSTATUS(status));
}

}  // namespace

void ServeMeshReader(int argc, char** argv) {
  serves_mesh_reader = true;
  if (argc != kNumArguments || std::strcmp(argv[1], kArgument) != 0) return;
  // No destructors: the libraries' own may crash after a bad file.
  _exit(ReadForParent(argv) ? EXIT_SUCCESS : EXIT_FAILURE);
}

TriangleMesh ParseMeshInChild(const fs::path& path, const MeshReadOptions& options,
                              const MeshLimits& wanted_limits) {
  VELAMAP_CHECK(serves_mesh_reader);
  const MeshLimits limits = BelowOwnLimits(wanted_limits);
  const auto fail = [&path](const std::string& why) { return InputError(FailureText(path, why)); };
  const ChildProcess child(
      {kProgram, kArgument, path.string(), fmt::format("{}", options.chord_deviation_mm),
       fmt::format("{}", options.m_per_unit.value_or(0.0)), fmt::format("{}", limits.cpu_s),
       fmt::format("{}", limits.memory_bytes)},
      OwnEnvironment());
  const auto answer = ReadAnswer(child, std::chrono::seconds(limits.wall_s));
  if (!answer) throw fail(TimeText(limits.wall_s));
  const std::string_view bytes = answer->bytes;
  if (!bytes.empty() && bytes.front() == kError) throw InputError(std::string(bytes.substr(1)));
  if (!bytes.empty() && bytes.front() == kMesh) {
    if (auto mesh = MeshFromBytes(bytes.substr(1))) return *std::move(mesh);
  }
  throw fail(EndText(answer->status, limits));
}

}  // namespace velamap
