"""A small window to drag a file from, as a file manager's: drag.py FILE X Y SIZE."""

import sys
from pathlib import Path

import gi


def main(path: Path, x: int, y: int, size: int) -> None:
    """Show the window until the file has been dragged somewhere."""
    gi.require_version("Gdk", "3.0")
    gi.require_version("Gtk", "3.0")
    from gi.repository import Gdk, Gtk

    window = Gtk.Window(type=Gtk.WindowType.POPUP)
    window.move(x, y)
    window.resize(size, size)
    window.drag_source_set(Gdk.ModifierType.BUTTON1_MASK, [], Gdk.DragAction.COPY)
    window.drag_source_add_uri_targets()
    window.connect("drag-data-get", lambda widget, context, data, info, time: data.set_uris([path.as_uri()]))
    window.connect("drag-end", lambda widget, context: Gtk.main_quit())
    window.show_all()
    Gtk.main()


main(Path(sys.argv[1]), *map(int, sys.argv[2:]))
