"""`render`, `bake`, `export` and `export-engine`: one scene down the corridor, as far as asked."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from ..addon.baking.engine_export import export_for_engine
from ..addon.baking.layered_depth import LAYERS, RESOLUTION
from ..addon.baking.layered_depth_atlas import bake_scene
from ..addon.baking.reflector_maps_export import PARAMETERS as MAPS
from ..addon.baking.reflector_maps_export import export_maps
from ..addon.baking.regions import Removed, region_view
from ..addon.cache import Cache
from ..addon.drawing import Resident
from ..addon.errors import UsageError
from ..addon.gl import call
from ..addon.methods.contract import View
from ..addon.methods.registry import named
from ..addon.parameters import Value
from ..addon.scene import Camera, Lighting, Scene
from ..addon.scene.archive import EXTENSION, save
from . import plates
from .footage import lit, require_reflectors
from .jobs import fitted
from .machine import check_size
from .options import parse_names
from .pictures import save_exr, save_png
from .progress import Bar, Terminal
from .sampling import enough, supersampling
from .sources import Source

BAKE = (RESOLUTION, LAYERS, *MAPS)
"""Parameters of `bake`."""

_WRITERS = {".exr": save_exr, ".png": save_png}


def render(
    source: Source,
    method: str,
    settings: Mapping[str, Value],
    lighting: Lighting,
    out: Path,
    terminal: Terminal,
    resolution: tuple[int, int] | None = None,
    frame: int | None = None,
) -> None:
    """Write one method's picture of the scene: linear as .exr, as a screen shows it as .png."""
    writer = _WRITERS.get(out.suffix.lower())
    if writer is None:
        raise UsageError(f"--out: {out.name} must end in .exr or .png")
    drawing = named(method)(settings)
    if resolution:
        check_size(*resolution)
    bar = terminal.bar(source.name)
    scene = _scene(source, lighting, frame, terminal, bar)
    size = resolution or scene.resolution
    check_size(*size)
    drawing.prepare(scene, lighting, bar.step(method, 0.6, 0.8))
    try:
        picture = drawing.render(View(scene.camera, *size), bar.step(method, 0.8, 1.0))
    finally:
        drawing.release()
    writer(out, picture.color)
    bar.finish()
    terminal.say(str(out))


def bake(source: Source, lighting: Lighting, settings: Mapping[str, Value], out: Path, terminal: Terminal) -> None:
    """Write the layered depth textures of every reflected object to the folder `out`, one EXR a layer, and the cube
    maps of every reflector, one EXR each.

    `settings` holds BAKE. With lightmaps, the scene that holds them is written too, and
    regions.png shows where on the reflectors an object may appear (Zhang et al., 3.2).
    """
    bar = terminal.bar(source.name)
    scene = _scene(source, lighting, None, terminal, bar)
    layered = {one.name: settings[one.name] for one in (RESOLUTION, LAYERS)}
    written = bake_scene(scene, lighting, out, layered, Cache(), bar.step("layers", 0.6, 0.9))
    mapped = {one.name: settings[one.name] for one in MAPS}
    written += export_maps(scene, out, mapped, Cache(), bar.step("maps", 0.9, 1.0))
    if lighting is Lighting.CYCLES:
        written.append(out / f"{source.name}{EXTENSION}")
        save(scene, written[-1])
    written.append(out / "regions.png")
    removed = _draw_regions(scene, written[-1])
    bar.finish()
    for path in written:
        terminal.say(str(path))
    terminal.say(
        f"reflection regions spare {removed.triangles:.0%} of the reflectors' triangles and {removed.fragments:.0%} "
        f"of their pixels, and {removed.fragment_searches:.0%} of all searches"
    )


def reference(
    source: Source,
    camera: Camera,
    size: tuple[int, int],
    lighting: Lighting,
    samples: int | None,
    out: Path,
    terminal: Terminal,
) -> None:
    """Write Cycles' picture of what another camera sees of a .blend to the EXR file `out`.

    Without `samples` it takes as many as make its noise low.
    """
    from ..addon.blender.reference import render_reference
    from ..addon.blender.view_camera import seen_by

    bar = terminal.bar(source.name)
    with seen_by(source.bpy_scene, camera, *size):
        scene = source.scene(None, bar.step("scene", 0.0, 0.1))
        samples = samples or enough(scene, size)
        shown = render_reference(
            source.bpy_scene, scene, lighting, *size, samples, Cache(), bar.step("reference", 0.1, 1.0)
        )
    save_exr(out, shown.color)
    bar.finish()


