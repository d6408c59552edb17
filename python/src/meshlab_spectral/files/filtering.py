"""Mesh files: filtering their meshes, and writing the results.

If the format stays the same, the file is patched (`formats`): only coordinates and normals
change. Conversions, scripts, and formats that only MeshLab knows go through MeshLab.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from shutil import copyfile
from typing import Any

import numpy as np

from meshlab_spectral.errors import FilterError, FormatError, MeshFileError, OptionError
from meshlab_spectral.files.extensions import is_same_format
from meshlab_spectral.files.meshes import (
    chosen_by_name,
    in_scene,
    part_of,
    whole_of,
)
from meshlab_spectral.files.meshlab_files import (
    DUMMY,
    check_writable,
    left_behind,
    left_by_meshlab,
    read_with_meshlab,
    rounding_warnings,
    set_quality,
    write_with_meshlab,
)
from meshlab_spectral.files.region import Region
from meshlab_spectral.files.region_vertices import chosen_parts
from meshlab_spectral.files.request import Request
from meshlab_spectral.files.script import apply_script
from meshlab_spectral.files.sources import check_name, check_source
from meshlab_spectral.files.touching import moved_alike, pieces
from meshlab_spectral.filters.option_types import Options
from meshlab_spectral.filters.progress import StageCallback
from meshlab_spectral.filters.running import Run, run
from meshlab_spectral.formats.document import Array, Document, Part, joined, split
from meshlab_spectral.formats.opening import format_of, open_document
from meshlab_spectral.formats.side_files import copy_side_files
from meshlab_spectral.plugin.loading import load
from meshlab_spectral.plugin.mesh_sets import DETAILS, NOISE_HEIGHT, mesh_set_of, write
from meshlab_spectral.warned import Warned, warned, with_warnings

# Formats that MeshLab reads without losing placement, units or all meshes but one.
_READ_BY_MESHLAB = (".ply", ".obj", ".off", ".stl")
# MeshLab would invent it for a mesh made from arrays.
_BARE = {".ply": {"save_vertex_quality": False}}


def filter_to_scratch(request: Request, scratch: Path, on_stage: StageCallback) -> dict[str, Any]:
    """Filter a mesh file into another, `scratch`, which after an error may be incomplete.

    All meshes of the file, unless one is named, are filtered, each on its own, as placed in the
    scene, but those whose borders coincide together; coinciding vertices move alike. In the format
    of the source only coordinates and normals change; another format is written by MeshLab, with a
    warning that lists what is lost. `on_stage` is called with "reading", "filtering" and "writing"
    as these begin, with None, and with the progress of the filter.

    Returns the filter's report, as from `filter_mesh`, with the mesh's name, if any, as "mesh". For
    several surfaces, a list of their reports as "meshes", and "warnings" and "max_displacement" of
    all of them. For a script, the report of `script.apply_script`, which has its errors, too.

    Raises MeshFileError when the source cannot be read or `scratch` cannot be written, FormatError
    when its extension cannot be written, FilterError when the filter rejects a mesh or the options,
    and OptionError when no mesh has the name, or the region is empty.
    """
    if request.script is not None:
        script = partial(apply_script, text=request.script)
        return _through_meshlab(request, scratch, script, on_stage)
    source, options, region = request.source, request.options, request.region
    require_one_choice(options, region)
    if region:
        options = options.from_dict({**options.as_dict(), "selected": True})

    def apply(mesh_set: Any) -> dict[str, Any]:
        (part,) = chosen_parts([part_of(mesh_set.current_mesh())], options, region)
        assert part is not None
        done = _run(part, options, on_stage)
        text = done.text if request.verbose else ""
        results = {"vertices": done.vertices, "details": done.details, "values": done.values}
        write(mesh_set, options.FILTER, **results, text=text)
        if request.verbose:
            print(*done.report["warnings"], sep="\n", file=sys.stderr)
        return _with_choice(done.plain_report, part, options)

    if attribute := wanted_attribute(options, scratch):
        return _through_meshlab(request, scratch, apply, on_stage, {attribute: True})
    if format_of(source) and (
        source.suffix.lower() not in _READ_BY_MESHLAB or is_same_format(source, scratch)
    ):
        return _filter_document(replace(request, options=options), scratch, on_stage)
    if request.mesh is not None:
        raise OptionError(f"{source} is read as one mesh: leave out the name {request.mesh!r}")
    return _through_meshlab(request, scratch, apply, on_stage)


def _filter_document(request: Request, scratch: Path, on_stage: StageCallback) -> dict[str, Any]:
    """Filter the meshes of a document: each surface on its own, of one mesh or several pieces."""
    source = request.source
    on_stage("reading", None)
    check_source(source)
    stays = is_same_format(source, scratch)
    if not stays:
        load()
        check_writable(scratch)
    document = open_document(source)
    chosen = chosen_by_name(document, request.mesh)
    shapes, names, reports, parted = _moved(document.parts, chosen, request, on_stage)
    if stays:
        warnings = document.save(scratch, shapes)
    else:
        bare = _BARE.get(scratch.suffix.lower())
        write_with_meshlab(_merged(document, request.verbose, shapes), scratch, source, (), bare)
        warnings = left_behind(document, scratch)
        warnings += rounding_warnings(joined(document.parts)[0], np.vstack(shapes), scratch)
    return _report(names, reports, document.warnings + parted + warnings)


def joined_to_scratches(
    sources: Sequence[Path], scratches: Sequence[Path], options: Options, on_stage: StageCallback
) -> dict[str, Any]:
    """Filter the meshes of several files together, as `filter_to_scratch` does those of one.

    Each file is written in its own format. The report has the largest displacement in each file as
    "largest".
    """
    on_stage("reading", None)
    for source, scratch in zip(sources, scratches, strict=True):
        check_source(source)
        if not format_of(source) or not is_same_format(source, scratch):
            raise FormatError(
                f"{source.name} cannot be joined with others: convert it to a format that the "
                "output keeps, such as ply, and leave out --format"
            )
    request = Request(sources[0], options, verbose=False)
    documents = [open_document(source) for source in sources]
    parts = [
        replace(part, name=f"{document.path.name} {part.name}".strip())
        for document in documents
        for part in document.parts
    ]
    shapes, names, reports, warnings = _moved(parts, parts, request, on_stage)
    ends = np.cumsum([len(document.parts) for document in documents])
    largest = []
    for document, scratch, end in zip(documents, scratches, ends.tolist(), strict=True):
        after = shapes[end - len(document.parts) : end]
        told = document.warnings + document.save(scratch, after)
        warnings += [warning.of(document.path.name) for warning in told]
        moved = np.vstack(after) - np.vstack([part.vertices for part in document.parts])
        largest.append(float(np.linalg.norm(moved, axis=1).max(initial=0.0)))
    return {**_report(names, reports, warnings), "largest": largest}


def _moved(
    parts: Sequence[Part], chosen: Sequence[Part], request: Request, on_stage: StageCallback
) -> tuple[list[Array], list[str], list[dict[str, Any]], list[Warned]]:
    """Filter chosen parts, each surface on its own.

    Returns the vertices of all parts; the names of the surfaces, and the report of each; warnings.
    """
    on_stage("filtering", None)
    moved = {part: part.vertices for part in parts}
    names, reports = [], []
    groups = pieces(chosen)
    wholes = chosen_parts(map(whole_of, groups), request.options, request.region)
    for group, whole in zip(groups, wholes, strict=True):
        if whole is None:
            continue
        after, report = _filtered(whole, request, on_stage, len(groups) == 1)
        moved.update(zip(group, split(after, group), strict=True))
        names.append(whole.name)
        reports.append(report)
    on_stage("writing", None)
    shapes, parted = moved_alike(parts, list(moved.values()), chosen)
    return shapes, names, reports, parted


def wanted_attribute(options: Options, target: Path) -> str:
    """Return the vertex attribute to write, by the name that MeshLab's exporter gives it, or "".

    Raises FormatError unless `target` can hold it.
    """
    if getattr(options, "result", "") == "details":
        setting, contents = f"__ca_vp__{DETAILS}", "details"
    elif getattr(options, "store_noise_height", False):
        setting, contents = f"__ca_vs__{NOISE_HEIGHT}", "the height of noise"
    else:
        return ""
    if target.suffix.lower() != ".ply":
        raise FormatError(f"{target.name} cannot hold {contents}: choose .ply")
    return setting


def require_one_choice(options: Options, region: Region) -> None:
    """Raise OptionError when both the file and the user select what is filtered."""
    if region and getattr(options, "selected", False):
        names = ", ".join(region.given())
        raise OptionError(f"selected and {names}: both choose what is filtered; leave one out")


def _filtered(
    part: Part, request: Request, on_stage: StageCallback, is_alone: bool
) -> tuple[Array, dict[str, Any]]:
    """Filter a mesh; return its vertices and the report."""
    try:
        done = _run(part, request.options, on_stage)
    except FilterError as error:
        if is_alone:
            raise
        raise type(error)(f"mesh {part.name}: {error}") from error
    if request.verbose:
        print(done.text, *done.report["warnings"], sep="\n", file=sys.stderr)
    report = _with_choice(done.plain_report, part, request.options)
    return part.vertices if done.vertices is None else done.vertices, report


def _run(part: Part, options: Options, on_stage: StageCallback) -> Run:
    return run(
        options.FILTER,
        part.vertices,
        part.faces,
        options.core_parameters(),
        selected=part.selected,
        values=None if part.quality is None else part.quality[:, None],
        progress=on_stage,
    )


def _with_choice(report: dict[str, Any], part: Part, options: Options) -> dict[str, Any]:
    """Add a summary of what was chosen to be filtered, where the filter has none of its own."""
    flags = part.selected if getattr(options, "selected", False) else None
    if flags is None or flags.all() or "summary" in report:
        return report
    chosen = f"{np.count_nonzero(flags)} of {len(part.vertices)} vertices"
    return {**report, "summary": f"only {chosen} are chosen; around them, the effect fades out"}


def _merged(document: Document, verbose: bool, moved: Sequence[Array] | None = None) -> Any:
    """Return a MeshSet with all that is in the scene of a document as one mesh."""
    parts = document.parts
    if moved is not None:
        parts = [replace(part, vertices=V) for part, V in zip(parts, moved, strict=True)]
    parts = in_scene(parts)
    return mesh_set_of(*joined(parts), _signal(parts[0]) if len(parts) == 1 else {}, verbose)


def _signal(part: Part) -> dict[str, Array]:
    return {} if part.quality is None else {"v_scalar_array": part.quality}


def _report(
    names: list[str], reports: list[dict[str, Any]], warnings: list[Warned]
) -> dict[str, Any]:
    """Combine the reports of all meshes."""
    if len(reports) == 1:
        named = {"mesh": names[0]} if names[0] else {}
        return with_warnings({**named, **reports[0]}, warned(reports[0]) + warnings)
    both = list(zip(names, reports, strict=True))
    combined = {
        "meshes": [{"mesh": name, **one} for name, one in both],
        "max_displacement": max(report["max_displacement"] for report in reports),
    }
    each = [warning.of(name) for name, report in both for warning in warned(report)]
    return with_warnings(combined, each + warnings)


def _through_meshlab(
    request: Request,
    scratch: Path,
    apply: Callable[[Any], dict[str, Any]],
    on_stage: StageCallback,
    settings: dict[str, bool] | None = None,
) -> dict[str, Any]:
    """Let MeshLab write the file and, if it reads all of its contents, also read it."""
    source = request.source
    load()
    on_stage("reading", None)
    check_source(source)
    check_name(scratch, scratch.parent.parent / scratch.name)
    check_writable(scratch)
    document = open_document(source) if format_of(source) else None
    mesh_set, lacking = _loaded(source, document, request.verbose)
    on_stage("filtering", None)
    before = mesh_set.current_mesh().vertex_matrix()
    report = apply(mesh_set)
    on_stage("writing", None)
    if is_same_format(source, scratch) and report.get("max_displacement") == 0 and not settings:
        copyfile(source, scratch)
        textures = mesh_set.current_mesh().textures()
        warnings = copy_side_files(source, scratch, [one for one in textures if one != DUMMY])
        return with_warnings(report, warned(report) + warnings)
    given = None
    if document is not None and request.script is None:
        given = () if lacking is None else document.contents
    write_with_meshlab(mesh_set, scratch, source, given, settings)
    if document is None:
        warnings = left_by_meshlab(source, scratch, mesh_set)
    else:
        read = None if lacking is None else mesh_set
        warnings = left_behind(document, scratch, read, lacking or ())
    warnings += rounding_warnings(before, mesh_set.current_mesh().vertex_matrix(), scratch)
    return with_warnings(report, warned(report) + warnings)


def _loaded(
    source: Path, document: Document | None, verbose: bool
) -> tuple[Any, Collection[str] | None]:
    """Return a MeshSet, and which contents of the file it lacks that MeshLab could hold.

    These are None if MeshLab has not read the file itself, but only got its arrays.
    """
    import pymeshlab

    if document is None or (source.suffix.lower() in _READ_BY_MESHLAB and document.is_harmless()):
        mesh_set = pymeshlab.MeshSet(verbose=verbose)
        try:
            read_with_meshlab(mesh_set, source)
        except MeshFileError:
            if document is None:
                raise
        else:
            return mesh_set, _agreed(mesh_set, document) if document else ()
    return _merged(document, verbose), None


def _agreed(mesh_set: Any, document: Document) -> Collection[str]:
    """Let MeshLab's mesh have the triangles and the quality of the document.

    MeshLab folds concave polygons of PLY files, splits others of OFF files by rules of its own, and
    reads no quality that is called confidence. Returns the contents that are lost by that.
    """
    import pymeshlab

    (part,) = document.parts
    mesh, lacking = mesh_set.current_mesh(), list[str]()
    if "polygons" in document.contents and _differ(mesh, part):
        data = {"v_normals_matrix": mesh.vertex_normal_matrix(), **_signal(part)}
        if mesh.has_vertex_color():
            data["v_color_matrix"] = mesh.vertex_color_matrix()
        mesh_set.add_mesh(pymeshlab.Mesh(part.vertices, part.faces, **data))
        lacking = ["texture coordinates", "texture names", "materials", "face colours"]
    elif part.quality is not None:
        set_quality(mesh_set, part.quality)
    return lacking


def _differ(mesh: Any, part: Part) -> bool:
    faces = mesh.face_matrix()
    if faces.shape != part.faces.shape or mesh.vertex_number() != len(part.vertices):
        return True
    return bool((faces != part.faces).any())
