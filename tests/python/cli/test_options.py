"""The options of `meshlab-spectral filter`: each reaches the filter, wrong ones are named."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import plyfile
import pymeshlab
import pytest
import tomllib
from commands import arrays_of, assert_fails, command, succeeded
from helpers import FILTER, as_percentages, loaded, other_options, percent
from meshlab_spectral import FilterOptions, denoise_preset, filter_preset
from meshlab_spectral.files.presets import PRESETS


def test_every_option_reaches_the_filter(cow: Path, tmp_path: Path) -> None:
    options = other_options(
        feature_size="12%", basis_size=60, crease_angle=120.0, stop_gain=1.0, preserve_volume=True
    )
    arguments: list[object] = []
    for name, value in options.items():
        option = name.replace("_", "-")
        if isinstance(value, bool):
            arguments.append(f"--{option}" if value else f"--no-{option}")
        else:
            arguments += [f"--{option}", value]
    target = tmp_path / "cow.ply"
    done = command("filter", cow, target, "--json", *arguments)
    assert json.loads(done.stdout)["options"] == options
    mesh_set = loaded(cow)
    mesh_set.apply_filter(FILTER, **as_percentages(options))
    V, _ = arrays_of(target)
    np.testing.assert_array_equal(V, mesh_set.current_mesh().vertex_matrix())


def test_help_names_every_option_and_the_exit_codes() -> None:
    done = succeeded("filter", "--help")
    for name in FilterOptions().as_dict():
        assert f"--{name.replace('_', '-')}" in done.stdout
    assert "130 interrupted" in " ".join(done.stdout.split())
    assert "--debug" not in done.stdout


def test_version_names_the_package_and_pymeshlab() -> None:
    done = succeeded("--version")
    assert re.fullmatch(r"meshlab-spectral \d+\.\d+\.\d+, pymeshlab 2025\.7\.post1\n", done.stdout)


def test_pip_installs_the_command_under_its_name() -> None:
    installed = Path(sys.executable).with_name("meshlab-spectral")
    done = subprocess.run(
        [installed, "--version"], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout.startswith("meshlab-spectral ")


def test_a_preset_equals_its_options(cow: Path, tmp_path: Path) -> None:
    """In Python; and in the shell, where every option is tried above, two of them."""
    for name, preset in PRESETS.items():
        function = filter_preset if preset.table is FilterOptions else denoise_preset
        assert function(name) == preset.table(**preset.options)
        if name not in ("print", "museum"):  # of each filter one, with a switch and a length
            continue
        given = {**preset.table().as_dict(), **preset.options}
        spelled = [
            f"--{key.replace('_', '-')}" + ("" if given[key] is True else f"={given[key]}")
            for key in preset.options
        ]
        one, other = tmp_path / f"{name}.ply", tmp_path / f"{name}_spelled.ply"
        command(preset.table.TABLE, cow, one, "--preset", name)
        command(preset.table.TABLE, cow, other, *spelled)
        assert one.read_bytes() == other.read_bytes(), name


def test_presets_of_the_user_are_saved_and_used(
    cow: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for variable in ("XDG_CONFIG_HOME", "HOME"):
        monkeypatch.setenv(variable, str(tmp_path))
    one, other = tmp_path / "one.ply", tmp_path / "other.ply"
    done = succeeded("denoise", cow, one, "--strength", "0.5", "--save-preset", "half")
    command("denoise", cow, other, "--preset", "half")
    assert one.read_bytes() == other.read_bytes()
    assert denoise_preset("half", keep_creases=False).strength == 0.5
    done = command("filter", cow, one, "--preset", "half", "--overwrite")
    assert_fails(done, 2, "the preset half is for denoise")
    done = command("batch", cow, "-o", tmp_path / "out", "--preset", "half")
    assert_fails(done, 2, "the preset half is for denoise: add --denoise")
    done = succeeded("batch", cow, "-o", tmp_path / "out", "--preset", "half", "--denoise")
    done = command("filter", cow, tmp_path / "x.ply", "--save-preset", "sharpen")
    assert_fails(done, 2, "preset sharpen: is there already")


def test_details_are_saved_with_the_shape_they_were_taken_from(cow: Path, tmp_path: Path) -> None:
    target = tmp_path / "details.ply"
    command("filter", cow, target, "--preset", "extract-details", "--feature-size", "8%")
    assert b" spectral_details\n" in target.read_bytes().partition(b"end_header")[0]
    saved, mesh_set = pymeshlab.MeshSet(), pymeshlab.MeshSet()
    saved.load_new_mesh(str(target))
    mesh_set.load_new_mesh(str(cow))
    mesh, before = saved.current_mesh(), mesh_set.current_mesh().vertex_matrix().copy()
    np.testing.assert_array_equal(mesh.vertex_matrix(), before)
    mesh_set.apply_filter(FILTER, result="details", feature_size=percent(8))
    np.testing.assert_array_equal(
        mesh.vertex_scalar_array(), mesh_set.current_mesh().vertex_scalar_array()
    )


def test_the_height_of_noise_is_saved_as_an_attribute(cow: Path, tmp_path: Path) -> None:
    target = tmp_path / "heights.ply"
    command("denoise", cow, target, "--noise-height", "0.1e", "--store-noise-height")
    heights = plyfile.PlyData.read(target)["vertex"]["noise_height"]
    assert (heights > 0).all()


def test_options_given_besides_a_preset_replace_its_own(cow: Path, tmp_path: Path) -> None:
    one, other = tmp_path / "one.ply", tmp_path / "other.ply"
    command("filter", cow, one, "--pass-gain", "1.5", "--preset", "sharpen")
    sharpened = ["--filter-type=high-pass", "--feature-size=3%", "--stop-gain=1"]
    command("filter", cow, other, *sharpened, "--pass-gain", "1.5")
    assert one.read_bytes() == other.read_bytes()


def test_in_a_batch_a_preset_overrides_a_recipe(cow: Path, tmp_path: Path) -> None:
    recipe = tmp_path / "recipe.toml"
    recipe.write_text('[filter]\nfeature_size = "20%"\nsteps = 1\n', encoding="utf-8")
    saved = tmp_path / "saved.toml"
    arguments = ["--recipe", recipe, "--preset", "sharpen", "--save-recipe", saved]
    command("batch", cow, "--output", tmp_path / "out", *arguments)
    written = saved.read_text(encoding="utf-8")
    assert 'feature_size = "3%"' in written
    assert "steps = 1" in written


def test_a_recipe_is_tried_on_one_mesh_and_serves_a_batch(cow: Path, tmp_path: Path) -> None:
    recipe, one = tmp_path / "recipe.toml", tmp_path / "cow.obj"
    options = ["--preset", "sharpen", "--steps", 1, "--crease-angle", 120]
    done = succeeded("filter", cow, one, *options, "--save-recipe", recipe)
    out = tmp_path / "out"
    command("batch", cow, "--output", out, "--recipe", recipe, "--workers", 1)
    assert (out / "cow.obj").read_bytes() == one.read_bytes()
    done = command("filter", cow, one, "--overwrite", "--recipe", recipe, "--steps", 2, "--json")
    chosen = json.loads(done.stdout)["options"]
    assert (chosen["steps"], chosen["pass_gain"], chosen["crease_angle"]) == (2, 2.0, 120.0)


def test_a_recipe_is_saved_only_after_success(cow: Path, tmp_path: Path) -> None:
    recipe, out = tmp_path / "recipe.toml", tmp_path / "out.ply"
    for wrong in ((tmp_path / "none.ply", out), (cow, tmp_path / "out.xyzzy")):
        assert command("filter", *wrong, "--save-recipe", recipe).returncode in (1, 2)
        assert not list(tmp_path.iterdir())
    assert_fails(command("filter", cow, out, "--recipe", recipe), 2, "recipe.toml cannot be read")
    assert not out.exists()


@pytest.mark.parametrize(
    ("line", "completed"),
    [
        ("de", "denoise"),
        ("filter --filter-type band-s", "band-stop"),
        ("filter --crease-a", "--crease-angle"),
        ("filter --weight ver", "vertex\\ quality"),  # one word of the shell
    ],
)
def test_the_shell_completes_commands_options_and_choices(line: str, completed: str) -> None:
    done = command(
        _MESHLAB_SPECTRAL_COMPLETE="complete_bash",
        COMP_WORDS=f"meshlab-spectral {line}",
        COMP_CWORD=str(len(line.split())),
    )
    assert done.stdout.splitlines() == [completed], done.stderr


@pytest.mark.parametrize("order", [1, -1])
def test_an_equalizer_overrides_a_preset_on_either_side_of_it(
    order: int, samples: Path, tmp_path: Path
) -> None:
    shortcuts = [["--preset", "sharpen"], ["--equalizer", "1,1,1,1,1,0"]][::order]
    target, recipe = tmp_path / "out.ply", tmp_path / "one.toml"
    words = ["filter", samples / "bunny.obj", target, "--save-recipe", recipe]
    command(*words, *shortcuts[0], *shortcuts[1])
    options = tomllib.loads(recipe.read_text())["filter"]
    assert options["filter_type"] == "custom"
    assert options["transfer_function"].endswith("3e:0")
    assert options["feature_size"] == "3%"


def test_the_equalizer_agrees_with_that_of_meshlab(samples: Path, tmp_path: Path) -> None:
    bunny, target = samples / "bunny.obj", tmp_path / "out.ply"
    done = command(
        "filter", bunny, target, "--equalizer", "1,1,2,1,0.5,0", "--tolerance", "0.01%", "--json"
    )
    assert json.loads(done.stdout)["options"]["transfer_function"] == (
        "192e:1, 96e:1, 48e:1, 24e:2, 12e:1, 6e:0.5, 3e:0"
    )
    mesh_set = loaded(bunny)
    before = mesh_set.current_mesh().vertex_matrix()
    mesh_set.apply_coord_spectral_equalizer(gain_8x=2, gain_2x=0.5, gain_1x=0, accurate=True)
    expected = mesh_set.current_mesh().vertex_matrix()
    mesh_set.load_new_mesh(str(target))
    moved = np.abs(expected - before).max()
    np.testing.assert_allclose(mesh_set.current_mesh().vertex_matrix(), expected, atol=0.1 * moved)
