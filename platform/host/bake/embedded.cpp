#include "host/bake/embedded.hpp"

#include <cstring>

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

// Functions and objects of the C standard library, then those of POSIX whose names a file could have: an array of such a name takes
// their place in the whole program, also for the libraries in it.
constexpr const char* kLibrary =
    " abort abs aligned_alloc asctime at_quick_exit atexit atof atoi atol atoll atomic_flag_clear"
    " atomic_flag_test_and_set atomic_signal_fence atomic_thread_fence bsearch btowc c16rtomb c32rtomb"
    " call_once calloc clearerr clock cnd_broadcast cnd_destroy cnd_init cnd_signal cnd_timedwait"
    " cnd_wait ctime difftime div errno exit fclose feclearexcept fegetenv fegetexceptflag fegetround"
    " feholdexcept feof feraiseexcept ferror fesetenv fesetexceptflag fesetround fetestexcept"
    " feupdateenv fflush fgetc fgetpos fgets fgetwc fgetws fopen fprintf fputc fputs fputwc fputws"
    " fread free freopen fscanf fseek fsetpos ftell fwide fwprintf fwrite fwscanf getc getchar getenv"
    " gets getwc getwchar gmtime gmtime_r imaxabs imaxdiv isalnum isalpha isblank iscntrl isdigit"
    " isfinite isgraph isinf isnan isnormal islower isprint ispunct isspace isupper iswalnum iswalpha"
    " iswblank iswcntrl iswctype iswdigit iswgraph iswlower iswprint iswpunct iswspace iswupper"
    " iswxdigit isxdigit labs ldiv llabs lldiv localeconv localtime localtime_r longjmp malloc mblen"
    " mbrlen mbrtoc16 mbrtoc32 mbrtowc mbsinit mbsrtowcs mbstowcs mbtowc memccpy memchr memcmp memcpy"
    " memmove memset mktime mtx_destroy mtx_init mtx_lock mtx_timedlock mtx_trylock mtx_unlock perror"
    " printf putc putchar puts putwc putwchar qsort quick_exit raise rand realloc remove rename rewind"
    " scanf setbuf setjmp setlocale setvbuf signal signbit snprintf sprintf srand sscanf stderr stdin"
    " stdout strcat strchr strcmp strcoll strcpy strcspn strdup strerror strftime strlen strncat"
    " strncmp strncpy strndup strpbrk strrchr strspn strstr strtod strtof strtoimax strtok strtol"
    " strtold strtoll strtoul strtoull strtoumax strxfrm swprintf swscanf system thrd_create"
    " thrd_current thrd_detach thrd_equal thrd_exit thrd_join thrd_sleep thrd_yield time timegm"
    " timespec_get tmpfile tmpnam tolower toupper towctrans towlower towupper tss_create tss_delete"
    " tss_get tss_set ungetc ungetwc vfprintf vfscanf vfwprintf vfwscanf vprintf vscanf vsnprintf"
    " vsprintf vsscanf vswprintf vswscanf vwprintf vwscanf wcrtomb wcscat wcschr wcscmp wcscoll wcscpy"
    " wcscspn wcsftime wcslen wcsncat wcsncmp wcsncpy wcspbrk wcsrchr wcsrtombs wcsspn wcsstr wcstod"
    " wcstof wcstoimax wcstok wcstol wcstold wcstoll wcstombs wcstoul wcstoull wcstoumax wcsxfrm wctob"
    " wctomb wctrans wctype wmemchr wmemcmp wmemcpy wmemmove wmemset wprintf wscanf accept access alarm"
    " bcmp bcopy bind bzero close connect dup environ ffs fork gamma index j0 j1 jn kill link listen"
    " nice open optarg pause pipe poll read recv rindex select send sleep socket stat sync tee times"
    " umask unlink wait write y0 y1 yn ";

// The same of mathematics, each of which has forms with f and l behind the name, too.
constexpr const char* kMathematics =
    " acos acosh asin asinh atan atan2 atanh cabs cacos cacosh carg casin casinh catan catanh cbrt ccos"
    " ccosh ceil cexp cimag clog conj copysign cos cosh cpow cproj creal csin csinh csqrt ctan ctanh"
    " erf erfc exp exp2 expm1 fabs fdim floor fma fmax fmin fmod frexp hypot ilogb ldexp lgamma llrint"
    " llround log log10 log1p log2 logb lrint lround modf nan nearbyint nextafter nexttoward pow"
    " remainder remquo rint round scalbln scalbn sin sinh sqrt tan tanh tgamma trunc ";

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_in(const char* words, const std::string& name) {
  return std::strstr(words, (" " + name + " ").c_str()) != nullptr;
}

bool is_free(const std::string& name) {
  if (name.empty() || !is_letter(name[0])) return false;
  const bool has_suffix = name.back() == 'f' || name.back() == 'l';
  const std::string stem = has_suffix ? name.substr(0, name.size() - 1) : name;
  return !is_in(kTaken, name) && !is_in(kLibrary, name) && !is_in(kMathematics, name) &&
         !is_in(kMathematics, stem);
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
