"""The command `meshlab-spectral`, also as `python -m meshlab_spectral.cli`."""

import io
import os
import sys

from meshlab_spectral.cli.interrupts import end_at_once, ignore_interrupts

# Commands that have a child process read one file.
_OF_ONE_FILE = ("info", "denoise", "filter", "spectrum", "basis", "compare", "texture")


def buffer_output() -> None:
    """Buffer standard output where it is not: Python ignores how much a full disk has taken."""
    out = sys.stdout
    if not isinstance(out, io.TextIOWrapper):
        return
    raw: object = out.buffer
    if isinstance(raw, io.RawIOBase):
        encoding, errors = out.encoding, out.errors
        out.detach()
        buffered = io.BufferedWriter(raw)
        sys.stdout = io.TextIOWrapper(buffered, encoding, errors, line_buffering=True)


def main() -> None:
    """Run the command line and exit with its exit code."""
    end_at_once()
    buffer_output()
    os.environ["MESHLAB_SPECTRAL_SHELL"] = "1"  # `SHELL` of filters/running.py, a slow import
    from meshlab_spectral.workers.process import end_unused, start_ahead

    if sys.argv[1:2] and sys.argv[1] in _OF_ONE_FILE and not {"-h", "--help"} & set(sys.argv):
        start_ahead()
    from meshlab_spectral.cli.app import app  # takes a fifth of a second
    from meshlab_spectral.files.whole_files import is_disk_full

    try:
        try:
            app(prog_name="meshlab-spectral")
        finally:
            if sys.stdout is not None:
                sys.stdout.flush()
    except OSError as error:
        if not is_disk_full(error) or error.filename is not None:
            raise
        # Python would flush what is left once more, at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(f"Error: standard output cannot be written ({error.strerror})")
    finally:
        ignore_interrupts()
        end_unused()


if __name__ == "__main__":
    main()
