"""A virtual screen, in a Debian system of its own, with a keyboard and a mouse."""

from __future__ import annotations

import os
import re
import subprocess
import time
from pathlib import Path

import numpy as np
from accessibility import Box, Widget
from numpy.typing import NDArray
from PIL import Image
from waiting import wait_for

# One screen for each process of the tests.
_DISPLAY = 7 + int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
_SCREEN = "1600x1000x24"
_ENVIRONMENT = {
    "PATH": "/usr/sbin:/usr/bin:/sbin:/bin",
    "LC_ALL": "C.UTF-8",
    "DISPLAY": f":{_DISPLAY}",
    "HOME": "/tmp",
    # Software rendering: the same picture on every machine.
    "LIBGL_ALWAYS_SOFTWARE": "1",
    "GALLIUM_DRIVER": "llvmpipe",
}

_SETTLED = 0.3  # seconds without a change

Picture = NDArray[np.uint8]


class Desktop:
    """A running screen, and the programs on it.

    Parameters
    ----------
    root
        Folder of the Debian system, with a writable folder tmp.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self._programs: list[subprocess.Popen[bytes]] = []
        try:
            self._memory.mkdir()
            options = ("-screen", "0", _SCREEN, "-nocursor", "-fbdir", self.inside(self._memory))
            screen = self.start("Xvfb", f":{_DISPLAY}", *options)
            self.wait_for_socket(screen, self.scratch / f".X11-unix/X{_DISPLAY}")
            self.start("openbox")
        except BaseException:
            self.close()
            raise

    @property
    def scratch(self) -> Path:
        """The folder /tmp of the Debian system."""
        return self.root / "tmp"

    @property
    def _memory(self) -> Path:
        """The folder of the file that is the screen's memory."""
        return self.scratch / f"screen{_DISPLAY}"

    def inside(self, path: Path) -> str:
        """Return the path of a file as programs inside the Debian system see it."""
        return f"/{path.relative_to(self.root)}"

    def start(
        self, *command: str, output: Path | None = None, **environment: str
    ) -> subprocess.Popen[bytes]:
        """Start a program, and leave it running."""
        with (output or Path("/dev/null")).open("wb") as sink:
            program = subprocess.Popen(
                self._chrooted(command),
                env={**_ENVIRONMENT, **environment},
                stdin=subprocess.DEVNULL,
                stdout=sink,
                stderr=subprocess.STDOUT,
            )
        self._programs.append(program)
        return program

    def run(self, *command: str) -> bytes:
        """Run a program, which must succeed; return what it printed."""
        done = self._run(*command)
        assert done.returncode == 0, f"{' '.join(command)}: {done.stderr.decode()}"
        return done.stdout

    def _run(self, *command: str) -> subprocess.CompletedProcess[bytes]:
        return subprocess.run(
            self._chrooted(command), env=_ENVIRONMENT, capture_output=True, check=False
        )

    def _chrooted(self, command: tuple[str, ...]) -> list[str]:
        return ["chroot", str(self.root), *command]

    def wait_for_socket(self, program: subprocess.Popen[bytes], socket: Path) -> None:
        """Wait until a program that was started listens on a socket."""

        def listens() -> bool:
            assert program.poll() is None, f"{program.args} has ended"
            return socket.exists()

        wait_for(f"{socket}", listens)

    def stop(self, program: subprocess.Popen[bytes]) -> None:
        """End a program that `start` has started."""
        program.terminate()
        try:
            program.wait(10)
        except subprocess.TimeoutExpired:
            program.kill()
            program.wait()
        self._programs.remove(program)

    def close(self) -> None:
        for program in reversed(self._programs[:]):
            self.stop(program)

    def picture(self, box: Box | None = None) -> Picture:
        """Take a picture of the screen, or of a part of it: rows x columns x RGB."""
        # An XWD file that is the screen's memory: reading it takes no time from MeshLab.
        dump = np.fromfile(self._memory / "Xvfb_screen0", np.uint8)
        header = dump[:100].view(">u4")
        width, height, row_bytes, colors = (int(header[i]) for i in (4, 5, 12, 19))
        pixels = dump[int(header[0]) + 12 * colors :][: height * row_bytes]
        blue_first = pixels.reshape(height, row_bytes)[:, : 4 * width].reshape(height, width, 4)
        picture = blue_first[:, :, 2::-1]
        if box is not None:
            picture = picture[box.y : box.y + box.height, box.x : box.x + box.width]
        return picture.copy()

    def settled_picture(self, box: Box) -> Picture:
        """Take a picture of a part of the screen once it has stopped changing for a while."""
        pictures = [self.picture(box)]

        def unchanged() -> bool:
            time.sleep(_SETTLED)
            pictures.append(self.picture(box))
            return np.array_equal(*pictures[-2:])

        wait_for("the picture to settle", unchanged)
        return pictures[-1]

    def point_at(self, box: Box) -> None:
        """Move the mouse into the middle of a rectangle, the last pixels as a movement inside."""
        x, y = box.center
        self.run("xdotool", "mousemove", str(x - 4), str(y), "mousemove", str(x), str(y))

    def click(self, box: Box) -> None:
        """Click into the middle of a rectangle."""
        x, y = box.center
        self.run("xdotool", "mousemove", str(x), str(y), "click", "1")

    def type(self, text: str) -> None:
        self.run("xdotool", "type", "--delay", "5", "--", text)

    def press_keys(self, *keys: str) -> None:
        """Press keys one after the other, named as xdotool does: "Return", "ctrl+a"."""
        self.run("xdotool", "key", "--delay", "20", *keys)

    def enter(self, field: Widget, text: str) -> None:
        """Replace the text of an entry field, which must have the keyboard focus."""
        wait_for(f"{field} to have the keys", lambda: field.focused)
        self.press_keys("ctrl+a")
        self.type(text)
        wait_for(f"{text!r} in the field of entry", lambda: field.text == text)

    def has_window(self, title: str) -> bool:
        """Whether there is a window with this title."""
        pattern = f"^{re.escape(title)}$"
        return self._run("xdotool", "search", "--onlyvisible", "--name", pattern).returncode == 0

    def clipboard(self) -> str:
        """The text copied last; empty if there is none."""
        return self._run(
            *("xclip", "-selection", "clipboard", "-target", "UTF8_STRING", "-out")
        ).stdout.decode()


def save_picture(picture: Picture, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(picture).save(path)
