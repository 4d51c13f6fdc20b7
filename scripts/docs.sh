#!/usr/bin/env bash
# Makes the documentation as a site in target/docs/site, which needs no server. A link that leads
# nowhere ends it. Pages of `make gallery` become part of the site.
#
# The packages of scripts/site/requirements.txt, each checked by its hash, go into target/docs/env.
# BIELA_PYTHON=/path/to/python3 chooses the Python to build on.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
. scripts/lib.sh

PACKAGES=scripts/site/requirements.txt
ENVIRONMENT=target/docs/env
SITE=target/docs/site
GALLERY=target/gallery

if ! cmp -s "$PACKAGES" "$ENVIRONMENT/installed"; then
    say "installing the packages of $PACKAGES (125 MB on disk)"
    rm -rf "$ENVIRONMENT"
    "${BIELA_PYTHON:-python3}" -m venv "$ENVIRONMENT" ||
        fail "no Python that makes a virtual environment with pip" \
            "Install Debian's python3-venv, or name another Python: BIELA_PYTHON=/path/to/python3"
    "$ENVIRONMENT/bin/python" -m pip install --quiet --only-binary :all: --require-hashes -r "$PACKAGES" ||
        fail "the packages of $PACKAGES could not be installed (see pip's message above)" \
            "Check the network and the proxy, then try again."
    # Last, so that an interrupted installation starts again.
    cp "$PACKAGES" "$ENVIRONMENT/installed"
fi

rm -rf "$SITE"
"$ENVIRONMENT/bin/python" -m sphinx --quiet --fail-on-warning --keep-going --fresh-env \
    --conf-dir scripts/site --doctree-dir target/docs/doctrees . "$SITE"
if [ -f "$GALLERY/index.html" ]; then
    cp -R "$GALLERY" "$SITE/gallery"
else
    echo 'without `make gallery`, the site has pictures of the mechanisms and no pages to move them'
fi
echo "$PWD/$SITE/index.html"
