"""What is rendered: plain arrays, no Blender."""

from dataclasses import dataclass, field

from .camera import Camera
from .light import Lamp, World
from .material import Image, Material
from .mesh import Instance, Mesh


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything that a method needs, in world space: right-handed, Z up, metres, scene-linear radiance.

    `resolution` is the width and height the scene asks for, `glossy_bounces` Cycles' setting (a
    path reflects up to `glossy_bounces + 1` times), `warnings` what extraction could not carry over. `view` names
    Blender's view transform and `exposure` its stops: how people look at a picture, which changes no radiance.
    """

    name: str
    camera: Camera
    meshes: tuple[Mesh, ...]
    instances: tuple[Instance, ...]
    materials: tuple[Material, ...]
    images: tuple[Image, ...] = ()
    lamps: tuple[Lamp, ...] = ()
    world: World = field(default_factory=World)
    frame: int = 1
    resolution: tuple[int, int] = (768, 512)
    glossy_bounces: int = 4
    warnings: tuple[str, ...] = ()
    view: str = "Standard"
    exposure: float = 0.0

    @property
    def reflectors(self) -> tuple[int, ...]:
        """Indices of the instances that mirror."""
        return tuple(index for index, instance in enumerate(self.instances) if instance.reflector)
