#!/usr/bin/env bash
# Bundles the studio's text editor into crates/studio/editor/bundle.js, with the licences of all that is
# inside in licenses.txt beside it. Both are committed: building biela needs neither node nor npm.
#
#   scripts/editor.sh            writes them
#   scripts/editor.sh --check    fails if they are out of date
#
# Needs Node 18 or newer with npm; its packages go into target/editor.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/lib.sh
. scripts/lib.sh

SOURCES=crates/studio/editor
WORK=target/editor

{ has node && has npm; } || fail "node and npm are not there" "Install Node 18 or newer, or Debian's nodejs and npm."
mkdir -p "$WORK"
cp "$SOURCES/package.json" "$SOURCES/package-lock.json" "$WORK"
(cd "$WORK" && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error) ||
    fail "the packages of $SOURCES/package-lock.json could not be installed (see npm's message above)" \
        "Check the network and the proxy, then try again."

# One name for all, whether the file is imported or stands with the page's other scripts in one
# module, where `export` falls away.
NODE_PATH=$WORK/node_modules "$WORK/node_modules/.bin/esbuild" "$SOURCES/editor.js" \
    --bundle --minify --format=iife --global-name=makeEditor --target=es2022 --charset=utf8 \
    --legal-comments=none --log-level=warning --metafile="$WORK/inside.json" --outfile="$WORK/bundle.js" \
    --banner:js='// Made by scripts/editor.sh; licences in licenses.txt.' \
    --footer:js=$'makeEditor = makeEditor.makeEditor;\nexport { makeEditor };'
node scripts/editor_licences.mjs "$WORK" >"$WORK/licenses.txt"
if grep -qiE '</script|<!--|^import ' "$WORK/bundle.js" || [ "$(grep -c '^export ' "$WORK/bundle.js")" != 1 ]; then
    fail "the bundle cannot stand in a page's script"
fi

if [ "${1:-}" = --check ]; then
    for file in bundle.js licenses.txt; do
        cmp "$WORK/$file" "$SOURCES/$file" || fail "$SOURCES/$file is out of date" "Run \`make editor\`."
    done
else
    cp "$WORK/bundle.js" "$WORK/licenses.txt" "$SOURCES"
fi
say "bundle.js: $(wc -c <"$WORK/bundle.js") bytes, $(gzip -9 -c "$WORK/bundle.js" | wc -c) packed"
