"""A Qt program's widgets as its accessibility interface reports them: roles, names, values.

Talks directly to the program, over a private bus. AT-SPI's registry is left out: Qt 5 does not
always succeed in registering with it, but answers all the same.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from jeepney import DBusAddress, DBusErrorResponse, MessageFlag, new_method_call
from jeepney.io.blocking import DBusConnection, open_dbus_connection
from jeepney.wrappers import unwrap_msg

_INTERFACE = "org.a11y.atspi."
_ROOT = "/org/a11y/atspi/accessible/root"
_NOWHERE = "/org/a11y/atspi/null"
# A program that computes on its GUI thread answers late.
_ANSWER_SECONDS = 120.0

# Numbers of AT-SPI's states.
_CHECKED, _ENABLED, _FOCUSED, _SHOWING = 4, 8, 12, 25


class Box(NamedTuple):
    """A rectangle of the screen, in pixels."""

    x: int
    y: int
    width: int
    height: int

    @property
    def center(self) -> tuple[int, int]:
        return self.x + self.width // 2, self.y + self.height // 2


class Bus:
    """The bus on which a program exposes its widgets.

    Parameters
    ----------
    socket
        The socket of the bus's daemon.
    """

    def __init__(self, socket: Path) -> None:
        self._connection: DBusConnection = open_dbus_connection(bus=f"unix:path={socket}")
        self._daemon = DBusAddress(
            "/org/freedesktop/DBus", "org.freedesktop.DBus", "org.freedesktop.DBus"
        )

    def close(self) -> None:
        self._connection.close()

    def address_of_accessibility(self) -> str | None:
        """Ask a session's bus where the accessibility bus is: its socket; None if not known yet."""
        service = DBusAddress("/org/a11y/bus", "org.a11y.Bus", "org.a11y.Bus")
        try:
            (address,) = self._call(service, "GetAddress")
        except DBusErrorResponse:
            return None
        return str(address).removeprefix("unix:path=").partition(",")[0] or None

    def program(self, pid: int) -> Widget | None:
        """Return the root of a process's widgets; None while it is not on the bus."""
        for name in self._call(self._daemon, "ListNames")[0]:
            if not name.startswith(":") or name == self._connection.unique_name:
                continue
            try:
                (owner,) = self._call(self._daemon, "GetConnectionUnixProcessID", "s", (name,))
            except DBusErrorResponse:
                continue  # gone since the list was made
            if owner == pid:
                return Widget(self, name, _ROOT)
        return None

    def _call(
        self, address: DBusAddress, method: str, signature: str | None = None, body: Any = ()
    ) -> Any:
        message = new_method_call(address, method, signature, body)
        return unwrap_msg(self._connection.send_and_get_reply(message, timeout=_ANSWER_SECONDS))

    def call(
        self, name: str, path: str, interface: str, method: str, signature: str | None, body: Any
    ) -> Any:
        """Call a method of an object, and return what it answers."""
        return self._call(DBusAddress(path, name, _INTERFACE + interface), method, signature, body)

    def send(
        self, name: str, path: str, interface: str, method: str, signature: str, body: Any
    ) -> None:
        """Call a method without waiting for its answer, which may need other calls first."""
        address = DBusAddress(path, name, _INTERFACE + interface)
        message = new_method_call(address, method, signature, body)
        message.header.flags |= MessageFlag.no_reply_expected
        self._connection.send(message)

    def property(self, name: str, path: str, interface: str, which: str) -> Any:
        address = DBusAddress(path, name, "org.freedesktop.DBus.Properties")
        (variant,) = self._call(address, "Get", "ss", (_INTERFACE + interface, which))
        return variant[1]


class Widget:
    """A window, a button, a label, ... Two objects may stand for the same one: compare with ==."""

    def __init__(self, bus: Bus, program: str, path: str) -> None:
        self._bus, self._program, self._path = bus, program, path

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Widget) and (self._program, self._path) == (
            other._program,
            other._path,
        )

    def __hash__(self) -> int:
        return hash((self._program, self._path))

    def __repr__(self) -> str:
        try:
            return f"<{self.role} {self.name!r}>"
        except DBusErrorResponse:
            return "<widget that is gone>"

    @property
    def role(self) -> str:
        """Kind of widget, in the words of AT-SPI: "menu item", "check box", ..."""
        return str(self._call("Accessible", "GetRoleName"))

    @property
    def name(self) -> str:
        """Text on a button or label; title of a window."""
        return str(self._bus.property(self._program, self._path, "Accessible", "Name"))

    @property
    def text(self) -> str:
        """Text in an entry field."""
        return str(self._call("Text", "GetText", "ii", (0, -1)))

    @property
    def value(self) -> float:
        """Number that a bar or a slider shows."""
        return float(self._bus.property(self._program, self._path, "Value", "CurrentValue"))

    @property
    def box(self) -> Box:
        """Place on the screen."""
        return Box(*self._call("Component", "GetExtents", "u", (0,)))

    @property
    def checked(self) -> bool:
        return self._has(_CHECKED)

    @property
    def enabled(self) -> bool:
        return self._has(_ENABLED)

    @property
    def focused(self) -> bool:
        return self._has(_FOCUSED)

    @property
    def showing(self) -> bool:
        return self._has(_SHOWING)

    @property
    def there(self) -> bool:
        """Whether the program still has this widget."""
        try:
            return bool(self.role)
        except DBusErrorResponse:
            return False

    def press(self) -> None:
        """Press a button or box, or choose a menu entry. Does not wait for the effect."""
        self._bus.send(self._program, self._path, "Action", "DoAction", "i", (0,))

    def focus(self) -> None:
        """Give this widget the keyboard focus within its window."""
        self._call("Component", "GrabFocus")

    def children(self) -> list[Widget]:
        """The child widgets, in order; none if this widget is gone."""
        try:
            answer = self._call("Accessible", "GetChildren")
        except DBusErrorResponse:
            return []
        return [Widget(self._bus, name, path) for name, path in answer if path != _NOWHERE]

    def child(self, name: str) -> Widget | None:
        """The child of this name."""
        return next((child for child in self.children() if child.has_name(name)), None)

    def walk(self, without: tuple[str, ...] = ("menu bar",)) -> Iterator[Widget]:
        """All descendants, outer ones first; none below those of the roles `without`."""
        for child in self.children():
            yield child
            if not child.has_role(*without):
                yield from child.walk(without)

    def find(self, role: str, name: str | None = None) -> Widget | None:
        """The first descendant of a role and, if given, a name."""
        return next(
            (
                widget
                for widget in self.walk()
                if widget.has_role(role) and (name is None or widget.has_name(name))
            ),
            None,
        )

    def find_all(self, role: str) -> list[Widget]:
        return [widget for widget in self.walk() if widget.has_role(role)]

    def has_role(self, *roles: str) -> bool:
        """Whether this widget still exists and has one of the roles."""
        try:
            return self.role in roles
        except DBusErrorResponse:
            return False

    def has_name(self, name: str) -> bool:
        """Whether this widget still exists and has this name."""
        try:
            return self.name == name
        except DBusErrorResponse:
            return False

    def _has(self, state: int) -> bool:
        """Whether this widget has a state; a widget that is gone has none."""
        try:
            low, high = self._call("Accessible", "GetState")
        except DBusErrorResponse:
            return False
        return bool((low | high << 32) >> state & 1)

    def _call(
        self, interface: str, method: str, signature: str | None = None, body: Any = ()
    ) -> Any:
        answer = self._bus.call(self._program, self._path, interface, method, signature, body)
        return answer[0] if len(answer) == 1 else answer
