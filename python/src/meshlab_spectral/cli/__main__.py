"""The command `meshlab-spectral`, also as `python -m meshlab_spectral.cli`."""

import sys

from meshlab_spectral.cli.interrupts import end_at_once, ignore_interrupts

# Commands that have a child process read one file.
_OF_ONE_FILE = ("info", "denoise", "filter", "spectrum", "basis")


def main() -> None:
    """Run the command line and exit with its exit code."""
    end_at_once()
    from meshlab_spectral.process.ahead import end_unused, start_ahead

    if sys.argv[1:2] and sys.argv[1] in _OF_ONE_FILE and not {"-h", "--help"} & set(sys.argv):
        start_ahead()
    from meshlab_spectral.cli.app import app  # takes a fifth of a second

    try:
        app(prog_name="meshlab-spectral")
    finally:
        ignore_interrupts()
        end_unused()


if __name__ == "__main__":
    main()
