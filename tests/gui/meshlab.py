"""MeshLab as a user sees it: its windows, its menus, its log, the saving of a mesh."""

from __future__ import annotations

from pathlib import Path

from accessibility import Widget
from desktop import Desktop
from filter_dialog import FilterDialog
from session import Session
from waiting import wait_for

# Without the questions and the check for updates of a first start.
_SETTINGS = """[General]
informativeShown=true
lastTimeMeshLabVersionCheckedOnStart=Fri Jan 1 2100
"""
_MAIN_WINDOW = "MeshLab 2025.07"
_PLUGIN_ERROR = "Error while loading plugins."


class MeshLab:
    """A running MeshLab, with its main window or with the window that reports a bad plugin.

    Parameters
    ----------
    desktop
        The screen on which it appears.
    home
        Folder of its user, below the desktop's scratch folder: with the plugins that were installed
        there, and the mesh.
    mesh
        File, below `home`, that it opens at its start.
    environment
        Variables that it starts with.
    """

    def __init__(self, desktop: Desktop, home: Path, mesh: Path, **environment: str) -> None:
        self.desktop, self.home = desktop, home
        settings = home / ".config/VCG/MeshLab_64bit_fp.conf"
        settings.parent.mkdir(parents=True)
        settings.write_text(_SETTINGS)
        self._log = home / "meshlab.log"
        self._session = Session(desktop, home)
        self._process = self._session.start(
            "meshlab",
            desktop.inside(mesh),
            output=self._log,
            QT_QPA_PLATFORM="xcb",
            QT_LINUX_ACCESSIBILITY_ALWAYS_ON="1",
            # Freed memory returns to the system, so that leaks can be measured.
            MALLOC_MMAP_THRESHOLD_="131072",
            **environment,
        )
        wait_for("MeshLab's window", self._shows_itself)
        bus = self._session.listen()
        self._program: Widget = wait_for(
            "MeshLab's widgets", lambda: bus.program(self._process.pid)
        )

    @property
    def pid(self) -> int:
        return self._process.pid

    def close(self) -> None:
        self._session.close()

    def wait_for_end(self) -> int:
        """Wait until it has ended by itself; return its exit code."""
        wait_for("MeshLab to end", lambda: self._process.poll() is not None)
        return self._process.wait()

    def _shows_itself(self) -> bool:
        self._check_alive()
        return "All files opened" in self.log() or self.desktop.has_window(_PLUGIN_ERROR)

    def _check_alive(self) -> None:
        assert self._process.poll() is None, f"MeshLab has ended:\n{self.log()}"

    def log(self) -> str:
        """What MeshLab has logged so far."""
        return self._log.read_text(errors="replace")

    def plugin_error(self) -> str | None:
        """The text of the window that reports plugins that cannot be loaded; None without one."""
        if not self.desktop.has_window(_PLUGIN_ERROR):
            return None
        return wait_for("the words in this window", lambda: _words(self.window(_PLUGIN_ERROR)))

    def main_window(self) -> Widget:
        def find() -> Widget | None:
            self._check_alive()
            error = self.plugin_error()
            assert error is None, error
            windows = self._program.children()
            return next((w for w in windows if w.name.startswith(_MAIN_WINDOW)), None)

        return wait_for("the main window", find)

    def layers(self) -> list[str]:
        """The names of the layers, as the list beside the scene shows them."""
        columns = [w.name for w in self.main_window().find_all("tree item")]
        # Whether it is shown, number, name (with a star if it was changed), what is shown of it.
        return [name.removesuffix(" *") for name in columns[2::4]]

    def menu_entry(self, *path: str) -> Widget | None:
        """Return an entry of the menus: menu_entry("File", "Exit"); None if there is none."""
        entry = next((w for w in self.main_window().children() if w.has_role("menu bar")), None)
        for depth, name in enumerate(path):
            if depth > 0 and entry is not None:
                entry = next((w for w in entry.children() if w.has_role("popup menu")), None)
            if entry is None:
                return None
            entry = entry.child(name)
        return entry

    def choose(self, *path: str) -> None:
        """Choose an entry of the menus."""
        entry = self.menu_entry(*path)
        assert entry is not None, f"no menu entry {' > '.join(path)}"
        entry.press()

    def window(self, title: str) -> Widget:
        """Wait for a window."""

        def find() -> Widget | None:
            self._check_alive()
            # A closed one may still exist, hidden, next to its successor.
            windows = self._program.children()
            return next((w for w in windows if w.has_name(title) and w.showing), None)

        return wait_for(f"the window {title!r}", find)

    def open_filter(self, *path: str) -> FilterDialog:
        """Choose a filter from the menus, and return its dialog."""
        self.choose("Filters", *path)
        return FilterDialog(self, self.window(path[-1]))

    def message(self, title: str) -> str:
        """Wait for a message, read it, and close it."""
        window = self.window(title)
        words = _words(window)
        self._confirm(window, "OK")
        return words

    def answer(self, title: str, button: str) -> None:
        """Wait for a question, and answer it."""
        self._confirm(self.window(title), button)

    def has_message(self, title: str) -> bool:
        return self._program.child(title) is not None

    def save_mesh(self, path: Path) -> None:
        """Save the current mesh: File > Export Mesh As..., with the options that are offered."""
        self.choose("File", "Export Mesh As...")
        self._name_file(self._dialog("Save "), path)
        self._confirm(self._dialog("Choose Saving Options"), "OK")
        wait_for(
            f"{path.name} to be saved",
            lambda: f"Saved Mesh {self.desktop.inside(path)}" in self.log(),
        )

    def save_script(self, path: Path) -> None:
        """Save what was applied as a filter script: Filters > Show current filter script."""
        self.choose("Filters", "Show current filter script")
        script = self._dialog("")
        button = script.find("push button", "Save Script")
        assert button is not None
        button.press()
        self._name_file(self._dialog("Save Filter Script File"), path)
        wait_for(f"{path.name} to be saved", path.is_file)
        self._confirm(script, "Close")

    def apply_script(self, path: Path | None = None) -> None:
        """Apply the current filter script, or one from a file, which becomes the current one."""
        self.choose("Filters", "Show current filter script")
        script = self._dialog("")
        if path is not None:
            button = script.find("push button", "Open Script")
            assert button is not None
            button.press()
            self._name_file(self._dialog("Open Filter Script File"), path)
        entries = len(script.find_all("list item"))
        assert entries > 0, "the script is empty"
        before = len(self.log())
        self._confirm(script, "Apply Script")
        wait_for(
            f"{entries} filters of the script to be applied",
            lambda: self.log()[before:].count("Re-Applied filter ") == entries,
        )

    def _dialog(self, title: str) -> Widget:
        """Wait for a modal dialog whose title begins with `title`: the last one that was opened."""

        def find() -> Widget | None:
            self._check_alive()
            dialogs = [w for w in self._program.children() if w.has_role("dialog") and w.showing]
            return dialogs[-1] if dialogs and dialogs[-1].name.startswith(title) else None

        return wait_for(f"the dialog {title!r}", find)

    def _name_file(self, dialog: Widget, path: Path) -> None:
        field = dialog.find("text", "File name:")
        assert field is not None
        self.desktop.enter(field, self.desktop.inside(path))
        self.desktop.press_keys("Return")
        wait_for("the file's dialog to close", lambda: not dialog.there or not dialog.showing)

    def _confirm(self, window: Widget, button_name: str) -> None:
        button = window.find("push button", button_name)
        assert button is not None, f"no button {button_name} in {window}"
        button.press()
        wait_for(f"{window} to close", lambda: not window.there or not window.showing)


def _words(window: Widget) -> str:
    return "\n".join(label.name for label in window.find_all("label"))
