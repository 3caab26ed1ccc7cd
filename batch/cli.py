"""The command line."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from typer.exceptions import TyperException

from ..addon.baking.engine_export import CUBE_SIZE, PARAMETERS
from ..addon.baking.layered_depth import LAYERS, RESOLUTION
from ..addon.baking.reflector_maps import FINER, SIZE, SPREAD
from ..addon.errors import Cancelled, UsageError
from ..addon.methods.registry import METHODS
from ..addon.parameters import resolve
from ..addon.scene import Lighting
from ..scenes import SCENES
from . import jobs, tasks
from .ending import STOPPED, WRONG, complain, status_of
from .manual import print_methods
from .options import PEERS, parse_against, parse_frames, parse_names, parse_resolution, parse_settings
from .package import package as build_package
from .package_wheels import PLATFORMS, PYTHONS
from .progress import Terminal, blender_on_stderr
from .sampling import MOST, NOISE
from .sources import locate

DEMONSTRATION = ("mirror-ball", "hollow-box", "genus3")
"""What `compare` shows when no scene is named: three that end within four minutes on two cores."""

app = typer.Typer(
    help="Render reflections in real time and measure how far each technique is from Cycles. "
    "SCENE is a .blend file, an archive that `export` wrote, or a scene that ships: " + ", ".join(SCENES) + ".",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

SceneName = Annotated[str, typer.Argument(metavar="SCENE", help="A .blend file, an archive, or a scene that ships.")]
Light = Annotated[
    Lighting,
    typer.Option(help="unlit: colours alone; cycles: diffuse light baked by Cycles; direct: lamps with shadows."),
]
Size = Annotated[str | None, typer.Option(metavar="WxH", help="Size of the picture, as in 768x512.")]
Frame = Annotated[int | None, typer.Option(help="Frame to show; the scene's own unless given.")]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="METHOD.PARAMETER=VALUE", help="Set a parameter; `catoptric methods` lists them."),
]


@app.command()
def compare(
    scenes: Annotated[
        list[str] | None,
        typer.Argument(metavar="[SCENE ...]", help=f"Scenes; {', '.join(DEMONSTRATION)} unless given."),
    ] = None,
    methods: Annotated[str | None, typer.Option(metavar="A,B", help="Methods; all of them unless given.")] = None,
    lighting: Light = Lighting.UNLIT,
    resolution: Annotated[
        str | None,
        typer.Option(metavar="WxH", help="Size of the pictures; each scene's own, 768 a side at most, unless given."),
    ] = None,
    samples: Annotated[
        int | None,
        typer.Option(
            min=1,
            help=f"Cycles' samples a pixel, the methods get half as many, up to 256. Unless given, Cycles goes on "
            f"until its own noise over the reflectors is FLIP {NOISE} or less, or to {MOST}. "
            "With --against the methods' own; 1.",
        ),
    ] = None,
    frames: Annotated[
        str | None,
        typer.Option(metavar="A:B", help="Frames, one after another, with curves and videos; the one the file shows."),
    ] = None,
    against: Annotated[
        str | None,
        typer.Option(metavar="METHOD", help="Take this method's pictures as the reference in place of Cycles'."),
    ] = None,
    videos: Annotated[bool, typer.Option(help="Write a video of every method over several frames.")] = True,
    peers: Annotated[str | None, typer.Option(metavar="A,B", help=f"Rows beside ours: {', '.join(PEERS)}.")] = None,
    settings: Settings = None,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for the report.")] = Path("catoptric-report"),
    resume: Annotated[bool, typer.Option("--resume", help="Keep the rows that an earlier run finished.")] = False,
) -> int:
    """Measure methods against Cycles, or one of them; writes report.html, results.json, pictures and videos."""
    names = parse_names(methods, METHODS, "--methods") if methods is not None else _all_methods(frames is not None)
    if against is not None:
        names = parse_against(against, names)
    elif samples == 1:
        raise UsageError("--samples 1: a reference of one sample cannot tell its noise; give at least 2")
    job = jobs.Job(
        sources=tuple(locate(scene) for scene in dict.fromkeys(scenes or DEMONSTRATION)),
        settings=parse_settings(settings or (), names),
        lighting=lighting,
        samples=samples or (1 if against else None),
        out=out,
        resolution=parse_resolution(resolution) if resolution is not None else None,
        frames=parse_frames(frames) if frames is not None else None,
        peers=parse_names(peers, PEERS, "--peers") if peers is not None else (),
        resume=resume,
        against=names[0] if against else None,
        videos=videos,
    )
    with Terminal() as terminal:
        try:
            results = jobs.run(job, terminal)
        except (Cancelled, KeyboardInterrupt):
            terminal.warn("stopped; what was finished is kept, and the same command with --resume goes on from there")
            return STOPPED
        if results.results:
            terminal.say(f"report: {out / 'report.html'}")
    return 0 if results.results else WRONG


def _all_methods(several_frames: bool) -> tuple[str, ...]:
    """Of one frame, those that take over from earlier ones would only show their tracer."""
    return tuple(name for name, method in METHODS.items() if several_frames or not method.takes_over)


@app.command()
def render(
    scene: SceneName,
    method: Annotated[str, typer.Option(help="One of `catoptric methods`.")],
    out: Annotated[Path, typer.Option(metavar="FILE", help=".exr for linear light, .png for a screen.")],
    lighting: Light = Lighting.UNLIT,
    resolution: Size = None,
    frame: Frame = None,
    settings: Settings = None,
) -> int:
    """Draw a scene with one method."""
    (method,) = parse_names(method, METHODS, "--method")
    chosen = parse_settings(settings or (), (method,))[method]
    size = parse_resolution(resolution) if resolution is not None else None
    with Terminal() as terminal:
        tasks.render(locate(scene), method, chosen, lighting, out, terminal, size, frame)
    return 0


@app.command()
def plates(
    scene: Annotated[str, typer.Argument(metavar="[SCENE]", help="As for `render`.")] = "cathedral",
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for the pictures and plates.html.")] = Path("plates"),
    lighting: Annotated[
        Lighting, typer.Option(help="cycles: diffuse light baked by Cycles; direct: lamps with shadows.")
    ] = Lighting.CYCLES,
    resolution: Size = None,
    samples: Annotated[int, typer.Option(min=2, help="Cycles' samples a pixel; the plates get half as many.")] = 64,
    reference: Annotated[bool, typer.Option("--reference", help="Show Cycles' pictures beside the plates.")] = False,
) -> int:
    """Draw the plates of the paper on glossy planar reflections, with ours beside them."""
    size = parse_resolution(resolution) if resolution is not None else None
    with Terminal() as terminal:
        tasks.draw_plates(locate(scene), lighting, samples, out, terminal, size, reference)
    return 0


@app.command()
def bake(
    scene: SceneName,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for the textures.")],
    lighting: Light = Lighting.UNLIT,
    resolution: Annotated[int, typer.Option(help=RESOLUTION.help + ".")] = RESOLUTION.default,
    layers: Annotated[int, typer.Option(help=LAYERS.help + ".")] = LAYERS.default,
    map_size: Annotated[int, typer.Option(help=SIZE.help + ".")] = SIZE.default,
    finer: Annotated[int, typer.Option(help=FINER.help + ".")] = FINER.default,
    spread: Annotated[float, typer.Option(help=SPREAD.help + ".")] = SPREAD.default,
) -> int:
    """Write a scene's layered depth textures, one EXR an object and layer, and cube maps, one EXR a reflector."""
    chosen = {"resolution": resolution, "layers": layers, "map_size": map_size, "finer": finer, "spread": spread}
    settings = resolve(tasks.BAKE, chosen)
    with Terminal() as terminal:
        tasks.bake(locate(scene), lighting, settings, out, terminal)
    return 0


