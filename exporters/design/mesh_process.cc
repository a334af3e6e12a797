#include "exporters/design/mesh_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "exporters/design/mesh_parser.h"
#include "importer/base/error.h"
#include "importer/base/numbers.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr char kProgram[] = "/proc/self/exe";
constexpr char kArgument[] = "read_mesh_for_parent";
constexpr int kNumArguments = 7;  // program, kArgument, path, chord, unit, seconds, bytes
constexpr int kAnswerFd = STDERR_FILENO + 1;

// The first byte of the child's answer. kError is followed by the message, kMesh by the numbers of
// vertices and triangles, their coordinates and their indices.
enum Answer : char { kError = 'e', kMemory = 'm', kMesh = 't' };

std::atomic<bool> serves_mesh_reader{false};

// ---- the child

void Limit(__rlimit_resource resource, rlim_t limit) {
  const rlimit soft_and_hard{limit, limit + 1};  // the signal of the hard one does not say why
  setrlimit(resource, &soft_and_hard);
}

void LimitThisProcess(const MeshLimits& limits) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  Limit(RLIMIT_CORE, 0);
  Limit(RLIMIT_CPU, static_cast<rlim_t>(limits.cpu_s));
#ifndef VELAMAP_SANITIZE  // the address sanitizer reserves terabytes
  Limit(RLIMIT_AS, limits.memory_bytes);
#endif
}

bool WriteAll(const void* data, std::size_t size) {
  const char* rest = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t written = write(kAnswerFd, rest, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    rest += written;
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

template <typename Item>
bool WriteItems(const std::vector<Item>& items) {
  return WriteAll(items.data(), items.size() * sizeof(Item));
}

bool WriteMesh(const TriangleMesh& mesh) {
  const Answer answer = kMesh;
  const std::array<std::uint64_t, 2> counts = {mesh.vertices_m.size(), mesh.triangles.size()};
  return WriteAll(&answer, 1) && WriteAll(counts.data(), sizeof(counts)) &&
         WriteItems(mesh.vertices_m) && WriteItems(mesh.triangles);
}

bool WriteFailure(Answer answer, std::string_view message) {
  return WriteAll(&answer, 1) && WriteAll(message.data(), message.size());
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
  LimitThisProcess(limits);
  try {
    return WriteMesh(ParseMesh(argv[2], options));
  } catch (const InputError& error) {
    return WriteFailure(kError, error.what());
  } catch (const std::bad_alloc&) {
    return WriteFailure(kMemory, "");
  }
}

// ---- the parent

class Child {
 public:
  explicit Child(std::vector<std::string> arguments) {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) Fail(errno);
    read_end_ = ends[0];
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], kAnswerFd);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {  // the libraries write to both
      posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
    }
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    const int error = posix_spawn(&pid_, kProgram, &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    if (error != 0) {
      close(read_end_);
      Fail(error);
    }
  }
  ~Child() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      Wait();
    }
    close(read_end_);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // Nothing if the child does not end in time or answers without end.
  std::optional<std::string> ReadAnswer(std::chrono::seconds limit) const {
    constexpr std::size_t kMaxSize =
        kMaxMeshElements * (sizeof(Eigen::Vector3d) + sizeof(std::array<int, 3>)) + 1024;
    const Clock::time_point end = Clock::now() + limit;
    std::string answer;
    std::vector<char> buffer(1 << 16);
    while (answer.size() <= kMaxSize) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
      pollfd waited{read_end_, POLLIN, 0};
      const int num_ready = left.count() > 0 ? poll(&waited, 1, static_cast<int>(left.count())) : 0;
      if (num_ready == 0) return std::nullopt;
      const ssize_t size = num_ready < 0 ? -1 : read(read_end_, buffer.data(), buffer.size());
      if (size < 0 && errno == EINTR) continue;
      if (size <= 0) return answer;
      answer.append(buffer.data(), static_cast<std::size_t>(size));
    }
    return std::nullopt;
  }

  // The status of waitpid().
  int Wait() {
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
  }

 private:
  [[noreturn]] static void Fail(int error) {
    throw std::system_error(error, std::generic_category(),
                            "a process that reads meshes cannot be started");
  }

  int read_end_ = -1;
  pid_t pid_ = -1;
};

template <typename Item>
void TakeItems(std::uint64_t count, std::string_view* bytes, std::vector<Item>* items) {
  static_assert(std::is_standard_layout_v<Item>);
  items->resize(count);
  std::memcpy(static_cast<void*>(items->data()), bytes->data(), count * sizeof(Item));
  bytes->remove_prefix(count * sizeof(Item));
}

// Nothing unless the bytes are a whole mesh: a damaged file may have made the child write anything.
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

std::string MemoryText(const MeshLimits& limits) {
  return fmt::format("reading it takes more than {} MB of memory", limits.memory_bytes >> 20);
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
                              const MeshLimits& limits) {
  VELAMAP_CHECK(serves_mesh_reader);
  const auto fail = [&path](const std::string& why) -> InputError {
    return InputError(
        fmt::format("{}: {}; export it again, the surface alone", path.string(), why));
  };
  Child child({"velamap", kArgument, path.string(), fmt::format("{}", options.chord_deviation_mm),
               fmt::format("{}", options.m_per_unit.value_or(0.0)), fmt::format("{}", limits.cpu_s),
               fmt::format("{}", limits.memory_bytes)});
  const auto answer = child.ReadAnswer(std::chrono::seconds(limits.wall_s));
  if (!answer) throw fail(TimeText(limits.wall_s));
  const int status = child.Wait();
  const std::string_view bytes = *answer;
  if (!bytes.empty() && bytes.front() == kError) throw InputError(answer->substr(1));
  if (!bytes.empty() && bytes.front() == kMemory) throw fail(MemoryText(limits));
  if (!bytes.empty() && bytes.front() == kMesh) {
    if (auto mesh = MeshFromBytes(bytes.substr(1))) return *std::move(mesh);
  }
  throw fail(EndText(status, limits));
}

}  // namespace velamap
