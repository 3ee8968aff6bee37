#pragma once
/// The file service of a High Speed Ethernet Server. Source: docs/yaskawa-protocols.md 2.6.

#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/hses_session.hpp"

namespace pickcell::robot {

/// One thread at a time. Each call opens the port anew. Errors as in HsesSession; a transfer in which a block is lost
/// is broken off: the caller begins it again.
class HsesFiles {
 public:
  explicit HsesFiles(const HsesSettings& settings);

  /// Names that fit a pattern such as `*.JBI`.
  [[nodiscard]] core::Result<std::vector<std::string>> list(const std::string& pattern);
  /// At most 64 MB.
  [[nodiscard]] core::Result<std::string> save(const std::string& name);
  /// PC to controller. The text must not be empty (throws std::invalid_argument).
  [[nodiscard]] core::Status load(const std::string& name, const std::string& text);
  [[nodiscard]] core::Status remove(const std::string& name);

 private:
  [[nodiscard]] core::Result<std::string> download(HsesService service, const std::string& name);

  HsesSession session_;
};

}  // namespace pickcell::robot
