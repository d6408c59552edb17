"""The command `meshlab-spectral`: `app` combines its subcommands, each in its own module."""
