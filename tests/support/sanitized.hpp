#pragma once
// Whether the address sanitizer watches this program. Memory and undefined behaviour are what matters there, and every path is
// walked; statistics take fewer repetitions, each of which costs tens of times more.
#if defined(__SANITIZE_ADDRESS__)
#define PLIANT_TEST_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define PLIANT_TEST_SANITIZED 1
#endif
#endif

#if defined(PLIANT_TEST_SANITIZED)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif
