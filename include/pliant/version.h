/**
 * \file version.h
 * Which version of the library this is, for C and C++: of these headers as macros, of the library that is linked as a
 * function (pliant_version() of pliant.h in C).
 */
#ifndef PLIANT_VERSION_H
#define PLIANT_VERSION_H

/** Of these headers. */
#define PLIANT_VERSION_MAJOR 0
/** Of these headers. */
#define PLIANT_VERSION_MINOR 3
/** Of these headers. */
#define PLIANT_VERSION_PATCH 0

#ifdef __cplusplus
namespace pliant {

/** A version number. */
struct Version {
  int major, minor, patch;  /**< major.minor.patch */
};

/** Of the library that is linked. */
Version version();

}  // namespace pliant
#endif

#endif
