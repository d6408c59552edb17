"""The dialog of a filter: its parameters, Preview, Apply, and the call for pymeshlab."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from accessibility import Widget
from waiting import wait_for

if TYPE_CHECKING:
    from meshlab import MeshLab

_EDITORS = ("combo box", "text", "spin box", "check box")
_FAILURE = "Filter Failure"


@dataclass(frozen=True)
class Row:
    """A parameter as the dialog shows it.

    Attributes
    ----------
    label
        Text to the left.
    tooltip
        Help, which the label shows under the mouse and the button Help to the right.
    editors
        The entry fields: one, or for a percentage two, the length and the percentage.
    """

    label: str
    tooltip: str
    editors: tuple[Widget, ...]

    @property
    def showing(self) -> bool:
        return all(editor.showing for editor in self.editors)


class FilterDialog:
    """The dialog of a filter in a running MeshLab."""

    def __init__(self, meshlab: MeshLab, window: Widget) -> None:
        self._meshlab, self._desktop, self.window = meshlab, meshlab.desktop, window
        self.name = window.name

    def press(self, button: str) -> None:
        widget = self.window.find("push button", button)
        assert widget is not None, f"no button {button}"
        widget.press()

    def move(self, x: int, y: int) -> None:
        """Move the dialog's upper left corner."""
        # It covers the mesh at first; and a window at the edge of the screen stays within it.
        self._desktop.run(
            *(
                "xdotool",
                "search",
                "--sync",
                "--onlyvisible",
                "--name",
                f"^{re.escape(self.name)}$",
            ),
            *("windowmove", str(x), str(y)),
        )
        wait_for("the dialog to move", lambda: abs(self.window.box.x - x) < 20)

    def show_advanced(self) -> None:
        """Unfold the advanced parameters."""
        self.press("▼")
        wait_for("the advanced parameters", lambda: all(row.showing for row in self.rows()))

    def rows(self) -> list[Row]:
        """All parameters in their order, including those that are folded away."""
        rows: list[Row] = []
        editors: list[Widget] = []
        label = None
        for widget in self._parameter_frame().children():
            role = widget.role
            if role in _EDITORS:
                editors.append(widget)
            elif role == "label" and editors:
                if label is None:
                    label = widget.name
                else:
                    rows.append(Row(label, widget.name, tuple(editors)))
                    editors, label = [], None
        return rows

    def sliders(self) -> list[Widget]:
        """The sliders of the parameters that have one, in their order."""
        return self._parameter_frame().find_all("slider")

    def _parameter_frame(self) -> Widget:
        def has_editors(widget: Widget) -> bool:
            inner = [w for w in widget.children() if not w.has_name("Preview")]
            return any(w.has_role("filler") for w in inner) and any(
                w.has_role(*_EDITORS) for w in inner
            )

        return next(filter(has_editors, self.window.walk()))

    def set_value(self, row: Row, value: str) -> None:
        """Set a parameter as a user does; a percentage in percent."""
        editor = row.editors[-1]
        if editor.has_role("check box"):
            if editor.checked != (value == "true"):
                editor.press()
            wait_for(f"{row.label} {value}", lambda: editor.checked == (value == "true"))
        elif editor.has_role("combo box"):
            self._choose(editor, value)
        else:
            self.type_value(row, value)
            self._desktop.press_keys("Tab")

    def type_value(self, row: Row, value: str) -> None:
        """Type into a parameter's field without leaving it: the dialog does not know it yet."""
        editor = row.editors[-1]
        wait_for(f"{row.label} to have the keys", lambda: self.focus(editor))
        self._desktop.enter(editor, value)

    def focus(self, editor: Widget) -> bool:
        """Try to give an entry field the keyboard focus, which its window may not have at once."""
        # On the help: nothing happens there, whereas two clicks on the title dock the dialog.
        text = self.window.find("label")
        assert text is not None
        self._desktop.click(text.box)
        editor.focus()
        return editor.focused

    def _choose(self, box: Widget, value: str) -> None:
        entries = [entry.name for entry in box.find_all("list item")]
        popup = box.find("list")
        assert popup is not None
        box.press()
        wait_for("the list to open", lambda: popup.box.height > 0)
        self._desktop.press_keys("Home", *["Down"] * entries.index(value), "Return")
        wait_for(f"{value!r} to be chosen", lambda: box.name == value and popup.box.height == 0)

    def start_from(self, preset: str) -> None:
        """Choose a preset, which fills the fields."""
        boxes = self.window.find_all("combo box")
        names = {box: [item.name for item in box.find_all("list item")] for box in boxes}
        (box,) = (box for box in boxes if "defaults" in names[box])
        self._choose(box, next(name for name in names[box] if name.split(":")[0] == preset))

    def preview(self, wanted: bool) -> None:
        """Switch the preview on or off; when on, wait until the filter has run for it."""
        box = self.window.find("check box", "Preview")
        assert box is not None
        assert box.checked != wanted
        before = len(self._meshlab.log())
        box.press()
        wait_for("Preview to be switched", lambda: box.checked == wanted)
        if wanted:
            self.wait_for_result(before)

    def apply(self) -> str:
        """Apply the filter, wait until it is done, and return what it has logged."""
        before = len(self._meshlab.log())
        self.press("Apply")
        return self.wait_for_result(before)

    def wait_for_result(self, before: int) -> str:
        """Wait until the filter has run; return the log after its first `before` characters."""
        done = f"Applied filter: {self.name} in"

        def ended() -> bool:
            failed = self._meshlab.has_message(_FAILURE)
            assert not failed, self._meshlab.message(_FAILURE)
            return done in self._meshlab.log()[before:]

        wait_for("the filter to be applied", ended)
        return self._meshlab.log()[before:]

    def fail(self) -> str:
        """Apply the filter, which must refuse; close its message and return the text."""
        self.press("Apply")
        return self._meshlab.message(_FAILURE)

    def pymeshlab_call(self) -> str:
        """Copy the call for pymeshlab, and return it."""
        self.press("Copy PyMeshLab call to clipboard")
        return wait_for("the call in the clipboard", self._desktop.clipboard)

    def close(self) -> None:
        self.press("Close")
        wait_for("the dialog to close", lambda: not self.window.there or not self.window.showing)
