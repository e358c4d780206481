#pragma once
// The parts of the module. They throw std::runtime_error with what a person reads; factory.cpp catches.
#include <memory>
#include <string>
#include <vector>

#include "record/container.hpp"

namespace lunid::container {

std::unique_ptr<Container> open_mat(const std::string& path);
std::unique_ptr<Container> open_hdf5(const std::string& path);
std::string encode_hdf5(const std::vector<StoredColumn>& columns);
void write_mat(const std::string& path, const std::vector<StoredColumn>& columns, MatVersion version);

}  // namespace lunid::container
