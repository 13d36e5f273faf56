#!/bin/sh
# See to it that a Chromium for the browser tests is there: install Debian's when this is
# root on a Debian system, say what to install elsewhere.
set -eu

for name in chromium chromium-browser google-chrome google-chrome-stable; do
    if command -v "$name" >/dev/null 2>&1; then
        exit 0
    fi
done

. /etc/os-release 2>/dev/null || ID=unknown
if [ "$ID" = debian ] && [ "$(id -u)" -eq 0 ]; then
    echo "browser: installing chromium for the browser tests" >&2
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends chromium >/dev/null
    exit 0
fi
echo "browser: the browser tests need Chromium or Google Chrome on PATH." >&2
echo "browser: Debian: sudo apt-get install chromium; Fedora: sudo dnf install chromium;" >&2
echo "browser: Arch: sudo pacman -S chromium; Ubuntu: Google's .deb from google.com/chrome." >&2
echo "browser: everything else runs with: make check" >&2
exit 1
