"""Shared by all commands: --quiet and --verbose, grouped help, usage errors."""

from __future__ import annotations

import contextlib
import inspect
import re
import shutil
import sys
import textwrap
from collections.abc import Callable, Collection, Iterator, Sequence
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from meshlab_spectral.cli.messages import EXIT_USAGE, VERBOSITY, flag, print_error
from meshlab_spectral.other_words import instead_of

Command = Callable[..., None]

# The groups of --help and their options; all other options are in the group named by
# `rich_help_panel` (those of the core: "Solver"), or under "Options".
SOLVER, DENOISE = "Solver", "With --denoise"
_GROUPS = {
    "Filter": """preset equalizer recipe script denoise only filter_type feature_size pass_gain
        stop_gain transfer_function band_width response order power
        strength noise_height noise_size""",
    DENOISE: "",
    "Region": "mesh selected box component where mask boundary crease_angle keep_creases weight",
    SOLVER: """steps tolerance passes basis_update conformal_share spectrum basis_size
        reinject_residual laplacian preserve_volume""",
    "Files": "recursive joined overwrite resume dry_run tiles memory",
    "Workers": "workers memory_limit timeout scheduler",
    "Output": """output name ending result picture color_displacement pictures modes scale
        save_recipe save_preset report as_json""",
}
GROUP_OF = {name: group for group, names in _GROUPS.items() for name in names.split()}

# Typer bundles its own copy of Click; older versions depend on Click itself.
_UsageError: type[Exception] = typer.BadParameter.__mro__[1]

_MORE = "Print all numbers, files and warnings, and MeshLab's log."
_VERBOSITY = (
    (
        "quiet",
        typer.Option("--quiet", "-q", help="Print only errors, warnings and what was asked for."),
    ),
    ("verbose", typer.Option("--verbose", "-v", help=_MORE)),
    ("debug", typer.Option("--debug", hidden=True)),
)


# What a command knows of its help, in Click's `Context.meta`: -h was given; names will do.
_SHORT, _NAMES = "meshlab_spectral.short", "meshlab_spectral.names"


class OneCommand(TyperCommand):
    """A command whose --help lists its options in groups; -h fits on the screen.

    Typer's own panels leave only a third of an 80-column terminal for the help texts.
    """

    def get_help(self, ctx: Any) -> str:
        """Return the help: of -h, with the names of the options alone where more does not fit."""
        text = super().get_help(ctx)
        lines = text.count("\n") + 2  # and the next prompt
        if ctx.meta.get(_SHORT) and lines > shutil.get_terminal_size().lines:
            ctx.meta[_NAMES] = True
            text = super().get_help(ctx)
        return text

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write the arguments, then the groups."""
        groups: dict[str, list[tuple[Any, tuple[str, str]]]] = {}
        for parameter in self.get_params(ctx):
            record = parameter.get_help_record(ctx)
            if record is not None:
                other = "Arguments" if parameter.param_type_name == "argument" else "Options"
                named = getattr(parameter, "rich_help_panel", None)
                group = named or GROUP_OF.get(parameter.name, other)
                groups.setdefault(group, []).append((parameter, record))
        ordered = [group for group in ("Arguments", *_GROUPS, "Options") if group in groups]
        if ctx.meta.get(_NAMES):
            with formatter.section(f"Options, explained by {ctx.command_path} --help"):
                for group in ordered[1:]:
                    names = " ".join(max(one.opts, key=len) for one, _ in groups[group])
                    formatter.write(_wrapped(f"{group}: {names}", formatter) + "\n")
            return
        for group in ordered:
            with formatter.section(group):
                formatter.write_dl([record for _, record in groups[group]])

    def collect_usage_pieces(self, ctx: Any) -> list[str]:
        """Return what the usage line shows; Typer has braces around what is required."""
        return [re.sub("[{}]", "", piece) for piece in super().collect_usage_pieces(ctx)]

    def parse_args(self, ctx: Any, args: list[str]) -> Any:
        """Parse the command line; usage errors carry the command's context."""
        ctx.meta[_SHORT] = "-h" in args and "--help" not in args
        with _known_to(ctx):
            return super().parse_args(ctx, args)

    def invoke(self, ctx: Any) -> Any:
        """Run the command; usage errors carry its context."""
        with _known_to(ctx):
            return super().invoke(ctx)


def _wrapped(text: str, formatter: Any) -> str:
    """Wrap at spaces alone: Click's own text breaks the names of options."""
    first = " " * formatter.current_indent
    return textwrap.fill(
        text,
        formatter.width,
        initial_indent=first,
        subsequent_indent=first + "    ",
        break_on_hyphens=False,
    )


