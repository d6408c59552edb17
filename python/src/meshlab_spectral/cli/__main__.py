"""`python -m meshlab_spectral.cli` is the command `meshlab-spectral`."""

from meshlab_spectral.cli.app import main

if __name__ == "__main__":
    main()
