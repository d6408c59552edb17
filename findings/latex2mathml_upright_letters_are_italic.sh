#!/bin/sh
# latex2mathml 3.81.1: \mathrm{d} is italic, like d.
#
# MathML draws an <mi> of one letter in italics unless it has mathvariant="normal", which \mathrm{ab} gets and
# \mathrm{d} does not: the upright d of a differential, e and i are lost.
#
# Seen: both formulas are <mi>&#x00064;</mi>.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check latex2mathml==3.81.1
"$folder/venv/bin/python" - <<'END'
from latex2mathml.converter import convert

upright, italic, two = convert(r"\mathrm{d}"), convert("d"), convert(r"\mathrm{ab}")
print(upright, italic, two, sep="\n")
assert 'mathvariant="normal"' in two, "this has changed"
assert "mathvariant" not in upright, "this has changed"
END
