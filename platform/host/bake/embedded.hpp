#pragma once
/// \file embedded.hpp
/// A model table as a source file in C11 and in C++, for firmware.
#include <cstdint>
#include <string>
#include <vector>

namespace pliant::host::bake {

/// The name of the array in a file of this path: the file's name up to its first dot, with _ for what is no ASCII letter or digit.
/// `model_` is put before a name that does not begin with a letter, and before one to which C, C++ or the C
/// library already give a meaning.
std::string array_name(const std::string& path);

/// The table as a source file: a 4-byte aligned constant array `name` and its size `name`_bytes.
std::string embedded(const std::vector<std::uint8_t>& table, const std::string& name);

}  // namespace pliant::host::bake
