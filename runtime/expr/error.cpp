#include "expr/error.hpp"

#include <algorithm>
#include <utility>

#include "expr/words.hpp"

namespace lunid {
namespace {

std::string located(const std::string& message, const SourceSpan& where) {
  if (where.file.empty()) return message;
  std::string text = where.file + ":";
  if (where.line > 0) text += std::to_string(where.line) + ":";
  if (where.line > 0 && where.column > 0) text += std::to_string(where.column) + ":";
  return text + " " + message;
}

/// Optimal string alignment distance: insertions, deletions, replacements and swaps of two neighbours.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

/// Is `typed` what is left of the candidate where letters were skipped?
bool lacks_letters_of(const std::string& typed, const std::string& candidate) {
  std::size_t at = 0;
  for (const char letter : candidate) at += at < typed.size() && typed[at] == letter;
  return at == typed.size();
}

}  // namespace

InputError::InputError(std::string message, SourceSpan where, Fault fault)
    : std::runtime_error(located(message, where)),
      message_(std::move(message)),
      where_(std::move(where)),
      fault_(fault) {}

std::string nearest_word(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string typed = lower_case(word);
  // Two slips in a word of four letters leave another word.
  const std::size_t limit = word.size() < 5 ? 1 : std::max<std::size_t>(2, word.size() / 3);
  std::string best;
  std::size_t best_score = 0;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(typed, lower_case(candidate));
    // A word that shares no letter with the candidate is not near it, however short both are.
    if (distance > limit || distance >= std::max(word.size(), candidate.size())) continue;
    // Among equals the one with the same first letter: people mistype the middle of a word. Then the one that was
    // shortened: sgn is sign and not sin.
    const bool same_start = !typed.empty() && !candidate.empty() && typed[0] == lower_case(candidate)[0];
    const bool shortened = lacks_letters_of(typed, lower_case(candidate));
    const std::size_t score = 4 * distance + (same_start ? 0 : 2) + (shortened ? 0 : 1);
    if (best.empty() || score < best_score) best = candidate, best_score = score;
  }
  return best;
}

std::string did_you_mean(const std::string& near, char separator) {
  return near.empty() ? "" : separator + (" did you mean '" + near + "'?");
}

}  // namespace lunid
