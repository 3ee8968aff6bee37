#pragma once
/// Noise for codecs and servers: random bytes, and valid messages with a few bytes changed.

#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>
#include <string_view>

namespace pickcell::testing_noise {

/// Through each codec; PICKCELL_RANDOM_MESSAGES asks for more.
inline const int kMessages = [] {
  const char* asked = std::getenv("PICKCELL_RANDOM_MESSAGES");
  return asked ? std::atoi(asked) : 30'000;
}();

class Noise {
 public:
  explicit Noise(unsigned seed) : random_(seed) {}
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(random_() % n); }
  std::uint32_t word() { return static_cast<std::uint32_t>(random_()); }
  bool coin() { return random_() % 2 == 0; }
  std::string bytes(std::size_t most, std::string_view alphabet = {}) {
    std::string out(below(static_cast<std::uint32_t>(most) + 1), '\0');
    for (char& c : out)
      c = alphabet.empty() ? static_cast<char>(random_())
                           : alphabet[below(static_cast<std::uint32_t>(alphabet.size()))];
    return out;
  }
  /// One to four changes: another byte, a byte less, a byte more.
  std::string changed(std::string text) {
    for (std::uint32_t n = 1 + below(4); n > 0 && !text.empty(); --n) {
      const std::size_t at = below(static_cast<std::uint32_t>(text.size()));
      switch (below(3)) {
        case 0:
          text[at] = static_cast<char>(random_());
          break;
        case 1:
          text.erase(at, 1);
          break;
        default:
          text.insert(at, 1, static_cast<char>(random_()));
      }
    }
    return text;
  }

 private:
  std::mt19937 random_;
};

}  // namespace pickcell::testing_noise
