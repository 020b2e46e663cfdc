#pragma once
/// \file jpeg_tables.hpp
/// A check that a JPEG file must pass before stb_image reads it.
#include <string_view>

namespace pliant::host {

/// Whether no Huffman table of a JPEG file lists more codes than the 256 that there can be. The stb_image of Debian 12 (2.27)
/// writes as many as the file says into a table of 257. True for what is no JPEG. Cost: the bytes of the file.
bool has_sound_huffman_tables(std::string_view jpeg);

}  // namespace pliant::host
