"""What a reading of the scene may take over from the one before: a viewport reads at every change."""

from collections.abc import Hashable, Iterable
from dataclasses import dataclass, field

import bpy

from ..scene import Image, Mesh, World
from ..scene.soundness import Empty


@dataclass
class Memo:
    """Meshes, images and the world, as long as Blender does not say that they have changed.

    An empty one knows nothing; a reading fills it, and afterwards it holds what that reading used. In the
    middle of a render (`may_render` False) no other can be started to draw a world that only Cycles can.
    """

    meshes: "dict[Hashable, Mesh | Empty]" = field(default_factory=dict)
    images: dict[tuple[str, bool], Image] = field(default_factory=dict)
    world: World | None = None
    may_render: bool = True
    _owners: dict[Hashable, set[str]] = field(default_factory=dict)
    _used: set[Hashable] = field(default_factory=set)

    def mesh(self, key: Hashable, holder: bpy.types.Object) -> "Mesh | Empty | None":
        """What is known of the mesh of `holder`, an evaluated object; None if it is to be read."""
        self._used.add(key)
        self._owners.setdefault(key, set()).update((f"object {holder.name}", f"data {holder.data.name}"))
        return self.meshes.get(key)

    def forget(self, depsgraph: bpy.types.Depsgraph) -> None:
        """Drop what `depsgraph` has updated since it was last asked."""
        for update in depsgraph.updates:
            changed = update.id
            if isinstance(changed, bpy.types.Object):
                if update.is_updated_geometry:
                    self._forget_meshes(f"object {changed.name}")
            elif isinstance(changed, bpy.types.Image):
                self._forget_images(changed)
            elif isinstance(changed, bpy.types.World):
                if depsgraph.scene.world is not None and changed.original == depsgraph.scene.world.original:
                    self.world = None
            elif update.is_updated_geometry:
                self._forget_meshes(f"data {changed.name}")

    def keep_used(self) -> None:
        """Drop meshes that the last reading did not meet: Blender may give their place in memory to others."""
        for key in self._owners.keys() - self._used:
            self._drop(key)
        self._used.clear()

    def _forget_meshes(self, owner: str) -> None:
        for key in [key for key, owners in self._owners.items() if owner in owners]:
            self._drop(key)

    def _drop(self, key: Hashable) -> None:
        self.meshes.pop(key, None)
        self._owners.pop(key, None)

    def _forget_images(self, image: bpy.types.Image) -> None:
        names: Iterable[tuple[str, bool]] = [key for key in self.images if key[0] == image.name_full]
        for key in names:
            del self.images[key]