@app.command()
def export(
    scene: SceneName,
    out: Annotated[Path, typer.Option(metavar="FILE", help="The archive to write.")],
    lighting: Light = Lighting.UNLIT,
    frame: Frame = None,
) -> int:
    """Write a scene as one file, for a machine without Blender."""
    with Terminal() as terminal:
        tasks.export(locate(scene), lighting, out, terminal, frame)
    return 0


@app.command()
def export_engine(
    scene: SceneName,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for textures, catoptric.json and catoptric.glsl.")],
    objects: Annotated[str | None, typer.Option(metavar="A,B", help="Objects; all of them unless given.")] = None,
    lighting: Light = Lighting.UNLIT,
    frame: Frame = None,
    resolution: Annotated[int, typer.Option(help=RESOLUTION.help + ".")] = RESOLUTION.default,
    layers: Annotated[int, typer.Option(help=LAYERS.help + ".")] = LAYERS.default,
    cube_size: Annotated[int, typer.Option(help=CUBE_SIZE.help + ".")] = CUBE_SIZE.default,
) -> int:
    """Write a scene's bakes as a game engine takes them, with the GLSL that samples them."""
    settings = resolve(PARAMETERS, {"resolution": resolution, "layers": layers, "cube_size": cube_size})
    with Terminal() as terminal:
        tasks.export_engine(locate(scene), objects, lighting, settings, out, terminal, frame)
    return 0


