"""Shapes as NumPy arrays: points, faces and texture coordinates, no Blender.

Everything round is a `sheet`: a grid of points whose borders may coincide. Points that coincide are
welded and edges of no length dropped, so a sheet that meets itself becomes a closed surface (a
sphere, a torus, a tube) while its texture coordinates keep their seam.
"""

from dataclasses import dataclass

import numpy as np

WELD = 1e-6  # metres: points nearer than this are one point


@dataclass(frozen=True, eq=False)
class Shape:
    """F faces of three or four corners over V points.

    `points` (V, 3) float64 metres; `faces` (F, 4) int64, seen counter-clockwise from outside, -1 in
    the last column of a triangle; `uvs` (F, 4, 2) float64.
    """

    points: np.ndarray
    faces: np.ndarray
    uvs: np.ndarray

    def moved(self, offset=(0.0, 0.0, 0.0), scale=1.0) -> "Shape":
        """The shape scaled about the origin (one factor or three), then shifted by metres."""
        return Shape(self.points * scale + offset, self.faces, self.uvs)

    def turned(self, matrix: np.ndarray) -> "Shape":
        """The shape rotated by a (3, 3) matrix."""
        return Shape(self.points @ matrix.T, self.faces, self.uvs)

    def textured(self, repeat: float) -> "Shape":
        """The shape with a texture that lies along the two nearest axes and repeats every `repeat` metres.

        It stands upright on whatever is upright.
        """
        corners = self.points[self.faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        along = np.array([[1, 2], [0, 2], [0, 1]])[np.argmax(np.abs(normals), axis=1)]
        return Shape(self.points, self.faces, np.take_along_axis(corners, along[:, None], axis=2) / repeat)

    @property
    def triangles(self) -> int:
        """How many triangles its faces make."""
        return len(self.faces) + int((self.faces[:, 3] >= 0).sum())


def soup(quads: np.ndarray, uvs: np.ndarray | None = None) -> Shape:
    """The welded shape of (F, 4, 3) corner positions; quads with a side of no length become triangles.

    Without `uvs` (F, 4, 2), every face shows the whole texture.
    """
    quads = np.asarray(quads, dtype=np.float64)
    if uvs is None:
        uvs = np.broadcast_to([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], (len(quads), 4, 2))
    keys = np.round(quads.reshape(-1, 3) / WELD).astype(np.int64)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    faces = inverse.reshape(-1, 4)
    # Bring a repeated corner to the end, where -1 marks a triangle.
    repeated = faces == np.roll(faces, 1, axis=1)
    order = (np.argmax(repeated, axis=1)[:, None] + np.arange(1, 5)) % 4
    triangles = repeated.any(axis=1)
    order[~triangles] = np.arange(4)
    faces = np.take_along_axis(faces, order, axis=1)
    uvs = np.take_along_axis(np.asarray(uvs, dtype=np.float64), order[..., None], axis=1)
    faces[triangles, 3] = -1
    return Shape(quads.reshape(-1, 3)[first], faces, uvs)


def sheet(points: np.ndarray, repeat: tuple[float, float] = (1.0, 1.0)) -> Shape:
    """The surface through a grid of points (N, M, 3), facing d/dM x d/dN.

    Texture u runs along M and v along N, from 0 to `repeat`.
    """
    rows, columns = points.shape[:2]
    v, u = np.meshgrid(np.linspace(0, repeat[1], rows), np.linspace(0, repeat[0], columns), indexing="ij")

    def corners(grid):
        quads = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=2)
        return quads.reshape(-1, 4, grid.shape[-1])

    return soup(corners(points), corners(np.stack([u, v], axis=-1)))


def lathe(profile: np.ndarray, segments: int, repeat: tuple[float, float] = (1.0, 1.0)) -> Shape:
    """`profile` (P, 2) of radius and height, turned round Z; outside is to the right of its direction.

    A profile that begins and ends on the axis, or where it began, gives a closed shape.
    """
    profile = np.asarray(profile, dtype=np.float64)
    angle = np.linspace(0.0, 2.0 * np.pi, segments + 1)
    circle = np.stack([np.cos(angle), np.sin(angle), np.ones_like(angle)], axis=-1)
    return sheet(profile[:, None, [0, 0, 1]] * circle, repeat)


