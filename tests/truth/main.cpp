// lunid_truth: writes records with a hidden effect.
//   lunid_truth list
//   lunid_truth CASE SCALE NOISE_DB SEED OUT_DIR [ROWS] train.csv and test.csv in SI
//   lunid_truth fault NAME SCALE NOISE_DB SEED OUT_DIR  the same of a faulty sensor or input
//   lunid_truth chain NAME SCALE NOISE_DB SEED OUT_DIR  the same of several masses
//   lunid_truth demo OUT_DIR                            the record that the repository ships
//   (tests/data/README.md)
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>

#include "truth/chain.hpp"
#include "truth/faults.hpp"
#include "truth/truth.hpp"

namespace {

void list() {
  for (const truth::Case& each : truth::cases()) {
    std::printf("%-20s baseline %s\n", each.name.c_str(), each.baseline.c_str());
  }
  for (const truth::Fault& each : truth::faults()) std::printf("fault %s\n", each.name.c_str());
  for (const truth::ChainCase& each : truth::chain_cases()) std::printf("chain %s\n", each.name.c_str());
}

void write_case(const std::string& name, const std::string& scale_name, double noise_db, long seed,
                const std::string& out, int rows) {
  const truth::Scale& scale = truth::scale_named(scale_name);
  truth::RecordOptions options;
  options.rows = rows;
  options.noise_db = noise_db;
  options.seed = static_cast<std::uint64_t>(seed);
  const truth::Case& which = truth::case_named(name);
  const truth::Records records = truth::make_records(which, scale, options);
  std::filesystem::create_directories(out);
  truth::write_csv(records.train, out + "/train.csv");
  truth::write_csv(records.test, out + "/test.csv");
  std::printf("%s: mass %g kg, baseline %s, hidden share %.2f (train) %.2f (test), stuck %.2f\n", name.c_str(),
              scale.mass, which.baseline.c_str(), records.train.hidden_share, records.test.hidden_share,
              records.train.stuck_share);
  for (const truth::TrueParameter& p : which.parameters) {
    std::printf("  %s %s = %.6g\n", p.effect.c_str(), p.name.c_str(), p.in(scale));
  }
}

void write_fault(const std::string& name, const std::string& scale_name, double noise_db, long seed,
                 const std::string& out) {
  truth::RecordOptions options;
  options.noise_db = noise_db;
  options.seed = static_cast<std::uint64_t>(seed);
  const truth::Scale& scale = truth::scale_named(scale_name);
  const truth::FaultyRecords records = truth::make_faulty(truth::fault_named(name), scale, options);
  std::filesystem::create_directories(out);
  truth::write_csv(records.train, out + "/train.csv");
  truth::write_csv(records.test, out + "/test.csv");
  std::printf("%s: mass %g kg, baseline %s\n", name.c_str(), scale.mass, records.baseline.c_str());
}

void write_chain(const std::string& name, const std::string& scale_name, double noise_db, long seed,
                 const std::string& out) {
  truth::RecordOptions options;
  options.rows = 3200;
  options.noise_db = noise_db;
  options.seed = static_cast<std::uint64_t>(seed);
  const truth::Scale& scale = truth::scale_named(scale_name);
  const truth::ChainCase& which = truth::chain_case(name);
  const truth::ChainRecords records = truth::make_chain_records(which.chain, scale, options);
  std::filesystem::create_directories(out);
  truth::write_csv(records.train, which.chain, out + "/train.csv");
  truth::write_csv(records.test, which.chain, out + "/test.csv");
  std::printf("%s: masses of %g kg, stuck %.2f, hidden:", name.c_str(), scale.mass, records.train.stuck_share);
  for (const std::string& hidden : which.hidden) std::printf(" %s;", hidden.c_str());
  std::printf("\n");
}

/// 49 kg on a spring that hardens, as a test rig would record it: millimetres, kilonewtons, few digits.
void write_demo(const std::string& out) {
  const truth::Scale& scale = truth::scale_named("milli");
  truth::Case which = truth::case_named("cubic_hardening");
  truth::RecordOptions options;
  options.rows = 6401;
  options.noise_db = 30;
  options.force_noise_db = 50;
  options.seed = 20;
  const truth::Records records = truth::make_records(which, scale, options);
  truth::CsvUnits units{"kN", "mm", 1e-3, 1e3, "", 6};
  std::filesystem::create_directories(out);
  units.comment = "spring rig, mass 49 kg, multisine 3 to 44 Hz, 800 Hz";
  truth::write_csv(records.train, out + "/spring_multisine.csv", units);
  units.comment = "spring rig, mass 49 kg, sweep 6 to 40 Hz, 800 Hz";
  truth::write_csv(records.test, out + "/spring_sweep.csv", units);
  const double omega = scale.omega();
  std::printf("k = %.6g N/m, c = %.6g N s/m, k3 = %.6g N/m^3, hidden share %.2f\n", scale.mass * omega * omega,
              2 * which.physics.zeta * scale.mass * omega, which.parameters[0].in(scale), records.train.hidden_share);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string first = argc > 1 ? argv[1] : "";
  try {
    if (first == "list" && argc == 2) {
      list();
    } else if (first == "demo" && argc == 3) {
      write_demo(argv[2]);
    } else if (first == "chain" && argc == 7) {
      write_chain(argv[2], argv[3], std::atof(argv[4]), std::atol(argv[5]), argv[6]);
    } else if (first == "fault" && argc == 7) {
      write_fault(argv[2], argv[3], std::atof(argv[4]), std::atol(argv[5]), argv[6]);
    } else if (argc == 6 || argc == 7) {
      write_case(first, argv[2], std::atof(argv[3]), std::atol(argv[4]), argv[5],
                 argc == 7 ? std::atoi(argv[6]) : 6400);
    } else {
      std::fprintf(
          stderr, "usage: lunid_truth list | demo OUT_DIR | [fault | chain] CASE SCALE NOISE_DB SEED OUT_DIR [ROWS]\n");
      return 2;
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lunid_truth: %s\n", error.what());
    return 1;
  }
  return 0;
}
