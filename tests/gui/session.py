"""A user's session on the desktop: a home, and the buses on which programs expose widgets."""

from __future__ import annotations

import subprocess
from pathlib import Path

from accessibility import Bus
from desktop import Desktop
from waiting import wait_for


class Session:
    """The session of a user at the desktop: its bus, and the programs in it.

    Parameters
    ----------
    desktop
        The screen on which the session's programs appear.
    home
        The user's folder, below the desktop's scratch folder.
    """

    def __init__(self, desktop: Desktop, home: Path) -> None:
        self.desktop, self.home = desktop, home
        self._run = home / ".run"
        self._run.mkdir(parents=True, mode=0o700)
        self._socket = self._run / "session-bus"
        self._programs: list[subprocess.Popen[bytes]] = []
        self._accessibility: Bus | None = None
        bus = self.start("dbus-daemon", "--session", "--nofork", f"--address={self._address}")
        desktop.wait_for_socket(bus, self._socket)

    @property
    def _address(self) -> str:
        return f"unix:path={self.desktop.inside(self._socket)}"

    def start(
        self, *command: str, output: Path | None = None, **environment: str
    ) -> subprocess.Popen[bytes]:
        """Start a program in this session."""
        program = self.desktop.start(
            *command,
            output=output,
            HOME=self.desktop.inside(self.home),
            XDG_RUNTIME_DIR=self.desktop.inside(self._run),
            DBUS_SESSION_BUS_ADDRESS=self._address,
            **environment,
        )
        self._programs.append(program)
        return program

    def listen(self) -> Bus:
        """Start the bus on which programs expose their widgets, and listen to it.

        Call this only when the program shows its first window: Qt 5 often stays silent if the bus
        exists before it handles events.
        """
        # Without a DISPLAY: it would publish its address there, where Qt would find it too early.
        self.start("/usr/libexec/at-spi-bus-launcher", "--launch-immediately", DISPLAY="")
        session = Bus(self._socket)
        address = wait_for("the accessibility bus", session.address_of_accessibility)
        session.close()
        self._accessibility = Bus(self.desktop.root / Path(address).relative_to("/"))
        return self._accessibility

    def close(self) -> None:
        if self._accessibility is not None:
            self._accessibility.close()
        for program in reversed(self._programs):
            self.desktop.stop(program)