def loft(sections: np.ndarray, sides: int) -> Shape:
    """A surface through level outlines, from the first to the last; rising ones face outwards.

    `sections` (K, 5): height, half-widths along X and Y, middle in Y, and the superellipse's exponent (2 is
    round, 5 a rounded box).
    """
    angle = np.linspace(0.0, 2.0 * np.pi, sides + 1)
    angle[-1] = 0.0
    cosine, sine = np.cos(angle), np.sin(angle)
    height, wide, long, middle, power = (column[:, None] for column in np.asarray(sections, dtype=np.float64).T)
    x = wide * np.sign(cosine) * np.abs(cosine) ** (2.0 / power)
    y = middle + long * np.sign(sine) * np.abs(sine) ** (2.0 / power)
    return sheet(np.stack([x, y, np.broadcast_to(height, x.shape)], axis=-1))


def sphere(radius: float, segments: int, rings: int) -> Shape:
    """A closed sphere of 2 * segments * (rings - 1) triangles."""
    latitude = np.linspace(-np.pi / 2, np.pi / 2, rings + 1)
    return lathe(radius * np.stack([np.cos(latitude), np.sin(latitude)], axis=-1), segments)


def torus(radius: float, thickness: float, segments: int, sides: int) -> Shape:
    """A torus round Z: `radius` to the middle of the tube, whose own radius is `thickness`."""
    angle = np.linspace(0.0, 2.0 * np.pi, sides + 1)
    profile = np.stack([radius + thickness * np.cos(angle), thickness * np.sin(angle)], axis=-1)
    return lathe(profile, segments)


def box(size: tuple[float, float, float], repeat: float | None = None) -> Shape:
    """A closed box standing on z = 0. A face shows the texture once, or every `repeat` metres."""
    square = np.array([[-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]) * 0.5
    turns = [np.roll(square, shift, axis=1) * sign for shift in range(3) for sign in (1, -1)]
    quads = np.array([quad if i % 2 == 0 else quad[::-1] for i, quad in enumerate(turns)])
    quads = quads * size + (0.0, 0.0, size[2] / 2)
    if repeat is None:
        return soup(quads)
    sides = quads[:, [1, 3]] - quads[:, [0, 0]]
    lengths = np.linalg.norm(sides, axis=-1) / repeat
    uvs = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * lengths[:, None]
    return soup(quads, uvs)


def rectangle(width: float, depth: float, repeat: float | None = None) -> Shape:
    """A rectangle in z = 0, facing up, showing the texture once, or every `repeat` metres."""
    x, y = width / 2, depth / 2
    times = (1.0, 1.0) if repeat is None else (width / repeat, depth / repeat)
    return sheet(np.array([[(-x, -y, 0.0), (x, -y, 0.0)], [(-x, y, 0.0), (x, y, 0.0)]]), times)


def pane(outline: np.ndarray, hole: np.ndarray | None = None) -> Shape:
    """A flat pane in y = 0, facing -Y: (N, 2) corners of X and Z, counter-clockwise as seen; convex.

    With a `hole`, N corners too, each seen from the pane's middle just where the outline's is. The
    texture shows once over the outline's own box.
    """
    outline = np.asarray(outline, dtype=np.float64)
    low, size = outline.min(axis=0), np.ptp(outline, axis=0)
    inner = np.broadcast_to(outline.mean(axis=0), outline.shape) if hole is None else np.asarray(hole)
    flat = np.stack([outline, inner])
    shape = sheet(np.insert(np.concatenate([flat, flat[:, :1]], axis=1), 1, 0.0, axis=2))
    corners = shape.points[np.maximum(shape.faces, 0)]
    return Shape(shape.points, shape.faces, (corners[..., [0, 2]] - low) / size)


def ellipse(width: float, height: float, count: int) -> np.ndarray:
    """(count, 2) corners of an ellipse about the origin, counter-clockwise."""
    angle = np.arange(count) * 2.0 * np.pi / count
    return np.stack([np.cos(angle) * width / 2, np.sin(angle) * height / 2], axis=-1)


def rounded(width: float, height: float, radius: float, steps: int) -> np.ndarray:
    """(4 * steps + 4, 2) corners of a rectangle about the origin with round corners, counter-clockwise."""
    angle = np.linspace(0.0, np.pi / 2, steps + 1)
    arcs = [np.stack([np.cos(angle + turned), np.sin(angle + turned)], axis=-1) for turned in np.arange(4) * np.pi / 2]
    signs = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)])
    middles = signs * (width / 2 - radius, height / 2 - radius)
    return np.concatenate([middle + radius * arc for middle, arc in zip(middles, arcs, strict=True)])


