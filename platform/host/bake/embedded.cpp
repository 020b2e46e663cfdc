#include "host/bake/embedded.hpp"

namespace pliant::host::bake {

namespace {

// Names that no array at file scope can have, of those that begin with a letter: the keywords of C up to C23 and of C++ up to C++20
// (words such as `final`, which have a meaning in a few places only, can be names); then what the included headers declare; then
// the program's entry and what compilers define as macros. Each stands between two blanks.
constexpr const char* kTaken =
    " alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t char32_t"
    " char8_t class co_await co_return co_yield compl concept const const_cast consteval constexpr"
    " constinit continue decltype default delete do double dynamic_cast else enum explicit export"
    " extern false float for friend goto if inline int long mutable namespace new noexcept not"
    " not_eq nullptr operator or or_eq private protected public register reinterpret_cast requires"
    " restrict return short signed sizeof static static_assert static_cast struct switch template"
    " this thread_local throw true try typedef typeid typename typeof typeof_unqual union unsigned"
    " using virtual void volatile wchar_t while xor xor_eq NULL max_align_t nullptr_t offsetof"
    " ptrdiff_t size_t std unreachable linux main unix ";

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_free(const std::string& name) {
  return !name.empty() && is_letter(name[0]) &&
         std::string(kTaken).find(" " + name + " ") == std::string::npos;
}

}  // namespace

std::string array_name(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  std::string name = path.substr(slash == std::string::npos ? 0 : slash + 1);
  name = name.substr(0, name.find('.'));
  for (char& c : name)
    if (!is_letter(c) && !(c >= '0' && c <= '9')) c = '_';
  return is_free(name) ? name : "model_" + name;
}

std::string embedded(const std::vector<std::uint8_t>& table, const std::string& name) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text =
      "// A pliant model table, in C11 and C++, written by `pliant bake`; do not edit.\n#include <stdalign.h>\n"
      "#include <stddef.h>\n\n";
  text += "extern const unsigned char " + name + "[];\nextern const size_t " + name + "_bytes;\n\n";
  text += "alignas(4) const unsigned char " + name + "[] = {";
  for (std::size_t i = 0; i < table.size(); ++i) {
    text += i % 24 == 0 ? "\n  0x" : " 0x";
    text += kDigits[table[i] >> 4];
    text += kDigits[table[i] & 15u];
    text += ',';
  }
  return text + "\n};\nconst size_t " + name + "_bytes = sizeof " + name + ";\n";
}

}  // namespace pliant::host::bake
