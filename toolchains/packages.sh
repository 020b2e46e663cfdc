#!/bin/sh
# Installs those of the named Debian or Ubuntu packages that are missing, and nothing else.
# usage: sh toolchains/packages.sh PACKAGE...
set -eu
missing=""
for package in "$@"; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing="$missing $package"
done
[ -n "$missing" ] || exit 0
if ! command -v apt-get >/dev/null 2>&1; then
  echo "This is no Debian or Ubuntu; install by hand, under whatever names they bear here:$missing" >&2
  exit 0
fi
echo "Installing$missing"
root=""
[ "$(id -u)" = 0 ] || root="sudo"
$root apt-get -o DPkg::Lock::Timeout=300 update -q
# shellcheck disable=SC2086
$root apt-get -o DPkg::Lock::Timeout=300 install -q -y --no-install-recommends $missing
