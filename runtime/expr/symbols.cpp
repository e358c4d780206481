#include <cctype>
#include <unordered_map>
#include <unordered_set>

#include "expr/op.hpp"
#include "expr/walk.hpp"
#include "expr/words.hpp"

namespace lunid {

std::vector<Expr> post_order(std::span<const Expr> roots) {
  std::vector<Expr> order;
  std::unordered_set<std::uint32_t> seen;
  std::vector<std::pair<Expr, std::size_t>> stack;  // a node and the argument to visit next
  for (const Expr& root : roots) {
    if (seen.insert(root.id()).second) stack.emplace_back(root, 0);
    while (!stack.empty()) {
      auto& [node, next] = stack.back();
      if (next == node.arguments().size()) {
        order.push_back(node);
        stack.pop_back();
      } else if (const Expr argument = node.arguments()[next++]; seen.insert(argument.id()).second) {
        stack.emplace_back(argument, 0);
      }
    }
  }
  return order;
}

std::vector<Expr> post_order(Expr root) { return post_order(std::span<const Expr>(&root, 1)); }

std::vector<Expr> symbols(Expr f) {
  std::vector<Expr> found = post_order(f);
  std::erase_if(found, [](const Expr& node) { return !node.is_symbol(); });
  return found;
}

std::vector<Expr> symbols(Expr f, SymbolKind kind) {
  std::vector<Expr> found = symbols(f);
  std::erase_if(found, [kind](const Expr& node) { return node.kind() != kind; });
  return found;
}

bool depends_on(Expr f, Expr symbol) {
  for (const Expr& node : post_order(f))
    if (node == symbol) return true;
  return false;
}

namespace {

/// The same operation on other arguments.
Expr rebuilt(Expr node, std::span<const Expr> arguments) {
  if (node.op() == Op::external) return node.pool().call(node.function(), arguments, node.part());
  return node.pool().apply(node.op(), arguments);
}

}  // namespace

Expr substitute(Expr f, std::span<const std::pair<Expr, Expr>> replacements) {
  std::unordered_map<std::uint32_t, Expr> image;
  for (const auto& [from, to] : replacements) image.emplace(from.id(), to);
  for (const Expr& node : post_order(f)) {
    if (image.contains(node.id())) continue;
    Expr arguments[Expr::most_arguments];
    bool changed = false;
    const auto old = node.arguments();
    for (std::size_t i = 0; i < old.size(); ++i) {
      arguments[i] = image.at(old[i].id());
      changed |= arguments[i] != old[i];
    }
    image.emplace(node.id(), changed ? rebuilt(node, {arguments, old.size()}) : node);
  }
  return image.at(f.id());
}

bool is_identifier(std::string_view name) {
  if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0]))) return false;
  for (const char c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_') return false;
  return true;
}

std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

bool is_channel_name(std::string_view name) {
  for (const char* known : {"t", "yb", "vb", "ab", "shaft_angle", "shaft_speed", "shaft_rate", "force_rate"})
    if (name == known) return true;
  if (name.empty() || std::string_view("yvaF").find(name[0]) == std::string_view::npos) return false;
  if (name.size() == 1) return true;
  if (name[1] == '0') return false;  // degrees of freedom count from 1: F0 is a name like any other
  for (const char c : name.substr(1))
    if (!std::isdigit(static_cast<unsigned char>(c))) return false;
  return true;
}

bool is_reserved(std::string_view name) {
  Op op;
  int arity = 0;
  return name == "pi" || find_function(name, op, arity);
}

std::string arity_message(const std::string& name, int arity, int got) {
  return name + ": takes " + std::to_string(arity) + (arity == 1 ? " argument" : " arguments") + ", got " +
         std::to_string(got);
}

}  // namespace lunid
