"""Files that look like meshes and cannot be filtered, each broken in its own way."""

from __future__ import annotations

from pathlib import Path

from commands import write_ply

TRIANGLE = ("0 0 0\n1 0 0\n0 1 0", "3 0 1 2")


def make_broken_meshes(folder: Path, whole: Path) -> dict[str, str]:
    """Write ten broken files.

    Parameters
    ----------
    folder
        Where to; it exists.
    whole
        A binary .ply file of at least some 10 kB, which will be cut off.

    Returns
    -------
    dict
        Name of each file -> a word of the reason why it must fail.
    """
    content = whole.read_bytes()
    (folder / "cut_off.ply").write_bytes(content[: len(content) // 2])
    (folder / "empty.ply").write_bytes(b"")
    (folder / "text.ply").write_text("Dear all,\nplease find the scan attached.\n")
    write_ply(folder / "nan.ply", "nan nan nan\nnan nan nan\nnan nan nan", "3 0 1 2")
    write_ply(folder / "points.ply", TRIANGLE[0], "")
    write_ply(folder / "zero_area.ply", "0 0 0\n1 0 0\n2 0 0", "3 0 1 2")
    (folder / "folder.ply").mkdir()
    (folder / "dangling.ply").symlink_to(folder / "nowhere.ply")
    (folder / "unknown.mesh3").write_text("mesh3 1.0\n")
    huge = write_ply(folder / "huge_counts.ply", *TRIANGLE)
    huge.write_text(huge.read_text().replace("element vertex 3", "element vertex 2000000000"))
    return {
        "cut_off.ply": "was cut off",
        "empty.ply": "is empty",
        "text.ply": "is not PLY",
        "nan.ply": "not finite",
        "points.ply": "point cloud",
        "zero_area.ply": "area",
        "folder.ply": "is a folder",
        "dangling.ply": "does not exist",
        "unknown.mesh3": "cannot read",
        "huge_counts.ply": "",
    }
