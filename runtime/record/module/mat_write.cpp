// Columns to a MAT file of version 5 or 7.3, by matio.
#include <map>
#include <stdexcept>

#include "record/module/files.hpp"
#include "record/module/mat.hpp"

namespace lunid::container {
namespace {

/// A name as MATLAB allows them: letters, digits and "_", a letter first.
std::string plain_name(const std::string& name) {
  std::string plain;
  for (const char c : name) plain += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return std::isalpha(static_cast<unsigned char>(plain[0])) ? plain : "x" + plain;
}

/// Their names in the file.
std::vector<std::string> plain_names(const std::vector<StoredColumn>& columns) {
  std::vector<std::string> names;
  std::map<std::string, std::string> taken;
  for (const StoredColumn& column : columns) {
    names.push_back(plain_name(column.name));
    const auto [other, fresh] = taken.try_emplace(names.back(), column.name);
    if (!fresh)
      throw std::runtime_error("the channels '" + other->second + "' and '" + column.name + "' would both be called '" +
                               names.back() + "' in a MAT file");
  }
  return names;
}

void write(mat_t* file, const Owned& variable) {
  if (!variable || Mat_VarWrite(file, variable.get(), MAT_COMPRESSION_NONE) != 0)
    throw std::runtime_error("the MAT file cannot be written: no room, or no permission");
}

/// units.y = 'm', ..., of the columns that have a unit.
Owned units_of(const std::vector<StoredColumn>& columns, const std::vector<std::string>& names) {
  std::vector<const char*> fields;
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (!columns[i].unit.empty()) fields.push_back(names[i].c_str());
  std::size_t one[] = {1, 1};
  Owned units(Mat_VarCreateStruct("units", 2, one, fields.data(), static_cast<unsigned>(fields.size())));
  for (std::size_t i = 0; units && i < columns.size(); ++i) {
    const std::string& unit = columns[i].unit;
    std::size_t sides[] = {1, unit.size()};
    if (!unit.empty())
      Mat_VarSetStructFieldByName(
          units.get(), names[i].c_str(), 0,
          Mat_VarCreate(names[i].c_str(), MAT_C_CHAR, MAT_T_UINT8, 2, sides, const_cast<char*>(unit.data()), 0));
  }
  return units;
}

}  // namespace

void write_mat(const std::string& path, const std::vector<StoredColumn>& columns, MatVersion version) {
  constexpr std::size_t most = (std::size_t{1} << 31) - 64;  // bytes of a variable in version 5
  const std::vector<std::string> names = plain_names(columns);
  for (const StoredColumn& column : columns)
    if (version == MatVersion::v5 && column.size * sizeof(double) > most)
      throw std::runtime_error("the channel '" + column.name +
                               "' is larger than 2 GB, the most of version 5: save it with version = \"7.3\"");
  // Without the time of making, which matio would write: the same record gives the same header.
  const char* header =
      version == MatVersion::v5 ? "MATLAB 5.0 MAT-file, written by Lunid" : "MATLAB 7.3 MAT-file, written by Lunid";
  const OpenMat file(Mat_CreateVer(path.c_str(), header, version == MatVersion::v5 ? MAT_FT_MAT5 : MAT_FT_MAT73));
  if (!file) throw std::runtime_error("the MAT file cannot be written: no room, or no permission");
  for (std::size_t i = 0; i < columns.size(); ++i) {
    std::size_t sides[] = {columns[i].size, 1};
    write(file.get(), Owned(Mat_VarCreate(names[i].c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, sides,
                                          const_cast<double*>(columns[i].values), MAT_F_DONT_COPY_DATA)));
  }
  write(file.get(), units_of(columns, names));
}

}  // namespace lunid::container
