// MAT files: version 4 and 5 (MATLAB's own format) and 7.3 (HDF5), by matio.
#include <algorithm>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "record/module/files.hpp"
#include "record/module/mat.hpp"

namespace lunid::container {
namespace {

/// A file of version 5 is a chain of elements that say how long they are: one that is cut short ends before its last
/// element does. matio would read what is there and fill up with zeros.
void check_whole(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  char header[128] = {};
  in.read(header, sizeof header);
  if (in.gcount() < 20) throw std::runtime_error("cut short: it holds no more than a part of its header");
  const bool level_5 = std::memcmp(header, "MATLAB 5.0", 10) == 0;
  if (!level_5) return;
  if (in.gcount() < static_cast<std::streamsize>(sizeof header))
    throw std::runtime_error("cut short: it holds no more than a part of its header");
  const bool swapped = header[126] == 'M';  // "IM" in files of machines as this one
  in.seekg(0, std::ios::end);
  const auto end = static_cast<std::uint64_t>(in.tellg());
  for (std::uint64_t at = sizeof header; at < end;) {
    std::uint32_t tag[2] = {};
    in.seekg(static_cast<std::streamoff>(at));
    in.read(reinterpret_cast<char*>(tag), sizeof tag);
    const std::uint64_t size = swapped ? __builtin_bswap32(tag[1]) : tag[1];
    if (in.gcount() < static_cast<std::streamsize>(sizeof tag) || at + sizeof tag + size > end)
      throw std::runtime_error("cut short: a variable begins at byte " + std::to_string(at) + " and has " +
                               std::to_string(size) + " bytes, the file ends at byte " + std::to_string(end));
    at += sizeof tag + size;
  }
}

std::string kind_of(const matvar_t& variable) {
  if (variable.isComplex) return "complex numbers";
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
    case MAT_C_SINGLE:
    case MAT_C_INT8:
    case MAT_C_UINT8:
    case MAT_C_INT16:
    case MAT_C_UINT16:
    case MAT_C_INT32:
    case MAT_C_UINT32:
    case MAT_C_INT64:
    case MAT_C_UINT64: return "";
    case MAT_C_CHAR: return "text";
    case MAT_C_CELL: return "a cell array";
    case MAT_C_STRUCT: return "an array of structures";
    case MAT_C_SPARSE: return "a sparse matrix";
    case MAT_C_EMPTY: return "an empty array";
    case MAT_C_FUNCTION: return "a function";
    default: return "an object";
  }
}

template <class T>
void convert(const void* data, std::size_t first, std::size_t count, double* out) {
  const T* from = static_cast<const T*>(data) + first;
  for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<double>(from[i]);
}

void convert(matio_classes type, const void* data, std::size_t first, std::size_t count, double* out) {
  switch (type) {
    case MAT_C_DOUBLE: return convert<double>(data, first, count, out);
    case MAT_C_SINGLE: return convert<float>(data, first, count, out);
    case MAT_C_INT8: return convert<std::int8_t>(data, first, count, out);
    case MAT_C_UINT8: return convert<std::uint8_t>(data, first, count, out);
    case MAT_C_INT16: return convert<std::int16_t>(data, first, count, out);
    case MAT_C_UINT16: return convert<std::uint16_t>(data, first, count, out);
    case MAT_C_INT32: return convert<std::int32_t>(data, first, count, out);
    case MAT_C_UINT32: return convert<std::uint32_t>(data, first, count, out);
    case MAT_C_INT64: return convert<std::int64_t>(data, first, count, out);
    default: return convert<std::uint64_t>(data, first, count, out);
  }
}

class MatFile : public Container {
 public:
  explicit MatFile(const std::string& path) {
    check_whole(path);
    file_.reset(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
    if (!file_) throw std::runtime_error("this is no MAT file that can be read");
    bool units = false;
    while (Owned each{Mat_VarReadNextInfo(file_.get())}) {
      const std::string name = each->name ? each->name : "";
      if (name == "units" && is_texts(*each))
        units = true;
      else
        list(*each, {name});
    }
    if (units) read_units();
  }

  std::string read(std::size_t variable, int column, std::size_t first, std::size_t count, double* out) override {
    const std::vector<std::string>& path = paths_[variable];
    if (!variables_[variable].whole) return read_part(variable, column, first, count, out);
    if (!whole_ || whole_name_ != path[0]) {
      whole_.reset(Mat_VarRead(file_.get(), path[0].c_str()));
      whole_name_ = path[0];
    }
    const matvar_t* at = whole_.get();
    for (std::size_t i = 1; at && i < path.size(); ++i)
      at = Mat_VarGetStructFieldByName(const_cast<matvar_t*>(at), path[i].c_str(), 0);
    const Variable& row = variables_[variable];
    const std::size_t offset = column < 0 ? 0 : static_cast<std::size_t>(column) * row.shape[0];
    std::size_t entries = 1;
    for (int i = 0; at && i < at->rank; ++i) entries *= at->dims[i];
    if (!at || !at->data || entries < offset + first + count) return "its values cannot be read; the file is damaged";
    if (at->nbytes < (offset + first + count) * Mat_SizeOfClass(at->class_type))
      return "it holds fewer values than it says";
    convert(at->class_type, at->data, offset + first, count, out);
    return {};
  }

 private:
  static bool is_texts(matvar_t& variable) {
    if (variable.class_type != MAT_C_STRUCT) return false;
    for (unsigned i = 0; i < Mat_VarGetNumberOfFields(&variable); ++i) {
      const matvar_t* field = Mat_VarGetStructFieldByIndex(&variable, i, 0);
      if (!field || field->class_type != MAT_C_CHAR) return false;
    }
    return true;
  }

  /// units.y = 'mm' is the unit of the variable y, as write_mat() leaves it.
  void read_units() {
    const Owned units(Mat_VarRead(file_.get(), "units"));
    for (Variable& variable : variables_) {
      const matvar_t* text = units ? Mat_VarGetStructFieldByName(units.get(), variable.name.c_str(), 0) : nullptr;
      if (!text || !text->data) continue;
      const std::size_t width = Mat_SizeOf(text->data_type);  // characters have 1 or 2 bytes, the first is what counts
      for (std::size_t i = 0; width > 0 && i < text->nbytes / width; ++i)
        variable.unit += static_cast<const char*>(text->data)[i * width];
    }
  }

  /// The same of a matrix of version 7.3, without the rest of it.
  std::string read_part(std::size_t variable, int column, std::size_t first, std::size_t count, double* out) {
    const Owned info(Mat_VarReadInfo(file_.get(), paths_[variable][0].c_str()));
    if (!info) return "its values cannot be read; the file is damaged";
    const bool row = column < 0 && info->dims[0] == 1;
    int start[2] = {static_cast<int>(first), std::max(column, 0)}, step[2] = {1, 1};
    int edge[2] = {static_cast<int>(count), 1};
    if (row) std::swap(start[0], start[1]), std::swap(edge[0], edge[1]);
    std::vector<char> bytes(count * Mat_SizeOfClass(info->class_type));
    if (Mat_VarReadData(file_.get(), info.get(), bytes.data(), start, step, edge) != 0)
      return "its values cannot be read; the file is damaged";
    convert(info->class_type, bytes.data(), 0, count, out);
    return {};
  }

  /// Adds a variable, or the fields of a structure. `path`: its name in the file and those of the fields below it.
  void list(matvar_t& variable, const std::vector<std::string>& path) {
    std::size_t entries = 1;
    for (int i = 0; i < variable.rank; ++i) entries *= variable.dims[i];
    if (variable.class_type != MAT_C_STRUCT || entries != 1) return add(variable, path);
    char* const* names = Mat_VarGetStructFieldnames(&variable);
    for (unsigned i = 0; names && i < Mat_VarGetNumberOfFields(&variable); ++i) {
      matvar_t* field = Mat_VarGetStructFieldByIndex(&variable, i, 0);
      std::vector<std::string> below = path;
      below.emplace_back(names[i]);
      if (field) list(*field, below);
    }
  }

  void add(const matvar_t& variable, const std::vector<std::string>& path) {
    Variable row;
    for (const std::string& name : path) row.name += (row.name.empty() ? "" : ".") + name;
    row.kind = kind_of(variable);
    row.single = variable.class_type == MAT_C_SINGLE;
    // Only HDF5, which version 7.3 is, finds rows without reading those before them.
    row.whole = path.size() > 1 || variable.rank != 2 || Mat_GetVersion(file_.get()) != MAT_FT_MAT73;
    for (int i = 0; i < variable.rank; ++i) row.shape.push_back(variable.dims[i]);
    variables_.push_back(std::move(row));
    paths_.push_back(path);
  }

  OpenMat file_;
  std::vector<std::vector<std::string>> paths_;
  Owned whole_;  // the variable read last, with all its fields
  std::string whole_name_;
};

}  // namespace

std::unique_ptr<Container> open_mat(const std::string& path) { return std::make_unique<MatFile>(path); }

}  // namespace lunid::container
