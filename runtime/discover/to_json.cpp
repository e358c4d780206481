// discovery.json (contract: schema 1; fields are only added). Every null has a reason beside it.
#include <cmath>
#include <nlohmann/json.hpp>

#include "discover/discover.hpp"

namespace lunid {

namespace {

using nlohmann::json;

json number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

json parameters(const std::vector<Parameter>& table) {
  json out = json::object();
  for (const auto& p : table) {
    json row = {{"value", number(p.value)}, {"std", number(p.std)}, {"unit", p.unit}};
    if (!std::isfinite(p.value)) row["reason"] = "no first guess was given";
    if (std::isfinite(p.std)) {
      row["interval"] = {p.value - 1.96 * p.std, p.value + 1.96 * p.std};
    } else {
      row["std_reason"] =
          p.fixed ? "held, not fitted" : "no standard deviation: not fitted, not seen by the data, or not identifiable";
    }
    out[p.name] = std::move(row);
  }
  return out;
}

void put_gap(json& out, const char* key, const Gap& gap) {
  out[key] = number(gap.value);
  if (!std::isfinite(gap.value)) {
    out["stopped_at"] = gap.stopped_at;
    out["cause"] = gap.cause.empty() ? "the free run is not finite" : gap.cause;
  }
}

void put_gaps(json& out, const Gap& train, const Gap& test) {
  put_gap(out, "gap_train", train);
  put_gap(out, "gap_test", test);
}

json model(const Model& m, const Gap& train, const Gap& test) {
  json out = {{"equation", m.equation()}, {"parameters", parameters(m.parameters)}};
  put_gaps(out, train, test);
  return out;
}

const char* what_it_is(const std::string& family) {
  return family == "sensor"  ? "the sensor, not the physics"
         : family == "input" ? "the input, not the physics"
                             : "physics";
}

json effect(const NamedEffect& e) {
  json out = {{"name", e.name},
              {"family", e.family},
              {"is", what_it_is(e.family)},
              {"formula", e.formula},
              {"parameters", parameters(e.parameters)},
              {"indistinguishable", e.indistinguishable},
              {"same_force", e.same_force},
              {"where", e.where},
              {"sentence", e.sentence},
              {"p_value", e.p_value},
              {"gap_train", number(e.gap_train)},
              {"gap_test", number(e.gap_test)}};
  if (!std::isfinite(e.gap_train) || !std::isfinite(e.gap_test))
    out["cause"] = "the free run of this step stopped early";
  if (!e.place.empty()) {
    out["place"] = e.place;
    out["label"] = e.label;
  }
  return out;
}

json rival(const Rival& r) {
  json out = {{"name", r.name},
              {"gap", number(r.gap)},
              {"log_likelihood", number(r.log_likelihood)},
              {"p_value", r.p_value},
              {"remark", r.remark}};
  if (!std::isfinite(r.gap)) out["cause"] = "its free run stopped early";
  return out;
}

json naming(const Naming& n) {
  json counts = json::array();
  for (const auto& [name, count] : n.counts) counts.push_back({{"name", name}, {"count", count}});
  return {{"resamples", n.resamples},
          {"counts", std::move(counts)},
          {"meaning",
           "the choice among the judged sets made again on resampled blocks of the training records, refits to first "
           "order"}};
}

json closed_loop(const ClosedLoop& loop) {
  json out = {{"sentence", sentence_of(loop)},
              {"answer", loop.answer},
              {"meaning",
               "answer: share of what is new in the force that follows what the final model leaves of the motion; "
               "force: F - m a - f along the smoothed measured motion over the force's standard deviation; one_step: "
               "prediction from each row to the next over that of the motion"}};
  if (!loop.reference.empty()) {
    out["reference"] = loop.reference;
    out["by_instruments"] = parameters(loop.by_instruments);
    if (loop.by_instruments.empty())
      out["by_instruments_reason"] = "the reference does not tell the parameters apart, or a reading is falsified";
  }
  const auto gaps = [&loop](double OtherGaps::*which) {
    const auto row = [which](const OtherGaps& before, const OtherGaps& after) {
      json out = {{"before", number(before.*which)}, {"after", number(after.*which)}};
      if (!std::isfinite(before.*which) || !std::isfinite(after.*which))
        out["reason"] = "not asked: internal states, several coordinates, or y not measured";
      return out;
    };
    return json{{"train", row(loop.baseline_train, loop.final_train)},
                {"test", row(loop.baseline_test, loop.final_test)}};
  };
  out["force"] = gaps(&OtherGaps::force);
  out["one_step"] = gaps(&OtherGaps::one_step);
  return out;
}

json removable(const std::vector<Removable>& terms) {
  json out = json::array();
  for (const auto& t : terms)
    out.push_back({{"parameter", t.parameter},
                   {"term", t.term},
                   {"value", number(t.value)},
                   {"std", number(t.std)},
                   {"p_value", t.p_value},
                   {"reason", t.reason}});
  return out;
}

template <class Values>
json list(const Values& values) {
  json out = json::array();
  for (const double x : values) out.push_back(number(x));
  return out;
}

json table(const Eigen::MatrixXd& values) {
  json out = json::array();
  for (Eigen::Index i = 0; i < values.rows(); ++i) out.push_back(list(values.row(i)));
  return out;
}

json binned(const BinnedMap& map) {
  return {{"x", list(map.x)},         {"unit", map.unit},       {"value", list(map.value)}, {"level", list(map.level)},
          {"value_is", map.value_is}, {"rows", list(map.rows)}, {"above", map.any_above()}, {"sentence", map.sentence}};
}

json residual_maps(const ResidualMaps& maps) {
  json out = {{"sentence", maps.sentence}, {"no_data", maps.no_data}};
  for (const BinnedMap& map : maps.maps) out[map.over] = binned(map);
  out["phase_plane"] = {{"y", list(maps.plane.y)},           {"v", list(maps.plane.v)},
                        {"value", table(maps.plane.before)}, {"level", table(maps.plane_level)},
                        {"rows", table(maps.plane.count)},   {"sentence", maps.plane_sentence}};
  json slow = {{"time", list(maps.slow.time)}, {"sentence", maps.slow.sentence}};
  for (int j = 0; j < 3; ++j)
    slow[SlowTime::names[j]] = {{"value", list(maps.slow.value.col(j))},
                                {"std", list(maps.slow.std.col(j))},
                                {"changes", maps.slow.changes[j]}};
  out["slow_time"] = std::move(slow);
  return out;
}

json residual_maps(const Discovery& d) {
  json out = {{"place", d.map_place},
              {"reason", "a bin of a map is null where few rows of the training records lie in it, or of few periods"},
              {"meaning",
               "force left unexplained along the smoothed measured motion of the training records, by the baseline "
               "(before) and by the final model (after, where something was named); level: noise of any colour alone "
               "stays below in all bins of a map at once, 95 %; slow_time: offset and slopes in y and v of what no "
               "function of y and v explains, over parts of the records"}};
  if (d.maps_before)
    out["before"] = residual_maps(*d.maps_before);
  else
    out["before_reason"] = no_residual_maps;
  if (d.maps_after) out["after"] = residual_maps(*d.maps_after);
  return out;
}

/// Cells without data are null.
json unknown_force(const UnknownForce& u) {
  json harmonics = json::array();
  for (std::size_t k = 0; k < u.harmonics.size(); ++k)
    harmonics.push_back(
        {{"order", k}, {"amplitude", number(u.harmonics[k].amplitude)}, {"level", number(u.harmonics[k].level)}});
  return {{"harmonics", std::move(harmonics)},
          {"y", list(u.y)},
          {"v", list(u.v)},
          {"force", table(u.force)},
          {"of", u.closure ? "closure" : "residual"},
          {"reason", "a cell of the force is null where no row of the training records lies in it"},
          {"meaning",
           std::string("mean force over the cells of displacement (rows) and velocity (columns) of ") +
               (u.closure ? "forces without a name that were fitted (closure)" : "what the baseline leaves") +
               "; harmonics of what the baseline leaves over the phase of the motion, level: noise alone, 95 %"}};
}

}  // namespace

json to_json(const ExperimentDesign& design) {
  json candidates = json::array();
  for (const auto& c : design.candidates) {
    json row = {{"name", c.name},
                {"what", c.words},
                {"separation", number(c.separation)},
                {"expected_z", number(c.expected_z)},
                {c.excitation.has("F") ? "force" : "displacement", c.level},
                {"motion", c.peak}};
    json pairs = json::array();
    for (const auto& p : c.pairs)
      pairs.push_back({{"a", design.rivals[static_cast<std::size_t>(p.a)]},
                       {"b", design.rivals[static_cast<std::size_t>(p.b)]},
                       {"separation", number(p.separation)}});
    row["pairs"] = std::move(pairs);
    if (!c.remark.empty()) row["reason"] = c.remark;
    candidates.push_back(std::move(row));
  }
  return {{"sentence", sentence_of(design)},
          {"decides", design.best().decides()},
          {"rivals", design.rivals},
          {"noise", design.options.noise},
          {"duration", design.options.duration},
          {"rate", design.options.rate},
          {"meaning", "separation: rms difference after each rival's best refit to the other, over the noise"},
          {"candidates", std::move(candidates)}};
}

json to_json(const Discovery& d) {
  json out = {{"schema", 1}, {"verdict", to_string(d.verdict)}, {"sentence", d.sentence}, {"where", d.where}};
  out["records"] = json::array();
  for (const auto& r : d.records)
    out["records"].push_back({{"record", r.record},
                              {"role", r.role},
                              {"rows", r.rows},
                              {"duration", r.seconds},
                              {"rate", r.rate},
                              {"runs", r.runs},
                              {"joined", r.joined}});
  out["units"] = {{"y", d.units.y}, {"v", d.units.v}, {"a", d.units.a}, {"F", d.units.force}};
  out["baseline"] = model(d.baseline, d.baseline_train, d.baseline_test);
  out["baseline"]["first_guess"] = parameters(d.baseline_before);
  out["effects"] = json::array();
  for (const auto& e : d.effects) out["effects"].push_back(effect(e));
  out["rivals"] = json::array();
  for (const auto& r : d.rivals) out["rivals"].push_back(rival(r));
  out["final"] = model(d.final, d.final_train, d.final_test);
  out["final"]["gap_fit"] = number(d.gap_fit);
  out["residual_maps"] = residual_maps(d);
  if (d.unknown) {
    out["unknown_force"] = unknown_force(*d.unknown);
    if (const auto& closure = d.unknown->closure) {
      out["closure"] = model(closure->model, closure->train, closure->test);
      out["closure"]["force_between_samples"] = closure->interpolation;
      out["closure"]["meaning"] =
          "the baseline with forces without a name, fitted: what is missing may be simulated so";
    }
  }
  out["noise_floor"] = {{"gap_train", number(d.final_train.floor)},
                        {"gap_test", number(d.final_test.floor)},
                        {"std", number(std::max(d.final_train.floor_std, d.final_test.floor_std))},
                        {"read_off", d.noise_has_colour ? "what the final run leaves beside the band of its own motion"
                                                        : "the quietest band of the spectrum"}};
  if (!std::isfinite(d.final_train.floor) || !std::isfinite(d.final_test.floor))
    out["noise_floor"]["reason"] = "the final model's run stopped early";
  for (const auto& o : d.outputs) {
    json row = {{"output", o.output}};
    put_gaps(row["baseline"], o.baseline_train, o.baseline_test);
    put_gaps(row["final"], o.final_train, o.final_test);
    row["noise_floor"] = {{"gap_train", number(o.final_train.floor)}, {"gap_test", number(o.final_test.floor)}};
    out["outputs"].push_back(std::move(row));
  }
  out["test_chose"] = d.test_chose;
  if (d.short_test.seconds > 0)
    out["short_test"] = {{"run_length", d.short_test.seconds},
                         {"gap_before", number(d.short_test.baseline.value)},
                         {"gap_after", number(d.short_test.final.value)},
                         {"noise_floor", number(d.short_test.final.floor)},
                         {"meaning",
                          "free runs of this length over the test records, each from a first state of its "
                          "own: over the whole of them noise alone loses the motion"}};
  out["left_out"] = {{"gap_before", number(d.gap_left_out_before)},
                     {"gap_after", number(d.gap_left_out_after)},
                     {"meaning", "free runs, rows of the training records that the fit did not see"}};
  if (!std::isfinite(d.gap_left_out_before) || !std::isfinite(d.gap_left_out_after))
    out["left_out"]["reason"] = "a free run stopped early";
  if (d.naming.resamples > 0) out["naming"] = naming(d.naming);
  out["removable"] = removable(d.removable);
  if (d.loop) out["closed_loop"] = closed_loop(*d.loop);
  if (!d.experiment.empty()) out["next_experiment"] = to_json(d.experiment);
  out["test_p_value"] = d.test_p_value;
  out["warnings"] = d.warnings;
  out["method"] = {
      {"gap",
       "RMSE of the free-run output over the standard deviation of the measured one, first state from a lead-in"},
      {"output", d.output},
      {"force_between_samples", d.interpolation},
      {"solver", d.solver},
      {"noise", d.noise_model}};
  if (d.run_length > 0) out["method"]["run_length"] = d.run_length;
  if (!d.check_solver.empty())
    out["method"]["check"] = {
        {"solver", d.check_solver},
        {"largest_difference", number(d.check_error)},
        {"meaning",
         "integration only: same tape, same force between samples; over the standard deviation of the output"}};
  out["seconds"] = d.seconds;
  return out;
}

}  // namespace lunid