@contextlib.contextmanager
def _known_to(ctx: Any) -> Iterator[None]:
    """Add the command's context to usage errors that lack one."""
    try:
        yield
    except _UsageError as error:
        error.ctx = error.ctx or ctx  # type: ignore[attr-defined]
        raise


class AllCommands(TyperGroup):
    """The group of all commands; usage errors are printed like all other errors."""

    def main(self, *args: Any, **extra: Any) -> Any:
        """Run a command line and exit with its exit code."""
        extra["standalone_mode"] = False
        words = sys.argv[1:]
        if words[:1] == ["help"]:  # as `git help`
            extra["args"] = [*words[1:2], "--help"]
        try:
            code = super().main(*args, **extra)
        except _UsageError as error:
            _print_usage_error(error)
            code = EXIT_USAGE
        sys.exit(code)


def with_verbosity(command: Command) -> Command:
    """Add the options of VERBOSITY to a command, whose docstring is its help."""
    added = [(name, bool, option, False) for name, option in _VERBOSITY]

    def run(arguments: dict[str, Any]) -> None:
        for name, _ in _VERBOSITY:
            setattr(VERBOSITY, name, arguments.pop(name))
        if VERBOSITY.quiet and VERBOSITY.verbose:
            raise typer.BadParameter("cannot be combined with --verbose", param_hint="--quiet")
        command(**arguments)

    complete = with_parameters(command, added, run)
    complete.__doc__ = _with_kept_lines(command.__doc__ or "")
    return complete


def with_parameters(
    command: Command,
    added: Sequence[tuple[str, Any, Any, Any]],
    run: Callable[[dict[str, Any]], None],
    replaced: Collection[str] = (),
) -> Command:
    """Return a command that passes its arguments to `run`, as a dict.

    Name, docstring and parameters of the `command` that `run` calls are kept, but for the
    parameters `replaced`, which `run` supplies instead. `added` are name, type, `typer.Option` and
    default of each additional one.
    """
    own = inspect.signature(command, eval_str=True).parameters.values()
    kind = inspect.Parameter.KEYWORD_ONLY
    parameters = [one.replace(kind=kind) for one in own if one.name not in replaced] + [
        inspect.Parameter(name, kind, default=default, annotation=Annotated[type_, option])
        if option is not None
        else inspect.Parameter(name, kind, annotation=type_)
        for name, type_, option, default in added
    ]

    def with_more(**arguments: Any) -> None:
        run(arguments)

    with_more.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    with_more.__annotations__ = {one.name: one.annotation for one in parameters}
    with_more.__doc__, with_more.__name__ = command.__doc__, command.__name__
    return with_more


def _with_kept_lines(text: str) -> str:
    """Mark the paragraphs with indented lines, so that Typer keeps their line breaks."""
    paragraphs = inspect.cleandoc(text).split("\n\n")
    return "\n\n".join(f"\b\n{one}" if "\n  " in f"\n{one}" else one for one in paragraphs)


def _print_usage_error(error: Any) -> None:
    if error.message.startswith("Usage:"):  # no command was given: print the whole help
        typer.echo(error.message, err=True)
        return
    print_error(_described(error))
    if error.ctx is not None:
        typer.echo(f"See: {error.ctx.command_path} --help", err=True)


def _name_used(names: list[str]) -> str:
    """Return the name of an option that the command line has; the longest of those it may have."""
    words = {word.partition("=")[0] for word in sys.argv[1:]}
    return max(words.intersection(names) or names, key=len)


def _described(error: Any) -> str:
    """Say what is wrong, starting with the name of the option or argument."""
    parameter = getattr(error, "param", None)
    name = getattr(error, "param_hint", None)
    if name is None and parameter is not None:
        is_option = parameter.param_type_name == "option"
        name = _name_used(parameter.opts) if is_option else parameter.metavar or parameter.name
    if type(error).__name__ == "MissingParameter":
        return f"{name} is missing"
    if type(error).__name__ == "NoSuchOption":
        similar = " or ".join(error.possibilities or [])
        hint = f": did you mean {similar}?" if similar else ""
        if instead := instead_of(error.option_name.lstrip("-").replace("-", "_")):
            options = r"\b(feature_size|overwrite|basis_size)\b"
            hint = ": " + re.sub(options, lambda name: flag(name[0]), instead)
        return f"there is no option {error.option_name}{hint}"
    if error.message.startswith("Got unexpected extra argument"):
        return f"{error.message[:1].lower()}{error.message[1:]}: for several files, use batch"
    # "Value error, 'x' is not one of ...", "Input should be an integer"
    text = re.sub(r"^(Value error, |Input )", "", error.message).rstrip(".")
    text = text.replace(". Did you mean", ": did you mean")
    return f"{text[:1].lower()}{text[1:]}" if name is None else f"{name}: {text}"
