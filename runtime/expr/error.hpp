#pragma once
// The one exception type for bad input. Everything that a person has to mend is an InputError; failing to
// converge is a result (a Summary), not an exception.
#include <stdexcept>
#include <string>
#include <vector>

namespace lunid {

/// Where the fault lies. `line` and `column` are 1-based; 0 means unknown.
struct SourceSpan {
  std::string file;
  int line = 0;
  int column = 0;
};

/// What kind of fault: decides the exit code of the command line (1 study, 2 usage, 3 data, 130 interrupted).
enum class Fault { study = 1, usage = 2, data = 3, interrupted = 130 };

/// Bad input: `message` says what was expected, what came and what to do; what() prefixes `file:line: `.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::string message, SourceSpan where = {}, Fault fault = Fault::study);
  const std::string& message() const { return message_; }
  const SourceSpan& where() const { return where_; }
  Fault fault() const { return fault_; }

 private:
  std::string message_;
  SourceSpan where_;
  Fault fault_;
};

/// The candidate nearest to `word` by edit distance, or "" when none is near.
std::string nearest_word(const std::string& word, const std::vector<std::string>& candidates);

/// What a message adds for a word that is near: ", did you mean 'y'?", behind a list with a semicolon; "" for "".
std::string did_you_mean(const std::string& near, char separator = ',');

}  // namespace lunid
