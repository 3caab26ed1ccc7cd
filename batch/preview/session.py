"""What happens in a preview, whatever window shows it. Lives on the GL thread."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from operator import attrgetter
from pathlib import Path
from time import perf_counter

import numpy as np

from ...addon.errors import Cancelled, CatoptricError
from ...addon.methods.registry import METHODS
from ...addon.parameters import Value
from ...addon.progress import Progress
from ...addon.scene import Lighting, Scene
from ..pictures import save_bytes
from .darkroom import film, photograph
from .hits import Looker, Sight
from .keys import ACTIONS, DIGITS
from .look import Look
from .path import EXTENSION as PATH
from .path import CameraPath
from .pilot import Pilot
from .prepared import Choice
from .video import EXTENSION as FILM
from .views import names
from .workshop import Subject, Workshop

_PATIENCE = 0.25  # seconds without a change of a value, before the method is prepared again
_EXPOSURES = 20.0
_NO_PATH = "there is no path yet: press R, fly, press R again"


class Session:
    """A scene, the look that is wanted, and the newest picture of it.

    A window hands on keys and the mouse, calls `pilot.advance` and `work` again and again, and shows
    `workshop.painter.shown`. `work` does one thing at a time; while that takes, it calls `workshop.pump`, in
    which the window may hand on more.
    """

    def __init__(
        self,
        scene: Scene,
        look: Look,
        settings: Mapping[str, Mapping[str, Value]],
        stem: Path,
        path: CameraPath | None = None,
        rate: int = 30,
    ) -> None:
        """`settings` holds all values of each method; files are written as `stem` with a number and an ending."""
        self.title, self.look, self.size = stem.name, look, (1, 1)
        self.pilot, self.workshop = Pilot(scene, path), Workshop(scene)
        self.lightings = _lightings(scene)
        self.message = "F1 shows the keys"
        self.panel, self.help = True, False
        self.sight: Sight | None = None
        self._looker = Looker(scene)
        self._settings = {name: dict(values) for name, values in settings.items()}
        self._stem, self._rate = stem, rate
        self._given_up = False
        self._patient_until = 0.0
        self._asked: list[Callable[[], str]] = []

    # What a person does

    def press(self, key: str, control: bool = False) -> None:
        """A key, by its name in `keys`, goes down."""
        self.pilot.held.add(key)
        if key in DIGITS:
            self.choose(DIGITS.index(key), right=control)
        elif key in ("-", "="):
            self.expose(self.look.exposure + (0.5 if key == "=" else -0.5))
        elif key in ACTIONS:
            self._try(attrgetter(ACTIONS[key])(self))

    def release(self, key: str) -> None:
        """A key goes up."""
        self.pilot.held.discard(key)

    def choose(self, number: int, right: bool = False) -> None:
        """Show the method of that number, from 0, in the left or the right half."""
        if number >= len(METHODS):
            self.message = f"there are {len(METHODS)} methods"
        else:
            self._want(right, self._choice(tuple(METHODS)[number]))

    def set(self, right: bool, values: Mapping[str, Value]) -> None:
        """Give the method on that side these values of its parameters; it is prepared again once they rest."""
        old = self.look.right if right else self.look.left
        self._want(right, Choice.of(old.method, {**dict(old.settings), **values}, old.lighting))
        self._patient_until = perf_counter() + _PATIENCE

    def light(self, lighting: Lighting) -> None:
        """Show all methods under that light."""
        for right, choice in enumerate(self.look.choices):
            self._want(bool(right), replace(choice, lighting=lighting))

    def _choice(self, method: str) -> Choice:
        return Choice.of(method, self._settings[method], self.look.lighting)

    def _want(self, right: bool, choice: Choice | None) -> None:
        self.look = replace(self.look, **{"right" if right else "left": choice})
        self._given_up = False

    def expose(self, stops: float) -> None:
        """Show the picture brighter or darker."""
        self.look = replace(self.look, exposure=float(np.clip(stops, -_EXPOSURES, _EXPOSURES)))

    def view(self, name: str) -> None:
        """Show radiance by that view transform."""
        self.look = replace(self.look, view=name)

    def next_view(self) -> None:
        """The view transform after this one."""
        known = names()
        self.view(known[(known.index(self.look.view) + 1) % len(known)])
        self.message = f"view transform {self.look.view}"

    def divide(self, split: float) -> None:
        """Move the line of the split view, 0..1 of the width."""
        self.look = replace(self.look, split=float(np.clip(split, 0.02, 0.98)))

    def next_lighting(self) -> None:
        """The light after this one."""
        at = self.lightings.index(self.look.lighting)
        self.light(self.lightings[(at + 1) % len(self.lightings)])

    def toggle_split(self) -> None:
        """Two methods side by side, or one."""
        first, *_, last = METHODS
        other = first if self.look.left.method != first else last
        self._want(True, None if self.look.right else self._choice(other))

    def swap(self) -> None:
        """Exchange the halves."""
        if self.look.right:
            self.look = replace(self.look, left=self.look.right, right=self.look.left)

    def toggle_panel(self) -> None:
        """Show or hide the panel."""
        self.panel = not self.panel

    def toggle_help(self) -> None:
        """Show or hide the keys."""
        self.help = not self.help

    def toggle_recording(self) -> None:
        """Begin to record, or stop and save the path."""
        if self.pilot.recorder is None:
            self.pilot.record()
            self.message = "recording; R stops"
            return
        path = self.pilot.end_recording()
        target = self._free(PATH)
        path.save(target)
        self.message = f"saved {target}: {path.duration:.1f} s; Space plays it, X makes a film of it"

    def ask_picture(self) -> None:
        """Save a picture, as soon as `work` comes to it."""
        self._asked.append(lambda: self.workshop.run("Saving a picture", self._save_picture))

    def ask_film(self) -> None:
        """Export the path as a film, as soon as `work` comes to it."""
        if self.pilot.path is None:
            self.message = _NO_PATH
        else:
            self._asked.append(lambda: self.workshop.run("Exporting a film", self._save_film))

    def toggle_replay(self) -> None:
        """Play the path, or stop."""
        if self.pilot.path is None:
            self.message = _NO_PATH
        else:
            self.pilot.toggle_replay()

    def stop(self) -> None:
        """Stop what takes long, or a replay."""
        self.workshop.stop()
        self.pilot.played = None

    def see(self, place: tuple[float, float] | None) -> None:
        """Find out what lies under the cursor at `place`, 0..1 from the upper left corner; None: nothing."""
        at = place and (place[0] * self.size[0], place[1] * self.size[1])
        self.sight = self._looker.look(self.pilot.camera, self.size, at) if at else None

    def take(self, scene: Scene) -> None:
        """Go on with another state of the scene, from where the camera is."""
        self.workshop.restage(scene)
        self.pilot.rehome(scene.camera)
        self._looker, self.sight = Looker(scene), None
        self.lightings, self._given_up = _lightings(scene), False
        if self.look.lighting not in self.lightings:
            self.light(self.lightings[0])

    # What follows from it

    def work(self) -> bool:
        """Do what is most urgent; whether there was anything."""
        shop = self.workshop
        if not self._is_settled and not self._given_up:
            if perf_counter() < self._patient_until:
                return False
            self._prepare()
        elif self._asked:
            self._try(self._asked.pop(0))
        elif shop.settled and (picture := shop.next_picture(self._subject, self.pilot.is_moving)):
            subject = self._subject
            shop.paint(subject, *picture, lambda: self._subject == subject and not self.pilot.is_moving)
        else:
            return False
        return True

    @property
    def _is_settled(self) -> bool:
        """Whether the methods of the look are ready."""
        return self.workshop.settled is not None and self.workshop.settled.choices == self.look.choices

    @property
    def _subject(self) -> Subject:
        settled = self.workshop.settled
        return Subject(self.pilot.camera, settled.choices, self.size)

    def _prepare(self) -> None:
        """Have the methods of the look ready; if that fails or is stopped, go back to the look before."""
        look = self.look
        names = " and ".join(dict.fromkeys(choice.method for choice in look.choices))

        def task(progress: Progress) -> str:
            def report(stage: str, fraction: float) -> None:
                progress(stage, fraction)
                if self.look.choices != look.choices:
                    raise Cancelled

            return self.workshop.prepare(look, report)

        try:
            self.message = self.workshop.run(f"Preparing {names}", task)
            self._settings |= {choice.method: dict(choice.settings) for choice in look.choices}
        except (Cancelled, CatoptricError) as reason:
            if self.look.choices == look.choices:
                self._go_back(str(reason) or f"stopped preparing {names}")

    def _go_back(self, reason: str) -> None:
        before = self.workshop.settled
        self.message, self._given_up = reason, before is None
        if before:
            self.look = replace(self.look, left=before.left, right=before.right)

    def _save_picture(self, progress: Progress) -> str:
        methods = [self.workshop.prepared.get(choice, progress) for choice in self.look.choices]
        target = self._free(".png")
        save_bytes(target, photograph(methods, self.look, self.pilot.camera, self.size, progress))
        return f"saved {target}"

    def _save_film(self, progress: Progress) -> str:
        target, pilot = self._free(FILM), self.pilot
        prepared = self.workshop.prepared
        count = film(prepared, self.look, pilot.camera, pilot.path, self.size, self._rate, target, progress)
        return f"saved {target}: {count} pictures"

    def _try(self, action: Callable[[], str | None]) -> None:
        """Run `action`; what it returns, or what goes wrong, is the message."""
        try:
            self.message = action() or self.message
        except Cancelled:
            self.message = "stopped"
        except CatoptricError as error:
            self.message = str(error)

    def _free(self, ending: str) -> Path:
        """A file name with that ending that is not taken."""
        numbered = (self._stem.with_name(f"{self._stem.name}-{number:03d}{ending}") for number in range(1, 10**6))
        return next(path for path in numbered if not path.exists())


def _lightings(scene: Scene) -> tuple[Lighting, ...]:
    has_lightmaps = any(instance.lightmap is not None for instance in scene.instances)
    return (Lighting.UNLIT, Lighting.DIRECT, *([Lighting.CYCLES] if has_lightmaps else []))
