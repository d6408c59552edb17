"""The command `meshlab-spectral`, also as `python -m meshlab_spectral.cli`."""

from meshlab_spectral.cli.interrupts import end_at_once, ignore_interrupts


def main() -> None:
    """Run the command line and exit with its exit code."""
    end_at_once()
    from meshlab_spectral.cli.app import app  # takes most of a second

    try:
        app(prog_name="meshlab-spectral")
    finally:
        ignore_interrupts()


if __name__ == "__main__":
    main()
