#include "regress/lag.hpp"

#include <algorithm>
#include <charconv>

namespace lunid {

namespace {
constexpr std::string_view kMark = "_lag";
}

Expr lag(Expr signal, int samples) {
  if (!signal.is_symbol() || signal.kind() != SymbolKind::channel || lag_of(signal.name()))
    throw InputError("lag: expected a signal, such as lunid.displacement, got '" + to_text(signal) + "'");
  if (samples < 1) throw InputError("lag: samples: expected >= 1, got " + std::to_string(samples));
  return signal.pool().channel(signal.name() + std::string(kMark) + std::to_string(samples));
}

std::optional<Lag> lag_of(std::string_view channel) {
  const auto mark = channel.rfind(kMark);
  if (mark == std::string_view::npos || mark == 0) return std::nullopt;
  const std::string_view digits = channel.substr(mark + kMark.size());
  Lag out{std::string(channel.substr(0, mark)), 0};
  const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), out.samples);
  if (end.ec != std::errc() || end.ptr != digits.data() + digits.size() || out.samples < 1) return std::nullopt;
  return out;
}

int largest_lag(const std::vector<Expr>& expressions) {
  int largest = 0;
  for (const Expr& expression : expressions)
    for (const Expr& s : symbols(expression, SymbolKind::channel))
      if (const auto found = lag_of(s.name())) largest = std::max(largest, found->samples);
  return largest;
}

std::string first_lag(Expr expression) {
  for (const Expr& s : symbols(expression, SymbolKind::channel))
    if (lag_of(s.name())) return s.name();
  return "";
}

}  // namespace lunid
