#pragma once
// HDF5 and MAT files as lists of named variables. What links the libraries is a module of its own (module/), opened on
// use: a plain run neither loads nor waits for it. No exception crosses the interface.
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "record/record.hpp"

namespace lunid {

/// A variable of a file: "y", "run1/y" (HDF5), "run1.y" (a field of a structure in a MAT file).
struct Variable {
  std::string name;
  std::string unit;  ///< attribute `unit` or `units` of HDF5, text units.<name> of a MAT file; "" where there is none
  std::string kind;  ///< "" for real numbers, else what it is: "text", "complex numbers", "a cell array"
  std::vector<std::size_t> shape;     ///< as the file's own world writes it: rows first; {} for a single number
  bool single = false;                ///< stored with 24 bits of mantissa
  bool whole = false;                 ///< the file gives it all at once or not at all
  std::optional<double> start, step;  ///< attributes of a time that Lunid wrote: t = start + i*step to the last bit

  bool is_number() const { return kind.empty(); }
  std::size_t size() const;
  /// A row, a column or a list: at most one side is longer than 1.
  bool is_vector() const;
  /// "4001 x 1", "a number".
  std::string shape_text() const;
};

/// An open file. Reading gives "" or why it failed.
class Container {
 public:
  virtual ~Container() = default;
  const std::vector<Variable>& variables() const { return variables_; }
  /// Entries [first, first + count) of a vector of numbers; with `column` >= 0 of that column (from 0) of an array of
  /// two sides.
  virtual std::string read(std::size_t variable, int column, std::size_t first, std::size_t count, double* out) = 0;

 protected:
  std::vector<Variable> variables_;
};

/// A column to be written. `start`, `step`: as in Variable.
struct StoredColumn {
  std::string name, unit;
  const double* values = nullptr;
  std::size_t size = 0;
  std::optional<double> start, step;
};

/// Of MATLAB's own format, which all its programs read and which holds 2 GB a variable, and of HDF5 within it.
enum class MatVersion { v5, v7_3 };

/// What the module does. Failures are told in `error`.
class ContainerModule {
 public:
  virtual ~ContainerModule() = default;
  virtual std::unique_ptr<Container> open_mat(const std::string& path, std::string& error) = 0;
  virtual std::unique_ptr<Container> open_hdf5(const std::string& path, std::string& error) = 0;
  /// The bytes of an HDF5 file; the same bytes for the same columns.
  virtual std::string encode_hdf5(const std::vector<StoredColumn>& columns, std::string& error) = 0;
  /// Writes a MAT file; their units as the text fields of a structure `units`.
  virtual void write_mat(const std::string& path, const std::vector<StoredColumn>& columns, MatVersion version,
                         std::string& error) = 0;
};

constexpr int container_version = 3;
constexpr const char* container_factory_name = "lunid_container_module";
using ContainerFactory = ContainerModule*(int version);

/// Opens the module once. Throws InputError when it is missing or belongs to another version.
ContainerModule& container_module();

/// True for a path that ends in .mat, or a file that begins as HDF5 does.
bool is_container(const std::string& path);
/// Throws InputError (Fault::data) naming the path: no such file, not readable, cut short.
std::unique_ptr<Container> open_container(const std::string& path);

/// Which variable a name asks for, and which of its columns ("data:2"), or -1 for all of it.
struct ContainerChoice {
  std::size_t variable = 0;
  int column = -1;
  std::size_t rows = 0;
};
/// Finds a vector of numbers. `asked_for`: what it is to be, for messages ("for channel 'y'"). Throws InputError
/// (Fault::data): no such variable (with a list and "did you mean"), text, complex numbers, an array without a column.
ContainerChoice choose_variable(const Container& file, const std::string& path, const std::string& name,
                                const std::string& asked_for);
/// All of a choice, or rows [first, first + count). Throws InputError (Fault::data) naming the path.
Eigen::VectorXd read_choice(Container& file, const std::string& path, const ContainerChoice& choice,
                            std::size_t first = 0, std::size_t count = static_cast<std::size_t>(-1));

/// As read_csv, from a MAT or HDF5 file.
Record read_container(const std::string& path, const ReadOptions& options);
/// Writes t and the channels in SI with their units as attributes; reads back to the same doubles.
void write_hdf5(const Record& record, const std::string& path);
/// The same as a MAT file; the time as stamps. What no name of MATLAB holds becomes "_" in the names of channels.
/// Throws InputError (Fault::data): two channels of one name after that, a channel beyond 2 GB in version 5.
void write_mat(const Record& record, const std::string& path, MatVersion version);

}  // namespace lunid
