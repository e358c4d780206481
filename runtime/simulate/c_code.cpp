// A model as a right-hand side in C.
#include <algorithm>
#include <cmath>

#include "expr/external.hpp"
#include "expr/joined.hpp"
#include "simulate/model.hpp"

namespace lunid {
namespace {

constexpr const char* words_of_c[] = {
    "auto",     "break",  "case",     "char",   "const",  "continue", "default", "do",     "double",  "else",
    "enum",     "extern", "float",    "for",    "goto",   "if",       "inline",  "int",    "long",    "register",
    "restrict", "return", "short",    "signed", "sizeof", "static",   "struct",  "switch", "typedef", "union",
    "unsigned", "void",   "volatile", "while",  "x",      "u",        "p",       "dx"};

void check_name(const std::string& name) {
  for (const char* word : words_of_c)
    if (name == word)
      throw InputError("export: '" + name + "' is a word of C or of the function that is written; rename it");
}

/// "const double y = x[0], v = x[1];" of the entries that the rates hold.
std::string locals(const std::vector<Expr>& symbols, const char* array, const std::vector<Expr>& rates) {
  std::string text;
  for (std::size_t i = 0; i < symbols.size(); ++i) {
    if (std::none_of(rates.begin(), rates.end(), [&](Expr f) { return depends_on(f, symbols[i]); })) continue;
    check_name(symbols[i].name());
    text += "  const double " + symbols[i].name() + " = " + array + "[" + std::to_string(i) + "];\n";
  }
  return text;
}

std::string names(const std::vector<Expr>& symbols) {
  const std::string text = joined(symbols, &Expr::name);
  return text.empty() ? "none" : text;
}

}  // namespace

std::string c_code(const System& system) {
  const Model& model = system.model();
  const DynamicsSource& s = system.equations();
  if (model.imposed_motion) throw InputError("export: the motion of this model is imposed: it has no rate to write");
  if (!s.bounds.empty())
    throw InputError("export: the state '" + s.states[s.bounds[0].state].name() +
                     "' has a bound, which a right-hand side in C cannot hold");
  if (const auto functions = external_functions(s.rates); !functions.empty())
    throw InputError("export: the rates call the " + functions.front()->words() + ", which has no text in C");
  std::string text = "/* " + model.equation() + "\n";
  text += "   x' = f(t, u, x, p)   x: " + names(s.states) + "   u: " + names(s.exogenous) +
          "   p: " + names(s.parameters) + " */\n#include <math.h>\n\n";
  text += "enum { states = " + std::to_string(s.states.size()) + ", inputs = " + std::to_string(s.exogenous.size()) +
          ", parameters = " + std::to_string(s.parameters.size()) + " };\n\n";
  if (!model.parameters.empty()) {
    text += "const double parameter_values[] = {";
    for (std::size_t i = 0; i < model.parameters.size(); ++i) {
      const double value = model.parameters[i].value;
      text += (i > 0 ? ", " : "") + (std::isfinite(value) ? to_text(model.pool->constant(value), Format::c) : "NAN");
    }
    text += "};\n\n";
  }
  text += "void rate(double t, const double *u, const double *x, const double *p, double *dx) {\n";
  text += locals(s.exogenous, "u", s.rates) + locals(s.states, "x", s.rates) + locals(s.parameters, "p", s.rates);
  text += "  (void)t, (void)u, (void)x, (void)p;\n";
  for (std::size_t i = 0; i < s.rates.size(); ++i)
    text += "  dx[" + std::to_string(i) + "] = " + to_text(s.rates[i], Format::c) + ";\n";
  return text + "}\n";
}

}  // namespace lunid
