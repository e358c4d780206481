#include "expr/external.hpp"
#include "expr/number.hpp"
#include "expr/op.hpp"

namespace lunid {
namespace {

/// Writes by a stack of pieces still to come, so that the depth of an expression does not matter.
class Printer {
 public:
  explicit Printer(Format format) : format_(format) {}

  std::string print(Expr root) {
    pending_.push_back({root, bind::anything, {}});
    while (!pending_.empty()) {
      const Piece piece = pending_.back();
      pending_.pop_back();
      if (piece.node.valid())
        write(piece.node, piece.level);
      else
        text_ += piece.text;
    }
    return std::move(text_);
  }

 private:
  /// An expression in a place that demands a level, or (without a node) a text.
  struct Piece {
    Expr node;
    int level;
    std::string_view text;
  };

  void write(Expr node, int demanded) {
    const OpRow& row = row_of(node.op());
    if (row.kind == OpClass::leaf) return write_leaf(node, demanded);
    const Notation& notation = notation_of(row);
    const bool in_parentheses = notation.level < demanded;
    if (in_parentheses) open();
    if (notation.pattern)
      write_pattern(node, notation.pattern);
    else if (row.kind == OpClass::external)
      write_call(node, external_name(node));
    else
      write_call(node, (format_ == Format::latex ? "\\"
                        : format_ == Format::lua ? "lunid."
                                                 : "") +
                           std::string(row.name));
  }

  /// The function's name, and which derivative: damper, damper_d1.
  std::string external_name(Expr node) const {
    if (format_ != Format::latex) return node.function()->name() + ExternalPart(node.part()).suffix();
    std::string name;
    for (const char c : node.function()->name()) name += c == '_' ? "\\_" : std::string(1, c);
    const std::string order = ExternalPart(node.part()).digits();
    return (order.empty() ? "" : "\\partial_{" + order + "}") + "\\operatorname{" + name + "}";
  }

  void write_leaf(Expr node, int demanded) {
    const Written leaf = node.is_constant() ? write_number(node.value(), format_) : write_name(node.name(), format_);
    if (leaf.level < demanded) open();
    text_ += leaf.text;
  }

  void open() {
    text_ += format_ == Format::latex ? "\\left(" : "(";
    pending_.push_back({{}, 0, format_ == Format::latex ? "\\right)" : ")"});
  }

  const Notation& notation_of(const OpRow& row) const {
    switch (format_) {
      case Format::latex: return row.latex;
      case Format::c: return row.c;
      case Format::lua: return row.lua;
      default: return row.plain;
    }
  }

  void write_call(Expr node, const std::string& name) {
    const bool latex = format_ == Format::latex;
    text_ += name + (latex ? "\\left(" : "(");
    std::vector<Piece> pieces;
    for (const Expr& argument : node.arguments()) {
      if (!pieces.empty()) pieces.push_back({{}, 0, ", "});
      pieces.push_back({argument, bind::anything, {}});
    }
    pieces.push_back({{}, 0, latex ? "\\right)" : ")"});
    pending_.insert(pending_.end(), pieces.rbegin(), pieces.rend());
  }

  void write_pattern(Expr node, std::string_view pattern) {
    std::vector<Piece> pieces;
    while (!pattern.empty()) {
      const std::size_t mark = pattern.find('$');
      if (mark != 0) pieces.push_back({{}, 0, pattern.substr(0, mark)});
      if (mark == std::string_view::npos) break;
      const Expr argument = node.arguments()[static_cast<std::size_t>(pattern[mark + 1] - '0')];
      add_argument(pieces, argument, pattern[mark + 2]);
      pattern.remove_prefix(mark + 3);
    }
    pending_.insert(pending_.end(), pieces.rbegin(), pieces.rend());
  }

  /// `$0?` is a condition: a comparison as it stands, anything else as `> 0`.
  static void add_argument(std::vector<Piece>& pieces, Expr argument, char demand) {
    if (demand != '?') {
      pieces.push_back({argument, demand - '0', {}});
    } else if (row_of(argument.op()).kind == OpClass::comparison) {
      pieces.push_back({argument, bind::comparison, {}});
    } else {
      pieces.push_back({argument, bind::sum, {}});
      pieces.push_back({{}, 0, " > 0"});
    }
  }

  Format format_;
  std::string text_;
  std::vector<Piece> pending_;
};

}  // namespace

std::string to_text(Expr f, Format format) { return Printer(format).print(f); }

}  // namespace lunid
