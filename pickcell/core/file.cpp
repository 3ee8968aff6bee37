#include "pickcell/core/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace pickcell::core {

namespace {

std::string reason(int error) { return std::strerror(error); }

/// Closes on scope exit.
struct Descriptor {
  int fd;
  explicit Descriptor(int opened) : fd(opened) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
};

template <class Buffer>
Result<Buffer> read_into(const std::filesystem::path& path, std::size_t limit_bytes) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.fd < 0) return failure(ErrorCode::unreadable, path.string(), reason(errno), "check the path");
  struct stat info{};
  if (::fstat(file.fd, &info) != 0) return failure(ErrorCode::unreadable, path.string(), reason(errno));
  if (!S_ISREG(info.st_mode)) return failure(ErrorCode::unreadable, path.string(), "not a regular file", "name a file");
  if (static_cast<std::size_t>(info.st_size) > limit_bytes)
    return failure(ErrorCode::unreadable, path.string(), "larger than " + std::to_string(limit_bytes) + " bytes");
  Buffer out(static_cast<std::size_t>(info.st_size), {});
  std::size_t done = 0;
  while (done < out.size()) {
    const ssize_t n = ::read(file.fd, out.data() + done, out.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return failure(ErrorCode::unreadable, path.string(), reason(errno));
    if (n == 0) break;
    done += static_cast<std::size_t>(n);
  }
  out.resize(done);
  return out;
}

tl::unexpected<Error> write_failure(const std::filesystem::path& path, int error) {
  return failure(ErrorCode::unreadable, path.string(), "cannot be written: " + reason(error),
                 error == ENOSPC ? "free space on the disk" : "check the folder and its permissions");
}

}  // namespace

Result<std::vector<std::byte>> read_file(const std::filesystem::path& path, std::size_t limit_bytes) {
  return read_into<std::vector<std::byte>>(path, limit_bytes);
}

Result<std::string> read_text_file(const std::filesystem::path& path, std::size_t limit_bytes) {
  return read_into<std::string>(path, limit_bytes);
}

namespace {

/// Where the bytes really go: a link stays a link, and what is no file (a device, a folder) is not replaced by one.
Result<std::filesystem::path> real_target(const std::filesystem::path& path) {
  std::error_code problem;
  const std::filesystem::path real = std::filesystem::weakly_canonical(path, problem);
  if (problem) return failure(ErrorCode::unreadable, path.string(), problem.message(), "check the path");
  const auto status = std::filesystem::status(real, problem);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    return failure(ErrorCode::unreadable, path.string(), "is there and is no file", "name a file");
  return real;
}

}  // namespace

Status write_file_atomically(const std::filesystem::path& wanted, std::span<const std::byte> bytes) {
  const auto target = real_target(wanted);
  if (!target) return tl::unexpected(target.error());
  const std::filesystem::path& path = *target;
  std::string temporary = path.string() + ".XXXXXX";
  const Descriptor file(::mkostemp(temporary.data(), O_CLOEXEC));
  if (file.fd < 0) return write_failure(path, errno);
  const auto give_up = [&](int error) {
    ::unlink(temporary.c_str());
    return write_failure(path, error);
  };
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::write(file.fd, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return give_up(errno);
    done += static_cast<std::size_t>(n);
  }
  if (::fchmod(file.fd, 0644) != 0 || ::fsync(file.fd) != 0) return give_up(errno);
  if (::rename(temporary.c_str(), path.c_str()) != 0) return give_up(errno);
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  const Descriptor directory(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (directory.fd >= 0) ::fsync(directory.fd);  // makes the rename itself durable; best effort on odd file systems
  return {};
}

Status write_file_atomically(const std::filesystem::path& path, std::string_view text) {
  return write_file_atomically(path, std::as_bytes(std::span(text)));
}

std::uint32_t crc32(std::span<const std::byte> bytes) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t c = i;
      for (int k = 0; k < 8; ++k) c = (c & 1u) ? 0xEDB88320u ^ (c >> 1) : c >> 1;
      t[i] = c;
    }
    return t;
  }();
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const std::byte b : bytes) crc = table[(crc ^ std::to_integer<std::uint32_t>(b)) & 0xFFu] ^ (crc >> 8);
  return crc ^ 0xFFFFFFFFu;
}

}  // namespace pickcell::core
