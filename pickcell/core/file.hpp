#pragma once
/// Whole files: read with a limit, written so that a reader sees the old content or the new, never half of it.

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"

namespace pickcell::core {

/// Refuses directories, missing files and files larger than limit_bytes, naming the file and the reason.
[[nodiscard]] Result<std::vector<std::byte>> read_file(const std::filesystem::path& path,
                                                       std::size_t limit_bytes = std::size_t{1} << 30);
[[nodiscard]] Result<std::string> read_text_file(const std::filesystem::path& path,
                                                 std::size_t limit_bytes = std::size_t{64} << 20);

/// Writes to a temporary file beside path, flushes it to the disk and renames it: a full disk or a power cut leaves the
/// old file as it was.
[[nodiscard]] Status write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes);
[[nodiscard]] Status write_file_atomically(const std::filesystem::path& path, std::string_view text);

/// CRC-32 (IEEE 802.3, reflected 0xEDB88320), as in zip and PNG.
[[nodiscard]] std::uint32_t crc32(std::span<const std::byte> bytes);

}  // namespace pickcell::core