@app.command()
def preview(
    scene: SceneName,
    method: Annotated[str, typer.Option(help="The method to begin with.")] = "layered-depth",
    versus: Annotated[str | None, typer.Option(metavar="METHOD", help="Another one, in the right half.")] = None,
    lighting: Light = Lighting.UNLIT,
    resolution: Size = None,
    frame: Frame = None,
    settings: Settings = None,
    path: Annotated[Path | None, typer.Option(metavar="FILE", help="A camera path that was recorded.")] = None,
    video: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the path as an .mp4, without any window.")
    ] = None,
    rate: Annotated[int, typer.Option(min=1, max=240, help="Pictures a second of a film.")] = 30,
    view: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="View transform, such as AgX; the scene's own unless given."),
    ] = None,
) -> int:
    """Fly through a scene in a window; F1 shows the keys."""
    from .preview import launch  # the extension in Blender ships without it
    from .preview.path import CameraPath

    parse_names(method if versus is None else f"{method},{versus}", METHODS, "--method")
    size = parse_resolution(resolution) if resolution is not None else None
    wishes = launch.Wishes(method, versus, parse_settings(settings or (), METHODS), lighting, size, frame, view)
    flown = CameraPath.load(path) if path is not None else None
    source = locate(scene)
    if video is None:
        launch.show(source, wishes, Path.cwd() / scene if scene in SCENES else source.path.with_suffix(""), flown, rate)
    elif flown is None:
        raise UsageError("--video: name the camera path as well, with --path")
    else:
        with Terminal() as terminal:
            launch.shoot(source, wishes, flown, rate, video, terminal)
    return 0


@app.command()
def methods() -> int:
    """List every method with its source, parameters and limits."""
    print_methods()
    return 0


@app.command()
def package(
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for the zips.")] = Path("dist"),
    platform: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help=f"Again for each of several; {', '.join(PLATFORMS)} unless given."),
    ] = None,
    python: Annotated[
        list[str] | None,
        typer.Option(
            metavar="X.Y",
            help=f"Again for each of several; {', '.join(PYTHONS)} unless given, as Blender has them. "
            "A distribution's own Blender may want another, which is for trying out: its wheels have no hash to check.",
        ),
    ] = None,
) -> int:
    """Build the extension for Blender, one zip a platform. Works in the source tree, with `uv` installed."""
    with Terminal() as terminal:
        for path in build_package(out, terminal.warn, platform or tuple(PLATFORMS), python or PYTHONS):
            terminal.say(str(path))
    return 0


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line, by default `sys.argv` and as its process' only task; returns the exit status.

    Errors become one line on stderr.
    """
    if arguments is None:
        with blender_on_stderr():
            return main(sys.argv[1:])
    return status_of(lambda: _run(list(arguments)))


def _run(arguments: list[str]) -> int:
    try:
        return app(args=arguments, prog_name="catoptric", standalone_mode=False) or 0
    except TyperException as error:
        if error.format_message():
            complain(f"{error.format_message()} (catoptric --help explains)")
        return WRONG
    except typer.Abort:
        raise Cancelled from None
