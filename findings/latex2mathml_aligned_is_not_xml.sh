#!/bin/sh
# latex2mathml 3.81.1: \begin{aligned} and \text{a & b} give MathML with a bare &, which no XML parser reads.
#
# Unknown environments and characters are passed through as they are, without an error and without escapes; in
# HTML the & is shown. \begin{align*} and \begin{split} work. Its issue 287 of 2022, on aligned, is closed.
#
# Seen: not well-formed (invalid token), for both.
# Needs: python3 with venv, a package index.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check latex2mathml==3.81.1
"$folder/venv/bin/python" - <<'END'
from xml.etree import ElementTree

from latex2mathml.converter import convert

ElementTree.fromstring(convert(r"\begin{align*} a &= b \\ c &= d \end{align*}"))
for formula in (r"\begin{aligned} a &= b \\ c &= d \end{aligned}", r"\text{a & b}"):
    try:
        ElementTree.fromstring(convert(formula))
    except ElementTree.ParseError as error:
        print(f"{formula}: {error}")
    else:
        raise SystemExit("this has changed")
END
