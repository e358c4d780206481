#pragma once
// Records of the independent chains, and the models that a study has of them.
#include "discover_catalogue.hpp"
#include "truth/chain.hpp"

namespace lunid::testing {

inline Record record_of(const truth::ChainColumns& columns, const std::vector<int>& driven, const std::string& name) {
  std::vector<Channel> channels;
  for (std::size_t d = 0; d < driven.size(); ++d)
    channels.push_back(channel("F" + std::to_string(driven[d] + 1), "N", columns.F[d]));
  for (std::size_t i = 0; i < columns.y.size(); ++i)
    channels.push_back(channel("y" + std::to_string(i + 1), "m", columns.y[i]));
  return Record(name, columns.t.front(), columns.t[1] - columns.t[0], std::move(channels));
}

/// The chain as a study knows it: masses given, one k and c for all links, and what `extra` adds to each row.
inline Model baseline_of(const truth::Chain& chain, const truth::Scale& scale,
                         const std::vector<std::string>& extra = {}) {
  Model model;
  model.pool = std::make_shared<Pool>();
  const std::size_t n = chain.masses.size();
  std::vector<std::string> rows(n);
  for (std::size_t i = 0; i < extra.size(); ++i) rows[i] = extra[i] + " + ";
  const auto text = [](char quantity, int mass) { return quantity + std::to_string(mass + 1); };
  for (const truth::Link& link : chain.links) {
    if (link.k == 0) continue;
    for (const int side : {link.of, link.from}) {
      if (side < 0) continue;
      const int other = side == link.of ? link.from : link.of;
      for (const auto& [parameter, quantity] : {std::pair{"k*", 'y'}, std::pair{"c*", 'v'}})
        rows[static_cast<std::size_t>(side)] +=
            parameter +
            (other < 0 ? text(quantity, side) : "(" + text(quantity, side) + " - " + text(quantity, other) + ")") +
            " + ";
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Expr mass = model.pool->constant(chain.masses[i] * scale.mass);
    const Expr force = parse(*model.pool, rows[i].substr(0, rows[i].size() - 3));
    if (i == 0) {
      model.mass = mass;
      model.restoring = force;
    } else {
      model.further.push_back({mass, force});
    }
  }
  model.driven = chain.driven;
  return model;
}

}  // namespace lunid::testing
