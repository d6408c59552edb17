"""Damage to a file: parts of it cut out, doubled, or replaced."""

from __future__ import annotations

from hypothesis import strategies as st

WORDS = (b"nan", b"1e400", b"-1", b"99999999999", b"0", b"\0", b"\xff\xfe", b"]}", b"<x>", b"\n")
Damage = tuple[str, float, float, bytes]


def damaged(data: bytes, damages: list[Damage]) -> bytes:
    for kind, begin, length, word in damages:
        first = int(begin * len(data))
        last = first + int(length**4 * len(data))
        middle = {"cut": b"", "twice": 2 * data[first:last], "replaced": word}[kind]
        data = data[:first] + middle + data[last:]
    return data


_shares = st.floats(0, 1)
damages = st.lists(
    st.tuples(
        st.sampled_from(("cut", "twice", "replaced")),
        _shares,
        _shares,
        st.one_of(st.sampled_from(WORDS), st.binary(max_size=4)),
    ),
    min_size=1,
    max_size=3,
)
