/**
 * \file version.h
 * Which version of the library this is, for C and C++: of these headers as macros, of the library that is linked as a
 * function (pliant_version() of pliant.h in C).
 */
#ifndef PLIANT_VERSION_H
#define PLIANT_VERSION_H

#define PLIANT_VERSION_MAJOR 0
#define PLIANT_VERSION_MINOR 2
#define PLIANT_VERSION_PATCH 0

#ifdef __cplusplus
namespace pliant {

struct Version {
  int major, minor, patch;
};

/** Of the library that is linked. */
Version version();

}  // namespace pliant
#endif

#endif
