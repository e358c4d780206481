#include <numbers>

#include "expr/op.hpp"
#include "expr/scan.hpp"
#include "expr/words.hpp"

namespace lunid {
namespace {

/// Recursive descent over the grammar of expr.hpp, one function per rule.
class Parser {
 public:
  Parser(Pool& pool, std::string_view text, std::string_view source) : pool_(pool), scan_(text, source) { advance(); }

  Expr parse() {
    if (token_.kind == TokenKind::end) fail("expected an expression, got nothing");
    const Expr result = sum();
    if (token_.kind != TokenKind::end) unexpected();
    return result;
  }

 private:
  static constexpr int deepest = 200;  // levels of parentheses, signs and powers: far below the stack's end

  /// Counts the nesting; the limit keeps a hostile text from overflowing the stack.
  struct Level {
    explicit Level(Parser& parser) : depth(parser.depth_) {
      if (++depth > deepest) parser.fail("nested deeper than " + std::to_string(deepest) + " levels");
    }
    ~Level() { --depth; }
    int& depth;
  };

  Expr comparison() {
    const Expr left = sum();
    Op op;
    if (is(">"))
      op = Op::greater;
    else if (is("<"))
      op = Op::less;
    else if (is(">="))
      op = Op::greater_equal;
    else if (is("<="))
      op = Op::less_equal;
    else
      return left;
    advance();
    return pool_.apply(op, {left, sum()});
  }

  Expr sum() {
    Expr left = product();
    while (is("+") || is("-")) {
      const Op op = is("+") ? Op::add : Op::sub;
      advance();
      left = pool_.apply(op, {left, product()});
    }
    return left;
  }

  Expr product() {
    Expr left = unary();
    while (is("*") || is("/")) {
      const Op op = is("*") ? Op::mul : Op::div;
      advance();
      left = pool_.apply(op, {left, unary()});
    }
    return left;
  }

  Expr unary() {
    const Level level(*this);
    if (!is("-")) return power();
    advance();
    return -unary();
  }

  Expr power() {
    const Expr base = atom();
    if (!is("^")) return base;
    advance();
    return pow(base, unary());
  }

  Expr atom() {
    const Token first = token_;
    if (first.kind == TokenKind::number) return advance(), pool_.constant(first.value);
    if (first.kind == TokenKind::name) return name();
    if (!is("(")) fail("expected a number, a name or '(', got " + quoted());
    advance();
    const Expr inner = sum();
    close(first);
    return inner;
  }

  Expr name() {
    const Token first = token_;
    advance();
    Op op;
    int arity = 0;
    const std::string word(first.text);
    const bool function = find_function(word, op, arity);
    if (is("(")) return function ? call(first, op, arity) : unknown_function(first);
    if (function) fail_at(first, "function '" + word + "' needs its arguments in parentheses, " + word + "(...)");
    if (word == "pi") return pool_.constant(std::numbers::pi);
    if (const Expr known = pool_.find(word); known.valid()) return known;
    return pool_.symbol(word, is_channel_name(word) ? SymbolKind::channel : SymbolKind::parameter);
  }

  Expr call(const Token& name, Op op, int arity) {
    const Token opened = token_;
    std::vector<Expr> arguments;
    bool decimal_comma = false;
    do {
      const bool after_number = last_.kind == TokenKind::number;
      advance();  // '(' or ','
      decimal_comma |= after_number && token_.kind == TokenKind::number && touches_comma();
      if (is(")") && arguments.empty()) break;
      arguments.push_back(op == Op::where && arguments.empty() ? comparison() : sum());
    } while (is(","));
    const int got = static_cast<int>(arguments.size());
    close(opened);
    if (got != arity)
      fail_at(name, arity_message(std::string(name.text), arity, got) +
                        (decimal_comma ? " (a decimal number takes a point, not a comma)" : ""));
    return pool_.apply(op, arguments);
  }

  [[noreturn]] Expr unknown_function(const Token& name) {
    const std::string word(name.text);
    if (word == "pow") fail_at(name, "unknown function 'pow', write a^b for a power");
    if (word == "if") fail_at(name, "unknown function 'if', write where(condition, a, b)");
    std::string message = "unknown function '" + word + "'";
    const std::string near = word == "ln" ? "log" : nearest_word(word, function_names());
    if (is_channel_name(word) || pool_.find(word).valid() || near.empty())
      message += ", write '" + word + "*(...)' for a product";
    else
      message += did_you_mean(near);
    fail_at(name, message);
  }

  void close(const Token& opened) {
    if (is(")")) return advance();
    if (token_.kind == TokenKind::end)
      fail("expected ')' to close the '(' in column " + std::to_string(scan_.column(opened.offset)) + ", got the end");
    unexpected();
  }

  /// What follows a complete expression and cannot.
  [[noreturn]] void unexpected() {
    if (is(")")) fail("unexpected ')', no '(' is open");
    if (is(",") && last_.kind == TokenKind::number) {
      const Token comma = token_;
      const Token before = last_;
      advance();
      if (token_.kind == TokenKind::number && touches_comma())
        fail_at(comma, "unexpected ',', a decimal number takes a point: write " + std::string(before.text) + "." +
                           std::string(token_.text));
      fail_at(comma, "unexpected ','");
    }
    if (is(">") || is("<") || is(">=") || is("<="))
      fail("unexpected " + quoted() + ", a comparison may stand only in the first argument of where(condition, a, b)");
    if (token_.kind == TokenKind::name || token_.kind == TokenKind::number || is("("))
      fail("expected an operator before " + quoted() + ", write '*' for a product");
    fail("unexpected " + quoted());
  }

  /// Is the number that the token is typed directly behind a comma, as in 1,5?
  bool touches_comma() const { return token_.offset > 0 && scan_.text()[token_.offset - 1] == ','; }

  bool is(std::string_view sign) const { return token_.kind == TokenKind::sign && token_.text == sign; }
  void advance() { last_ = token_, token_ = scan_.next(); }
  std::string quoted() const {
    return token_.kind == TokenKind::end ? "the end" : "'" + std::string(token_.text) + "'";
  }
  [[noreturn]] void fail(const std::string& message) { scan_.fail(token_.offset, message); }
  [[noreturn]] void fail_at(const Token& token, const std::string& message) { scan_.fail(token.offset, message); }

  Pool& pool_;
  Scanner scan_;
  Token token_, last_;
  int depth_ = 0;
};

}  // namespace

Expr parse(Pool& pool, std::string_view text, std::string_view source) { return Parser(pool, text, source).parse(); }

}  // namespace lunid
