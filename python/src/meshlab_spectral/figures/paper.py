"""The figures of the paper, for any meshes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from meshlab_spectral.errors import MeshFileError, OptionError
from meshlab_spectral.extras import check_extras
from meshlab_spectral.figures import eigenfunctions, sequences, stability
from meshlab_spectral.figures.subject import Subject
from meshlab_spectral.files.whole_files import check_target

FIGURES = {
    1: ("figure1_stability", stability.draw),
    4: ("figure4_eigenfunctions", eigenfunctions.draw),
    5: ("figure5_sequences", sequences.draw),
}

_WHERE_MESHES_ARE = (
    "The paper's dragon and angel (Lucy) are in the Stanford 3D Scanning Repository, "
    "https://graphics.stanford.edu/data/3Dscanrep/; any other mesh will do, too"
)


def draw_figures(
    sources: Sequence[Path],
    folder: Path,
    only: Sequence[int] = tuple(FIGURES),
    scale: float = 1.0,
    on_stage: Callable[[str], None] = lambda stage: None,
) -> list[Path]:
    """Draw the figures of each mesh, one .png file per figure.

    Parameters
    ----------
    sources
        The mesh files. A mesh is viewed along the shortest axis of its bounding box, with y up, or
        z if y is the shortest axis.
    folder
        Folder for the pictures, created if needed.
    only
        Numbers of the figures, as in the paper.
    scale
        Resolution of the pictures; 1 fills a screen.
    on_stage
        Called with a description of each stage, to show to the user.

    Returns
    -------
    list of Path
        The pictures.

    Raises
    ------
    MeshFileError
        When a mesh cannot be read, or a picture cannot be written.
    OptionError
        When two meshes have the same name.
    FilterError
        When the filter rejects a mesh.
    MissingPackageError
        When Matplotlib or PyVista is not installed.
    """
    check_extras("plots", "render")
    for source in sources:
        if not source.is_file():
            raise MeshFileError(f"there is no mesh file {source}. {_WHERE_MESHES_ARE}")
    names = [source.stem for source in sources]
    for name in names:
        if names.count(name) > 1:
            raise OptionError(
                f"two meshes are named {name}, and so would be their pictures: rename one"
            )
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise MeshFileError(
            f"the folder {folder} cannot be created ({error.strerror}): choose another one"
        ) from error
    for name in names:
        for number in only:
            check_target(folder / f"{FIGURES[number][0]}_{name}.png")
    pictures = []
    for source in sources:
        subject = Subject(source, on_stage)
        for number in only:
            name, draw = FIGURES[number]
            picture = folder / f"{name}_{subject.name}.png"
            draw(subject, picture, scale)
            pictures.append(picture)
    return pictures
