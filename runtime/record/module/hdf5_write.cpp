// Columns to an HDF5 file in memory. Without the times of making, which HDF5 would write: the same columns give the
// same bytes.
#include "record/module/files.hpp"
#include "record/module/handle.hpp"

namespace lunid::container {
namespace {

void require(herr_t status, const char* what) {
  if (status < 0) throw std::runtime_error(std::string("HDF5: ") + what + " failed");
}

void write_text(hid_t object, const char* name, const std::string& text) {
  if (text.empty()) return;
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "HDF5: H5Tcopy failed");
  require(H5Tset_size(type, text.size() + 1), "H5Tset_size");
  require(H5Tset_cset(type, H5T_CSET_UTF8), "H5Tset_cset");
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "HDF5: H5Screate failed");
  const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         "HDF5: H5Acreate failed");
  require(H5Awrite(attribute, type, text.c_str()), "H5Awrite");
}

void write_number(hid_t object, const char* name, const std::optional<double>& value) {
  if (!value) return;
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "HDF5: H5Screate failed");
  const Handle attribute(H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         "HDF5: H5Acreate failed");
  require(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &*value), "H5Awrite");
}

/// Groups on the way to a data set ("run1/y") are made, and keep the order as the root does.
Handle link_options() {
  Handle options(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "HDF5: H5Pcreate failed");
  require(H5Pset_create_intermediate_group(options, 1), "H5Pset_create_intermediate_group");
  return options;
}

void write_column(hid_t file, const StoredColumn& column) {
  const hsize_t size = column.size;
  const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, "HDF5: H5Screate_simple failed");
  const Handle options(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "HDF5: H5Pcreate failed");
  require(H5Pset_obj_track_times(options, false), "H5Pset_obj_track_times");
  const std::string failure = "the column '" + column.name + "' cannot be written: its name is taken or is no name";
  const Handle data(H5Dcreate2(file, column.name.c_str(), H5T_IEEE_F64LE, space, link_options(), options, H5P_DEFAULT),
                    H5Dclose, failure.c_str());
  require(H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, column.values), "H5Dwrite");
  write_text(data, "unit", column.unit);
  write_number(data, "start", column.start);
  write_number(data, "step", column.step);
}

}  // namespace

std::string encode_hdf5(const std::vector<StoredColumn>& columns) {
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "HDF5: H5Pcreate failed");
  require(H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED),
          "H5Pset_link_creation_order");
  require(H5Pset_obj_track_times(creation, false), "H5Pset_obj_track_times");
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "HDF5: H5Pcreate failed");
  constexpr std::size_t increment = 1 << 20;
  require(H5Pset_fapl_core(access, increment, false), "H5Pset_fapl_core");  // false: nothing goes to the disk
  const Handle file(H5Fcreate("lunid.h5", H5F_ACC_TRUNC, creation, access), H5Fclose, "HDF5: H5Fcreate failed");
  for (const StoredColumn& column : columns) write_column(file, column);
  require(H5Fflush(file, H5F_SCOPE_GLOBAL), "H5Fflush");
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  if (size < 0) throw std::runtime_error("HDF5: H5Fget_file_image failed");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(file, bytes.data(), bytes.size()) < 0)
    throw std::runtime_error("HDF5: H5Fget_file_image failed");
  return bytes;
}

}  // namespace lunid::container
