#pragma once
// Texts that are nearly right: seeds with bytes put in, taken out, doubled and swapped. The same seed gives the same
// texts.
#include <algorithm>
#include <random>
#include <string>
#include <vector>

namespace lunid::test {

class Mutator {
 public:
  /// `words`: what is put in beside single bytes.
  Mutator(std::vector<std::string> seeds, std::vector<std::string> words, unsigned seed)
      : seeds_(std::move(seeds)), words_(std::move(words)), random_(seed) {}

  std::string next() {
    std::string text = seeds_[below(seeds_.size())];
    for (std::size_t change = 1 + below(3); change > 0; --change) mutate(text);
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(random_() % n); }

  void mutate(std::string& text) {
    const std::size_t at = below(text.size() + 1), length = std::min(text.size() - at, 1 + below(12));
    switch (below(5)) {
      case 0: text.insert(at, 1, static_cast<char>(below(256))); break;
      case 1: text.erase(at, length); break;
      case 2: text.insert(at, text.substr(at, length)); break;
      case 3: text.insert(at, words_[below(words_.size())]); break;
      default: {
        const std::string& other = seeds_[below(seeds_.size())];
        text = text.substr(0, at) + other.substr(below(other.size() + 1));
      }
    }
  }

  std::vector<std::string> seeds_, words_;
  std::mt19937 random_;
};

}  // namespace lunid::test
