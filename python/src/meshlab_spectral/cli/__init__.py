"""The command `meshlab-spectral`: `app` puts the commands together, each in a module of its own."""