def draw_plates(
    source: Source,
    lighting: Lighting,
    samples: int,
    out: Path,
    terminal: Terminal,
    resolution: tuple[int, int] | None = None,
    judged: bool = False,
) -> None:
    """Write the paper's plates of the scene to the folder `out`; `judged`: with Cycles' pictures beside them."""
    if lighting is Lighting.UNLIT:
        raise UsageError("--lighting unlit: a mirror without light is a perfect one; take cycles or direct")
    if resolution:
        check_size(*resolution)
    if judged and not source.needs_blender:
        raise UsageError("--reference: Cycles cannot render an archive; name its .blend file")
    bar = terminal.bar(source.name)
    scene = _scene(source, lighting, None, terminal, bar)
    plates.check(scene)
    size = resolution or fitted(scene.resolution)
    truths = _truths(source, scene, lighting, size, samples, bar) if judged else {}
    sitting = plates.Sitting(source.name, scene, lighting, size, supersampling(samples))
    page = plates.draw(sitting, out, truths, bar.step("plates", 0.8, 1.0))
    bar.finish()
    terminal.say(str(page))


def _truths(source: Source, scene: Scene, lighting: Lighting, size: tuple[int, int], samples: int, bar: Bar) -> dict:
    """Cycles' pictures of the floor without its texture and with it."""
    from ..addon.blender.plain_base import plain_base
    from ..addon.blender.reference import render_reference

    plain, truths = plates.without_texture(scene), {}
    changed = zip(scene.materials, plain.materials, strict=True)
    colors = {after.name: after.base.color for before, after in changed if before is not after}
    for number, (textured, shown) in enumerate({False: plain, True: scene}.items()):
        step = bar.step("reference", 0.6 + 0.1 * number, 0.7 + 0.1 * number)
        with plain_base({} if textured else colors):
            taken = render_reference(source.bpy_scene, shown, lighting, *size, samples, Cache(), step)
        truths[textured] = taken.color
    return truths


def _draw_regions(scene: Scene, path: Path) -> Removed:
    """Write the debug view of the region test at the scene's camera."""
    resident = call(Resident, scene, Lighting.UNLIT)
    try:
        picture, removed = region_view(resident, scene.camera, *scene.resolution)
    finally:
        call(resident.release)
    save_png(path, picture)
    return removed


def export(source: Source, lighting: Lighting, out: Path, terminal: Terminal, frame: int | None = None) -> None:
    """Write the scene, with the lightmaps that `lighting` asks for, as an archive that needs no Blender."""
    if out.suffix.lower() != EXTENSION:
        raise UsageError(f"--out: {out.name} must end in {EXTENSION}")
    bar = terminal.bar(source.name)
    scene = _scene(source, lighting, frame, terminal, bar)
    save(scene, out)
    bar.finish()
    terminal.say(str(out))


def export_engine(
    source: Source,
    objects: "str | Sequence[str] | None",
    lighting: Lighting,
    settings: Mapping[str, Value],
    out: Path,
    terminal: Terminal,
    frame: int | None = None,
) -> None:
    """Write the bakes of `objects` (names, in a list or with commas between; None for all) to the folder `out`.

    `settings` holds the parameters of `export_for_engine`.
    """
    bar = terminal.bar(source.name)
    scene = _scene(source, lighting, frame, terminal, bar)
    known = (one.name for one in scene.instances)
    names = parse_names(objects, known, "--objects") if isinstance(objects, str) else objects
    exported = export_for_engine(scene, lighting, names, out, dict(settings), Cache(), bar.step("export", 0.6, 1.0))
    bar.finish()
    for note in exported.notes:
        terminal.warn(note)
    for path in exported.written:
        terminal.say(str(path))


def _scene(source: Source, lighting: Lighting, frame: int | None, terminal: Terminal, bar: Bar) -> Scene:
    scene = source.scene(frame, bar.step("scene", 0.0, 0.2))
    for warning in scene.warnings:
        terminal.warn(f"{source.name}: {warning}")
    require_reflectors(scene)
    return lit(source, scene, lighting, Cache(), bar.step("light", 0.2, 0.6))
