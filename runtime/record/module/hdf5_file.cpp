// HDF5 files: every data set of numbers, wherever it lies.
#include <algorithm>

#include "record/module/files.hpp"
#include "record/module/handle.hpp"

namespace lunid::container {
namespace {

std::string kind_of(hid_t type) {
  switch (H5Tget_class(type)) {
    case H5T_INTEGER:
    case H5T_FLOAT: return "";
    case H5T_STRING: return "text";
    case H5T_COMPOUND: {
      const bool is_complex = H5Tget_nmembers(type) == 2 && H5Tget_member_index(type, "r") >= 0;
      return is_complex ? "complex numbers" : "a table of records";
    }
    default: return "no numbers";
  }
}

/// A text attribute of fixed or of variable length; "" where there is none.
std::string text_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return {};
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, "H5Aopen");
  const Handle type(H5Aget_type(attribute), H5Tclose, "H5Aget_type");
  const Handle space(H5Aget_space(attribute), H5Sclose, "H5Aget_space");
  if (H5Tget_class(type) != H5T_STRING || H5Sget_simple_extent_npoints(space) != 1) return {};
  if (H5Tis_variable_str(type) > 0) {
    char* text = nullptr;
    const Handle memory(H5Tget_native_type(type, H5T_DIR_ASCEND), H5Tclose, "H5Tget_native_type");
    if (H5Aread(attribute, memory, &text) < 0 || !text) return {};
    std::string found = text;
    H5free_memory(text);
    return found;
  }
  std::string text(H5Tget_size(type), '\0');
  if (H5Aread(attribute, type, text.data()) < 0) return {};
  return text.c_str();
}

std::optional<double> number_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return std::nullopt;
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, "H5Aopen");
  const Handle space(H5Aget_space(attribute), H5Sclose, "H5Aget_space");
  double value = 0;
  const bool good = H5Sget_simple_extent_npoints(space) == 1 && H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) >= 0;
  return good ? std::optional(value) : std::nullopt;
}

class Hdf5File : public Container {
 public:
  explicit Hdf5File(const std::string& path)
      : file_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose,
              "this is no HDF5 file that can be read: cut short, damaged, or of another kind") {
    const Handle root(H5Gopen2(file_, "/", H5P_DEFAULT), H5Gclose, "its first group cannot be opened");
    const Handle creation(H5Gget_create_plist(root), H5Pclose, "H5Gget_create_plist");
    unsigned order = 0;
    H5Pget_link_creation_order(creation, &order);
    const H5_index_t index = order & H5P_CRT_ORDER_TRACKED ? H5_INDEX_CRT_ORDER : H5_INDEX_NAME;
    if (H5Ovisit2(file_, index, H5_ITER_INC, visit, this, H5O_INFO_BASIC) < 0)
      throw std::runtime_error("its list of data sets cannot be read; the file is damaged");
  }

  std::string read(std::size_t variable, int column, std::size_t first, std::size_t count, double* out) override try {
    const Variable& row = variables_[variable];
    const Handle data(H5Dopen2(file_, row.name.c_str(), H5P_DEFAULT), H5Dclose, "it cannot be opened");
    const Handle space(H5Dget_space(data), H5Sclose, "its shape cannot be read");
    const hsize_t length = count;
    const Handle memory(H5Screate_simple(1, &length, nullptr), H5Sclose, "no memory");
    std::vector<hsize_t> start(row.shape.size(), 0), extent(row.shape.size(), 1);
    if (!start.empty()) {
      const auto longest =
          static_cast<std::size_t>(std::max_element(row.shape.begin(), row.shape.end()) - row.shape.begin());
      const std::size_t along = column < 0 ? longest : 0;
      start[along] = first;
      extent[along] = count;
      if (column >= 0) start[1] = static_cast<hsize_t>(column);
      H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr);
    }
    if (H5Dread(data, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, out) < 0)
      return "its values cannot be read; the file is damaged, or compressed in a way that is not known here";
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }

 private:
  static herr_t visit(hid_t root, const char* name, const H5O_info_t* info, void* self) try {
    if (info->type == H5O_TYPE_DATASET) static_cast<Hdf5File*>(self)->add(root, name);
    return 0;
  } catch (...) {
    return -1;
  }

  void add(hid_t root, const char* name) {
    const Handle data(H5Dopen2(root, name, H5P_DEFAULT), H5Dclose, "a data set cannot be opened");
    const Handle type(H5Dget_type(data), H5Tclose, "a type cannot be read");
    const Handle space(H5Dget_space(data), H5Sclose, "a shape cannot be read");
    Variable row;
    row.name = name;
    row.kind = kind_of(type);
    row.single = H5Tget_class(type) == H5T_FLOAT && H5Tget_size(type) <= 4;
    std::vector<hsize_t> sides(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space))));
    H5Sget_simple_extent_dims(space, sides.data(), nullptr);
    row.shape.assign(sides.begin(), sides.end());
    row.unit = text_attribute(data, "unit");
    if (row.unit.empty()) row.unit = text_attribute(data, "units");
    row.start = number_attribute(data, "start");
    row.step = number_attribute(data, "step");
    variables_.push_back(std::move(row));
  }

  Handle file_;
};

}  // namespace

std::unique_ptr<Container> open_hdf5(const std::string& path) { return std::make_unique<Hdf5File>(path); }

}  // namespace lunid::container