def framed(hole: np.ndarray, width: float, height: float) -> tuple[np.ndarray, np.ndarray]:
    """A rectangle about the origin, and a convex `hole` (N, 2) round it, cornered alike: both (N + 4, 2)."""

    def angle(points):
        return np.arctan2(points[..., 1], points[..., 0])

    corners = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)]) * (width / 2, height / 2)
    order = np.argsort(angle(hole))
    ring = hole[order]
    extra = np.stack([_towards(ring, angle(corner)) for corner in corners])
    both = np.concatenate([ring, extra])
    both = both[np.argsort(angle(both))]
    out = np.min(np.array([width, height]) / 2 / np.maximum(np.abs(both), 1e-12), axis=1, keepdims=True)
    return both * out, both


def _towards(ring: np.ndarray, angle: float) -> np.ndarray:
    """Where the ray at `angle` from the origin crosses a convex ring (N, 2)."""
    start, end = ring, np.roll(ring, -1, axis=0)
    ray = np.array([np.cos(angle), np.sin(angle)])
    along = end - start
    across = along[:, 0] * ray[1] - along[:, 1] * ray[0]
    share = (start[:, 1] * ray[0] - start[:, 0] * ray[1]) / across
    points = start + share[:, None] * along
    return points[(share >= 0.0) & (share < 1.0) & (points @ ray > 0.0)][0]


def disc(radius: float, segments: int, repeat: float) -> Shape:
    """A round floor in z = 0, facing up, its texture repeating every `repeat` metres."""
    shape = lathe([(radius, 0.0), (0.0, 0.0)], segments)
    corners = shape.points[np.maximum(shape.faces, 0)]
    return Shape(shape.points, shape.faces, corners[..., :2] / repeat + 0.5)


