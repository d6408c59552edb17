"""The command `meshlab-spectral`, as `python -m meshlab_spectral`."""

from meshlab_spectral.cli.__main__ import main

if __name__ == "__main__":
    main()
