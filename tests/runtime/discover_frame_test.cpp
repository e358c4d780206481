// Discovery on a base that moves: baselines, records and entries as they are seen from it, and back.
#include <gtest/gtest.h>

#include <cmath>

#include "discover/frame.hpp"
#include "expr/expr.hpp"
#include "record/derive.hpp"

namespace lunid {
namespace {

Model model_of(const std::shared_ptr<Pool>& pool, const std::string& restoring, const std::string& mass = "3") {
  Model model;
  model.pool = pool;
  model.mass = parse(*pool, mass);
  model.restoring = parse(*pool, restoring);
  return model;
}

std::string fault_of(const Model& model) {
  try {
    const Frame frame(model);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

Channel channel(const std::string& name, Eigen::VectorXd values, double noise = 0) {
  Channel out;
  out.name = out.source = name;
  out.unit = name[0] == 'y' ? "m" : name[0] == 'v' ? "m/s" : name[0] == 'a' ? "m/s^2" : "N";
  out.values = std::move(values);
  out.noise = noise;
  return out;
}

constexpr Eigen::Index rows = 400;
constexpr double dt = 0.01;

Eigen::VectorXd wave(double size, double w) {
  return Eigen::VectorXd::NullaryExpr(rows,
                                      [=](Eigen::Index i) { return size * std::sin(w * dt * static_cast<double>(i)); });
}

TEST(Frame, AModelOnTheGroundIsTakenAsItIs) {
  const auto pool = std::make_shared<Pool>();
  const Frame frame(model_of(pool, "k*y + c*v"));
  EXPECT_FALSE(frame.moves());
  EXPECT_EQ(frame.note(), "");
  EXPECT_EQ(to_text(frame.as_given(frame.model()).restoring), "k*y + c*v");
  const Record record("r", 0, dt, {channel("y", wave(1, 5)), channel("F", wave(1, 5))});
  EXPECT_EQ(frame.seen(record).channels().size(), 2U);
}

TEST(Frame, DifferencesToTheBaseAreMotions) {
  const auto pool = std::make_shared<Pool>();
  const Frame frame(model_of(pool, "k*(y - yb) + c*(v - vb) + q*abs(v - vb)*(v - vb)"));
  EXPECT_TRUE(frame.moves());
  EXPECT_EQ(to_text(frame.model().restoring), "k*y + c*v + q*abs(v)*v");
  EXPECT_EQ(to_text(frame.as_given(frame.model()).restoring), "k*(y - yb) + c*(v - vb) + q*abs(v - vb)*(v - vb)");
  // however it is written
  EXPECT_EQ(to_text(Frame(model_of(pool, "k*y - k*yb")).model().restoring), "k*y - k*0");
}

TEST(Frame, InertiaOfTheBaseIsAForce) {
  const auto pool = std::make_shared<Pool>();
  const Frame frame(model_of(pool, "k*y + c*v + 3*ab"));
  EXPECT_EQ(to_text(frame.model().restoring), "k*y + c*v");
  const Record record("r", 0, dt, {channel("y", wave(1, 5), 0.3), channel("ab", wave(2, 5), 0.1)});
  const Record seen = frame.seen(record);
  EXPECT_LT((Eigen::VectorXd::Map(seen["F"].data(), rows) + wave(6, 5)).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(seen.channel("F").noise, 0.3);
  EXPECT_EQ(to_text(frame.as_given(frame.model()).restoring), "k*y + c*v + 3*ab");
}

TEST(Frame, RecordsAreThoseOfTheDifference) {
  const auto pool = std::make_shared<Pool>();
  const Frame frame(model_of(pool, "k*(y - yb)"));
  const Record record("r", 0, dt,
                      {channel("y", wave(5, 5), 0.3), channel("yb", wave(2, 5), 0.4), channel("F", wave(1, 9))});
  const Record seen = frame.seen(record);
  EXPECT_LT((Eigen::VectorXd::Map(seen["y"].data(), rows) - wave(3, 5)).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(seen.channel("y").noise, 0.5);
  EXPECT_FALSE(seen.channel("y").derived);
  EXPECT_TRUE(seen.channel("v").derived);
  // -m*ab of a displacement that was measured, beside the force: m = 3, ab = -25*yb
  const Eigen::VectorXd expected = wave(1, 9) + 3 * 25 * wave(2, 5);
  const Eigen::Index middle = rows / 2;
  EXPECT_NEAR(seen["F"][middle], expected[middle], 0.02 * expected.cwiseAbs().maxCoeff());
}

TEST(Frame, SmoothedAccelerationOfACleanBaseIsItsOwn) {
  const auto pool = std::make_shared<Pool>();
  const Frame frame(model_of(pool, "k*(v - vb)", "1"));
  const Record record("r", 0, dt, {channel("v", wave(5, 11)), channel("vb", wave(2, 11))});
  const Record seen = frame.seen(record);
  double worst = 0;
  for (Eigen::Index i = 20; i < rows - 20; ++i)
    worst = std::max(worst, std::abs(seen["F"][i] + 2 * 11 * std::cos(11 * dt * static_cast<double>(i))));
  EXPECT_LT(worst, 0.02 * 22);
}

TEST(Frame, MassesOfTheirOwnFeelTheBase) {
  const auto pool = std::make_shared<Pool>();
  const Frame frame(model_of(pool, "k*(y - yb)"));
  Effect mass, fault;
  const Expr x = pool->state("x"), u = pool->state("u");
  mass.variants.emplace_back(parse(*pool, "h*(y - x) + ma*a"));
  mass.states = {{x, u, 0, {}, {}}, {u, parse(*pool, "h*(y - x)"), 0, {}, {}}};
  mass.absolute = {"u"};
  fault.variants.emplace_back(parse(*pool, "mb*ab"));
  const std::vector<Effect> seen = frame.seen(std::vector<Effect>{mass, fault});
  ASSERT_EQ(seen.size(), 1U);  // what follows the base is in the force already
  EXPECT_EQ(to_text(seen[0].variants[0].force), "h*(y - x) + ma*(a + ab)");
  EXPECT_EQ(to_text(seen[0].states[0].rate), "u");
  EXPECT_EQ(to_text(seen[0].states[1].rate), "h*(y - x) - ab");
  Model found = frame.model();
  found.restoring = found.restoring + seen[0].variants[0].force;
  EXPECT_EQ(to_text(frame.as_given(found).restoring), "k*(y - yb) + (h*(y - yb - x) + ma*a)");
}

TEST(Frame, SeveralCoordinatesStandOnOneBase) {
  const auto pool = std::make_shared<Pool>();
  Model model = model_of(pool, "k*(y1 - yb) - s*(y2 - y1)", "2");
  model.further = {{parse(*pool, "5"), parse(*pool, "s*(y2 - y1)")}};
  model.driven = {1};
  const Frame frame(model);
  EXPECT_EQ(to_text(frame.model().restoring), "k*y1 - s*(y2 - y1)");
  EXPECT_TRUE(frame.model().driven.empty());  // the base moves all
  const Record record(
      "r", 0, dt,
      {channel("a1", wave(5, 5)), channel("a2", wave(6, 5)), channel("ab", wave(2, 5)), channel("F2", wave(1, 9))});
  const Record seen = frame.seen(record);
  EXPECT_LT((Eigen::VectorXd::Map(seen["a2"].data(), rows) - wave(4, 5)).norm(), 1e-12);
  EXPECT_LT((Eigen::VectorXd::Map(seen["F1"].data(), rows) + wave(4, 5)).norm(), 1e-12);
  EXPECT_LT((Eigen::VectorXd::Map(seen["F2"].data(), rows) - wave(1, 9) + wave(10, 5)).norm(), 1e-12);
  const Record other(
      "r", 0, dt,
      {channel("a1", wave(5, 5)), channel("a2", wave(6, 5)), channel("ab", wave(2, 5)), channel("F", wave(1, 9))});
  const Record whole = frame.seen(other);  // F is that of the coordinate that is driven
  EXPECT_LT((Eigen::VectorXd::Map(whole["F2"].data(), rows) - wave(1, 9) + wave(10, 5)).norm(), 1e-12);
  EXPECT_LT((Eigen::VectorXd::Map(whole["F1"].data(), rows) + wave(4, 5)).norm(), 1e-12);
  model.driven.clear();
  EXPECT_THROW(Frame(model).seen(other), InputError);
  model.driven = {1};
  const Model back = frame.as_given(frame.model());
  EXPECT_EQ(to_text(back.restoring), "k*(y1 - yb) - s*(y2 - y1)");
  EXPECT_EQ(back.driven, model.driven);
}

TEST(Frame, AFaultOfAChannelStaysAsItIsSeen) {
  const auto pool = std::make_shared<Pool>();
  const Frame frame(model_of(pool, "k*(y - yb)"));
  Model found = frame.model();
  found.measures = {{"y", parse(*pool, "g*y")}};
  EXPECT_EQ(to_text(frame.as_given(found).restoring), "k*y");
}

TEST(Frame, SaysWhatItCannotLookAt) {
  const auto pool = std::make_shared<Pool>();
  const std::string begin = "discover: a base that moves: ";
  EXPECT_EQ(fault_of(model_of(pool, "k*(y - 2*yb)")),
            begin + "expected it in differences y - yb, v - vb alone, got k*(y - 2*yb)");
  EXPECT_EQ(fault_of(model_of(pool, "k*(y - yb) + 3*ab")),
            begin + "expected yb and vb in differences y - yb, v - vb, got ab beside them");
  EXPECT_EQ(fault_of(model_of(pool, "k*(y - yb) + d*a")),
            begin + "expected the mass alone before accelerations, got k*(y - yb) + d*a");
  EXPECT_EQ(fault_of(model_of(pool, "k*y + 3*ab^2")), begin + "expected ab in a term m*ab, got k*y + 3*ab^2");
  EXPECT_EQ(fault_of(model_of(pool, "k*y + g*ab")), begin + "expected ab with a number, as m*ab, got g*ab");
  EXPECT_EQ(
      fault_of(model_of(pool, "k*(y - yb)", "m")),
      begin +
          "expected a mass that is a number, got m: no force shows it. With mass 1 all values are per unit of mass");
}

}  // namespace
}  // namespace lunid