def tube(path: np.ndarray, radius: np.ndarray | float, sides: int, capped: bool = True, bore: float = 0.0) -> Shape:
    """A tube along `path` (N, 3), closed into a loop where its last point is its first.

    `radius` in metres, one or (N,). An open tube ends in a point at both ends if `capped`; with a
    `bore`, a hole of that radius goes back into its far end for a third of its points. The frame is
    carried along without twist; a loop's remaining twist is spread over its length.
    """
    path = np.asarray(path, dtype=np.float64)
    loop = np.allclose(path[0], path[-1])
    tangents, normals = _frames(path, loop)
    angle = np.linspace(0.0, 2.0 * np.pi, sides + 1)[:, None]
    across = normals[:, None] * np.cos(angle) + np.cross(tangents, normals)[:, None] * np.sin(angle)
    rings = path[:, None] + np.broadcast_to(radius, len(path))[:, None, None] * across
    if bore and not loop:
        back = np.arange(len(path) - 1, len(path) * 2 // 3, -1)
        rings = np.concatenate([rings, path[back, None] + bore * across[back]])
        path = np.concatenate([path, path[back[-1:]]])
    if capped and not loop:
        ends = np.broadcast_to(path[[0, -1], None], (2, sides + 1, 3))
        rings = np.concatenate([ends[:1], rings, ends[1:]])
    return sheet(rings)


def sweep(path: np.ndarray, profile: np.ndarray, across, repeat: tuple[float, float] = (1.0, 1.0)) -> Shape:
    """A moulding: `profile` (P, 2) carried along a `path` (N, 3) that lies in a plane, with mitred corners.

    `across` is the unit normal of that plane. A profile's first coordinate runs along it, its second
    along tangent x `across`; outside is to the right of its direction. A path that ends where it began is a loop.
    """
    path, profile, across = (np.asarray(array, dtype=np.float64) for array in (path, profile, across))
    steps = _unit(np.diff(path, axis=0))
    loop = np.allclose(path[0], path[-1])
    before = np.concatenate([steps[-1:] if loop else steps[:1], steps])
    after = np.concatenate([steps, steps[:1] if loop else steps[-1:]])
    outward = np.cross(_unit(before + after), across)
    outward /= np.maximum(np.linalg.norm(before + after, axis=1, keepdims=True) / 2.0, 0.2)  # the mitre
    return sheet(path[:, None] + profile[:, :1] * across + profile[:, 1:] * outward[:, None], repeat)


def pointed_arch(span: float, rise: float, steps: int) -> np.ndarray:
    """(2 * steps + 1, 2) from the left springing to the right one: two arcs that meet `rise` above z = 0.

    A `rise` of half the `span` gives a round arch.
    """
    half = span / 2.0
    radius = (half**2 + rise**2) / span
    angle = np.linspace(0.0, np.arctan2(rise, radius - half), steps + 1)
    right = np.stack([half - radius + radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
    right[-1] = 0.0, rise
    return np.concatenate([right * (-1.0, 1.0), right[-2::-1]])


def _frames(path: np.ndarray, loop: bool) -> tuple[np.ndarray, np.ndarray]:
    """Unit tangents and rotation-minimising normals (N, 3) along a path."""
    steps = np.diff(path, axis=0)
    before = np.concatenate([steps[-1:] if loop else steps[:1], steps])
    after = np.concatenate([steps, steps[:1] if loop else steps[-1:]])
    tangents = _unit(_unit(before) + _unit(after))
    normals = np.empty_like(tangents)
    normals[0] = _unit(np.cross(tangents[0], np.eye(3)[np.argmin(np.abs(tangents[0]))]))
    for i in range(1, len(path)):  # each frame needs the one before it
        carried = normals[i - 1] - tangents[i] * (normals[i - 1] @ tangents[i])
        normals[i] = _unit(carried)
    if loop:
        sideways = np.cross(tangents[-1], normals[-1])
        twist = np.arctan2(normals[0] @ sideways, normals[0] @ normals[-1]) * np.linspace(0, 1, len(path))[:, None]
        normals = normals * np.cos(twist) + np.cross(tangents, normals) * np.sin(twist)
    return tangents, normals


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def through(points: np.ndarray, steps: int) -> np.ndarray:
    """The Catmull-Rom curve through `points` (N, D), `steps` points to a piece: ((N - 1) * steps + 1, D)."""
    at = np.linspace(0.0, len(points) - 1.0, (len(points) - 1) * steps + 1)
    padded = np.concatenate([2 * points[:1] - points[1:2], points, 2 * points[-1:] - points[-2:-1]])
    piece = np.minimum(at.astype(int), len(points) - 2)
    t = (at - piece)[:, None]
    before, first, second, after = (padded[piece + i] for i in range(4))
    bend = 2 * before - 5 * first + 4 * second - after
    return first + 0.5 * t * (second - before + t * (bend + t * (3 * (first - second) + after - before)))


def joined(shapes: list[Shape]) -> Shape:
    """Several shapes as one, not welded to one another."""
    starts = np.cumsum([0] + [len(shape.points) for shape in shapes])
    faces = [np.where(shape.faces < 0, -1, shape.faces + start) for shape, start in zip(shapes, starts, strict=False)]
    return Shape(
        np.concatenate([shape.points for shape in shapes]),
        np.concatenate(faces),
        np.concatenate([shape.uvs for shape in shapes]),
    )


def turn(axis: str, degrees: float) -> np.ndarray:
    """The (3, 3) rotation about "X", "Y" or "Z"."""
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    first, second = {"X": (1, 2), "Y": (2, 0), "Z": (0, 1)}[axis]
    matrix = np.eye(3)
    matrix[[first, first, second, second], [first, second, first, second]] = cosine, -sine, sine, cosine
    return matrix
