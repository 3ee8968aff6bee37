#pragma once
/// What names one camera among all, shared by all its frames: copying it allocates nothing.

#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace pickcell::frames {

/// Reads as a string; never changed once made. Thread-safe as a shared_ptr is.
class CameraId {
 public:
  CameraId() = default;
  CameraId(std::string text) : text_(std::make_shared<const std::string>(std::move(text))) {}
  CameraId(const char* text) : CameraId(std::string(text)) {}

  [[nodiscard]] const std::string& str() const {
    static const std::string none;
    return text_ ? *text_ : none;
  }
  operator const std::string&() const { return str(); }
  friend bool operator==(const CameraId& a, std::string_view b) { return a.str() == b; }

 private:
  std::shared_ptr<const std::string> text_;
};

}  // namespace pickcell::frames
