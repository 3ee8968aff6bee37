#pragma once
/// A MODEL of the command line: a PART.pcm, or a bare picture that is taught on the fly.

#include <optional>
#include <string>

#include "pickcell/core/result.hpp"
#include "pickcell/matches/teach.hpp"

namespace pickcell::cli {

/// How a bare picture is taught.
struct BareTemplate {
  std::string mask_file;  ///< empty: none
  matches::Range angle_deg{-180, 180};
  matches::Range scale{1, 1};
};

/// Told apart by content; whatever is called *.pcm is read as a model. Errors name the file.
[[nodiscard]] core::Result<matches::Model> load_model_or_template(const std::string& file, const BareTemplate& how);

/// As load_model_or_template does with pictures; name: the file's stem unless given.
[[nodiscard]] core::Result<matches::Taught> teach_file(const std::string& file, const std::string& mask_file,
                                                       matches::TeachInput how);

/// Now, ISO 8601 in UTC.
[[nodiscard]] std::string utc_now();

}  // namespace pickcell::cli
