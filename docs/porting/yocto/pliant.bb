# A recipe that builds the checkout that it is part of: put this folder's path into a layer's BBFILES, or copy the recipe and
# set EXTERNALSRC.
SUMMARY = "Fits and tracks deformable 3D models, faces first, in fixed memory and without a heap"
LICENSE = "MIT"
LIC_FILES_CHKSUM = "file://LICENSE;md5=483f54a9664d1c83747a9eb26411e98d"
PV = "0.3.0"

inherit cmake externalsrc
EXTERNALSRC = "${@os.path.abspath(os.path.join(d.getVar('THISDIR'), '..', '..', '..'))}"

# The library. The pliant command bakes the built-in face while it is built, which a cross build cannot.
EXTRA_OECMAKE = "-DPLIANT_HOST=OFF -DPLIANT_TESTS=OFF -DPLIANT_LIBCAMERA=OFF"

# Static libraries and headers alone: there is nothing to install on the device but what a program links.
ALLOW_EMPTY:${PN} = "1"
