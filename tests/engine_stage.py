"""A game engine in small: it knows exported files and OpenGL, and nothing of what baked them."""

import json
from pathlib import Path

import moderngl
import numpy as np
import OpenImageIO as oiio
from catoptric.addon.gl import call, require

_VERTEX = """
void main() { gl_Position = vec4(4.0 * float(gl_VertexID % 2) - 1.0, 4.0 * float(gl_VertexID / 2) - 1.0, 0.0, 1.0); }
"""

_TRACE = """
uniform sampler2D origins, directions;
uniform sampler2DArray color_depth, normal_count;
uniform mat4 world_to_object;
uniform vec3 low, size;
uniform ivec3 texels;
layout(location = 0) out vec4 color_distance;
layout(location = 1) out vec4 normal;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    CatoptricObject object = CatoptricObject(world_to_object, low, size, texels);
    CatoptricHit hit = catoptric_trace(
        color_depth, normal_count, object, texelFetch(origins, at, 0).xyz, texelFetch(directions, at, 0).xyz);
    color_distance = vec4(hit.radiance, hit.distance);
    normal = vec4(hit.normal, 0.0);
}
"""

_CUBES = """
uniform sampler2D directions, unfolded;
uniform samplerCube folded;
layout(location = 0) out vec4 by_cross;
layout(location = 1) out vec4 by_cube;
void main() {
    vec3 direction = texelFetch(directions, ivec2(gl_FragCoord.xy), 0).xyz;
    by_cross = vec4(catoptric_cube(unfolded, direction), 1.0);
    by_cube = texture(folded, direction.xzy);
}
"""


class Engine:
    """What lies in the folder of an export."""

    def __init__(self, folder: Path) -> None:
        """Read catoptric.json; the textures are read when they are used."""
        self.folder = folder
        self.described = json.loads((folder / "catoptric.json").read_text(encoding="utf-8"))
        self.glsl = (folder / self.described["glsl"]).read_text(encoding="utf-8")

    def picture(self, name: str) -> np.ndarray:
        """(H, W, channels) float32 of an EXR, row 0 the top."""
        return oiio.ImageBuf(str(self.folder / name)).get_pixels(oiio.FLOAT)

    def faces(self, cube: dict) -> np.ndarray:
        """(6, N, N, 3) of a cube, cut out of its cross as catoptric.json says."""
        picture, size = self.picture(cube["file"]), cube["size"]
        corners = ((face["top"], face["left"]) for face in cube["faces"].values())
        return np.stack([picture[top : top + size, left : left + size] for top, left in corners])

    def trace(self, thing: dict, placed: dict, origins, directions, **options):
        """What rays (N, 3) meet of an object: radiance (N, 3), distance (N,), inf for nothing, and normal (N, 3)."""
        inward = np.linalg.inv(placed["object_to_world"])
        values = {
            "world_to_object": tuple(inward.T.ravel()),
            "low": tuple(thing["box"]["low"]),
            "size": tuple(thing["box"]["size"]),
            "texels": tuple(thing["texels"]),
        }
        layers = {name: np.stack(list(map(self.picture, one["files"]))) for name, one in thing["textures"].items()}
        textures = {"origins": origins, "directions": directions, **layers}
        seen, normal = call(self._draw, _TRACE, textures, values, **options)
        return seen[:, :3], np.where(seen[:, 3] < 1e30, seen[:, 3], np.inf), normal[:, :3]

    def look(self, cube: dict, directions, **options):
        """Radiance (N, 3) from directions (N, 3), by the cross and by a cube map of its faces."""
        textures = {"directions": directions, "unfolded": self.picture(cube["file"]), "folded": self.faces(cube)}
        by_cross, by_cube = call(self._draw, _CUBES, textures, {}, **options)
        return by_cross[:, :3], by_cube[:, :3]

    def _draw(self, shader, textures, values, version="330 core", rows_from_bottom=False):
        """The two results (N, 4) of a shader that runs once for each row of "directions"."""
        context = require()
        head = f"#version {version}\n#define CATOPTRIC_ROWS_FROM_BOTTOM {int(rows_from_bottom)}\n"
        drawn = context.program(f"#version {version}\n{_VERTEX}", head + self.glsl + shader)
        for name, value in values.items():
            drawn[name] = value
        held = []
        for unit, (name, pixels) in enumerate(textures.items()):
            of_rays = name in ("origins", "directions")
            turned = pixels[..., ::-1, :, :] if rows_from_bottom and name != "folded" and not of_rays else pixels
            held.append(_uploaded(context, np.ascontiguousarray(turned, np.float32), name == "folded"))
            held[-1].use(unit)
            drawn[name] = unit
        count = len(textures["directions"])
        targets = [context.texture((count, 1), 4, dtype="f4") for _ in range(2)]
        framebuffer = context.framebuffer(targets)
        framebuffer.use()
        context.enable_only(moderngl.NOTHING)
        context.vertex_array(drawn, []).render(vertices=3)
        results = [np.frombuffer(target.read(), np.float32).reshape(count, 4) for target in targets]
        for part in (framebuffer, *targets, *held, drawn):
            part.release()
        return results


def _uploaded(context, pixels, folded):
    if folded:
        return context.texture_cube(pixels.shape[1:3], 3, pixels.tobytes(), dtype="f4")
    if pixels.ndim == 2:
        return context.texture((len(pixels), 1), 3, pixels.tobytes(), dtype="f4")
    if pixels.ndim == 3:
        height, width, channels = pixels.shape
        return context.texture((width, height), channels, pixels.tobytes(), dtype="f4")
    layers, height, width, channels = pixels.shape
    return context.texture_array((width, height, layers), channels, pixels.tobytes(), dtype="f4")
