#pragma once
// Whether the address sanitizer watches this program. Memory and undefined behaviour are what matters there, and every path is
// walked; statistics take fewer repetitions, each of which costs tens of times more.
#if defined(__SANITIZE_ADDRESS__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif
