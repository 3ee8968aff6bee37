#pragma once
/// PART.pcm: a Model on disk. Little-endian, IEEE doubles, no padding; the same bytes on every machine:
///
///     8 bytes   89 'P' 'C' 'M' 0D 0A 1A 0A     (a text-mode copy breaks it visibly, as with PNG)
///     u32       version
///     u32       length of the payload
///     payload   the fields of Model in order; strings and lists are preceded by their u32 length
///     u32       CRC-32 of everything before it
///
/// Unknown versions, damage and values that no taught model can have are refused with the reason. Thread-safe.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/matches/model.hpp"

namespace pickcell::matches {

constexpr std::uint32_t kModelFileVersion = 1;

/// True when the bytes begin like a PART.pcm of any version.
[[nodiscard]] bool looks_like_model(std::span<const std::byte> bytes);

[[nodiscard]] std::vector<std::byte> encode_model(const Model& model);
/// name: how errors call the bytes.
[[nodiscard]] core::Result<Model> decode_model(std::span<const std::byte> bytes, const std::string& name);

[[nodiscard]] core::Result<Model> load_model(const std::filesystem::path& path);
/// Atomic: the old file or the new one, never half.
[[nodiscard]] core::Status save_model(const std::filesystem::path& path, const Model& model);

}  // namespace pickcell::matches
